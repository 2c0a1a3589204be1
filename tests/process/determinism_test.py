"""The same session gives the same world, bit for bit, whatever the machine does meanwhile."""

import os
import subprocess

import sailor
from sailor import Case

SESSION = """
rate 60Hz
start walker as a serving left*
start wave
create walker left1
create walker left2 reach 0.7
create wave w height 0.4
create node follower parent w position 1 2 3 orientation 0.9 0.1 0.2 0.3
at 0.1 set w.height 0.9
every 150ms set left1.reach 0.2
run 0.05
jump left2
""" + "step\nhash\n" * 30


class Sessions(Case):
    def session(self, *options, cores=None, environ=None, text=SESSION):
        def pin():
            if cores:
                os.sched_setaffinity(0, cores)

        done = self.run_manager("--seed", "9", *options, stdin=text.encode(), preexec_fn=pin, timeout=120, environ=environ)
        self.assertEqual(done.returncode, 0, done.stderr)
        hashes = [line for line in done.stdout.splitlines() if len(line) == 16]
        self.assertEqual(len(hashes), 30, done.stdout)
        self.assertGreater(len(set(hashes)), 25, "the world moves")
        return hashes


class Determinism(Sessions):
    def test_one_core_and_two(self):
        expected = self.session()
        cores = sorted(os.sched_getaffinity(0))
        self.assertEqual(self.session(cores={cores[0]}), expected)
        self.assertEqual(self.session(cores={cores[-1]}), expected)

    def test_under_load(self):
        expected = self.session()
        load = [subprocess.Popen(["/bin/sh", "-c", "while :; do :; done"]) for _ in range(3)]
        try:
            self.assertEqual(self.session(), expected)
        finally:
            for process in load:
                process.kill()
                process.wait()

    def test_at_any_pace(self):
        expected = self.session()
        self.assertEqual(self.session("--pace", "realtime"), expected)
        self.assertEqual(self.session("--pace", "4"), expected)

    def test_with_other_settings_of_the_person(self):
        expected = self.session()
        environ = sailor.environment(self.folder, TZ="Pacific/Auckland", LANG="C", COLUMNS="40", MALLOC_PERTURB_="85")
        environ["LC_ALL"] = "C"
        self.assertEqual(self.session(environ=environ), expected)

    def test_in_one_step_or_many(self):
        text = SESSION.replace("step\nhash\n" * 30, "")
        single = self.run_manager("--seed", "9", stdin=(text + "step\n" * 30 + "hash\n").encode(), timeout=60)
        whole = self.run_manager("--seed", "9", stdin=(text + "step 30\nhash\n").encode(), timeout=60)
        self.assertEqual(single.stdout.splitlines()[-1], whole.stdout.splitlines()[-1])

    def test_another_seed_is_told(self):
        done = self.run_manager("--seed", "1", "-c", "time")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_two_programs_serving_parts_give_the_world_of_one(self):
        one = "start walker\n"
        two = "start walker as l serving left*\nstart walker as r serving right*\n"
        rest = "create walker left\ncreate walker right reach 0.3\nstep 20\nhash\n"
        got = [self.run_manager(stdin=(start + rest).encode(), timeout=60) for start in (one, two)]
        self.assertEqual([done.returncode for done in got], [0, 0], [done.stderr for done in got])
        self.assertEqual(got[0].stdout, got[1].stdout)


class SlowDeterminism(Sessions):
    def test_a_hundred_times(self):
        expected = self.session()
        cores = sorted(os.sched_getaffinity(0))
        for loaded in (False, True):
            load = [subprocess.Popen(["/bin/sh", "-c", "while :; do :; done"]) for _ in range(4 if loaded else 0)]
            try:
                for _ in range(25):
                    for where in ({cores[0]}, set(cores)):
                        self.assertEqual(self.session(cores=where), expected, f"{'loaded' if loaded else 'idle'}, {len(where)} cores")
            finally:
                for process in load:
                    process.kill()
                    process.wait()

    def test_debug_and_release(self):
        other = sailor.BIN.parents[1] / ("dev" if sailor.BIN.parent.name == "release" else "release") / "bin"
        if not (other / "dialog_manager").exists():
            self.skipTest(f"no build in {other.parent.name}")
        expected = self.session()
        try:
            sailor.BIN, before = other, sailor.BIN
            got = self.session()
        finally:
            sailor.BIN = before
        self.assertEqual(got, expected)


if __name__ == "__main__":
    sailor.main()
