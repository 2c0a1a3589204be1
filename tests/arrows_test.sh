#!/bin/bash
# Who may include whom: the arrows of docs/architecture.md, checked over every #include of the tree.
#   tests/arrows_test.sh [ROOT]   without ROOT the project itself, after proving on bad trees that the check can fail
set -uo pipefail

# A -> B: A includes B's headers, and those that B's own arrows reach; nothing else
arrows='
objdb
dialog_manager           objdb
manipulators/kit         objdb
manipulators/kinematics  objdb
manipulators/mesh
manipulators/arm_ik      manipulators/kit manipulators/kinematics
manipulators/head_ik     manipulators/kit manipulators/kinematics
manipulators/face_fem    manipulators/kit manipulators/mesh
manipulators/render      manipulators/kit manipulators/mesh
'
# any other manipulator, so that a new one needs no line here
others=manipulators/kit

# headers that cost seconds each: allowed in .cc files only
heavy='^(boost/|Eigen/(Sparse|CholmodSupport|SPQRSupport|UmfPackSupport)|cholmod\.h|umfpack\.h|GL/|assimp/|X11/|tiny_gltf\.h)'

# reach ROOM  what ROOM may include: itself and everything its arrows lead to
reach() {
  local room=$1 next
  echo "$room"
  awk -v room="$room" -v others="$others" '
    $1 == room { named = 1; for (i = 2; i <= NF; i++) print $i }
    END { if (!named && room ~ "^manipulators/") print others }' <<<"$arrows" |
    while read -r next; do reach "$next"; done
}

# room_of PATH  sets room: objdb/x.h -> objdb, manipulators/kit/x.h -> manipulators/kit; tests/PATH is judged as PATH
room_of() {
  local path=$1
  case $path in
    tests/bench/objdb_*) path=objdb/x ;;
    tests/bench/dialog_manager_*) path=dialog_manager/x ;;
    tests/fuzz/*) path=dialog_manager/x ;;
    tests/bench/*) path=manipulators/${path#tests/bench/} path=${path%_bench.cc}/x ;;
    tests/*) path=${path#tests/} ;;
  esac
  case $path in
    manipulators/*/*) room=${path#*/} room=manipulators/${room%%/*} ;;
    *) room=${path%%/*} ;;
  esac
}

# includes ROOT  one line an include: file, "quoted" or <angled> name
includes() {
  (cd "$1" && find objdb dialog_manager manipulators tests -name '*.cc' -o -name '*.h' 2>/dev/null | sort |
    xargs -r grep -HoE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<][^">]+' |
    sed -E 's/^([^:]+):[^"<]*(["<])(.*)$/\1 \2 \3/')
}

# check ROOT  prints every broken rule, fails when there is one
check() {
  local root=$1 broken=0 file mark name room from
  declare -A allowed
  # the table itself has no cycle
  awk '{ for (i = 2; i <= NF; i++) print $1, $i }' <<<"$arrows" | tsort >/dev/null || return 1
  while read -r file mark name; do
    room_of "$file"
    from=$room
    if [ -z "${allowed[$from]-}" ]; then allowed[$from]=" $(reach "$from" | sort -u | tr '\n' ' ')"; fi
    if [ "$mark" = '"' ]; then
      room_of "$name"
      if [ ! -e "$root/$name" ]; then
        echo "$file: \"$name\" is not a path from the root"
        broken=1
      elif [[ ${allowed[$from]} != *" $room "* ]]; then
        echo "$file: $from may not include \"$name\"; it may include${allowed[$from]}"
        broken=1
      fi
    elif [[ $file == *.h && $file != *_impl.h && $name =~ $heavy ]]; then
      echo "$file: <$name> is heavy: only in .cc files"
      broken=1
    fi
    # what several .cc files share stays out of other headers
    if [[ $file == *.h && $name == *_impl.h ]]; then
      echo "$file: \"$name\" is for .cc files"
      broken=1
    fi
  done < <(includes "$root")
  return "$broken"
}

# verdict FILE INCLUDE  judges a small tree where FILE holds that include
verdict() {
  local root status
  root=$(mktemp -d)
  mkdir -p "$root"/{objdb,dialog_manager/channel,tests,manipulators/{kit,mesh,render}} "$root/$(dirname "$1")"
  touch "$root"/{objdb/value.h,dialog_manager/{session.h,channel/watch_impl.h},manipulators/{kit/manipulator.h,mesh/surface.h,render/canvas.h}}
  echo "#include $2" >"$root/$1"
  check "$root" >/dev/null
  status=$?
  rm -r "$root"
  return "$status"
}
refuses() {
  if verdict "$@"; then
    echo "arrows_test: $2 in $1 was not noticed"
    failed=1
  fi
}
accepts() {
  if ! verdict "$@"; then
    echo "arrows_test: $2 in $1 was refused"
    failed=1
  fi
}

if [ $# -eq 1 ]; then
  check "$1"
  exit
fi
failed=0
refuses objdb/a.cc '"dialog_manager/session.h"'
refuses objdb/a.cc '"manipulators/kit/manipulator.h"'
refuses dialog_manager/a.cc '"manipulators/kit/manipulator.h"'
refuses manipulators/kit/a.h '"dialog_manager/session.h"'
refuses manipulators/mesh/a.h '"objdb/value.h"'
refuses manipulators/render/b.cc '"canvas.h"'
refuses manipulators/kit/b.cc '"../../objdb/value.h"'
refuses tests/manipulators/mesh/a_test.cc '"manipulators/render/canvas.h"'
refuses manipulators/quite_new/a.cc '"manipulators/mesh/surface.h"'
refuses manipulators/render/a.h '<GL/osmesa.h>'
refuses dialog_manager/a.h '<boost/asio.hpp>'
refuses dialog_manager/a.h '"dialog_manager/channel/watch_impl.h"'
accepts manipulators/quite_new/a.cc '"objdb/value.h"'
accepts manipulators/render/a.cc '"objdb/value.h"'
accepts tests/bench/render_bench.cc '"manipulators/mesh/surface.h"'
accepts manipulators/render/a.cc '<GL/osmesa.h>'
accepts dialog_manager/channel/a_impl.h '<boost/asio.hpp>'
check "$(dirname "$(readlink -f "$0")")/.." || failed=1
exit "$failed"
