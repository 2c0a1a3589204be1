#!/usr/bin/env python3
"""A manipulator in plain Python: every `wave` rises and falls about its `middle`, like a ball on the sea."""
import math
import sys

print('''type wave extends sphere "a ball on the sea"
field wave.middle vec3 m "about which it rises and falls"
field wave.height real m = 0.1 "from the middle to the top"
field wave.period real s = 2 in 0.01 1e6 "from top to top"
writes wave.position
checkpoint
ready''', flush=True)

waves = {}  # path -> {field: [words]}; what is not told has its default
for line in sys.stdin:
    verb, *words = line.split()
    if verb == "create" and words[0] == "wave":
        fields = waves[words[1]] = {"middle": ["0", "0", "0"], "height": ["0.1"], "period": ["2"]}
        for name in fields:
            if name in words[2:]:
                at = words.index(name, 2) + 1
                fields[name] = words[at:at + len(fields[name])]
    elif verb == "set" and words[0].rpartition(".")[0] in waves:
        path, _, name = words[0].rpartition(".")
        waves[path][name] = words[1:]
    elif verb == "delete":
        waves.pop(words[0], None)
    elif verb == "tick":
        for path, fields in waves.items():
            x, y, z = map(float, fields["middle"])
            y += float(fields["height"][0]) * math.sin(2 * math.pi * float(words[1]) / float(fields["period"][0]))
            print("set", path + ".position", x, y, z)
        print("done", words[0], flush=True)
    elif verb == "checkpoint":
        print("done", flush=True)  # all that it knows it has been told
