#!/bin/bash
# scripts/sweep: the table is right, failures are rows, a killed sweep goes on, an array job gives the same table.
set -uo pipefail
source_dir=${SOURCE_DIR:-$(dirname "$(readlink -f "$0")")/..}
sweep=$source_dir/scripts/sweep
export DIALOG_MANAGER=${BIN_DIR:-$source_dir/build/release/bin}/dialog_manager
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failed=0

# same WHAT EXPECTED GOT
same() {
  if [ "$2" != "$3" ]; then
    printf '%s: expected\n%s\ngot\n%s\n' "$1" "$2" "$3"
    failed=1
  fi
}

cat >scene.dlg <<'END'
echo noise of the scene
type thing
field thing.a real m = 0 in 0 1
field thing.b vec3
create thing t
END
options=(--scene scene.dlg --vary t.a=0:1:3 --vary "t.b=1 2 3,4 5 6" --run 0.1 --measure t.a --measure t.b)
expected='point,t.a,t.b,status,t.a,t.b
0,0,1 2 3,ok,0,1 2 3
1,0,4 5 6,ok,0,4 5 6
2,0.5,1 2 3,ok,0.5,1 2 3
3,0.5,4 5 6,ok,0.5,4 5 6
4,1,1 2 3,ok,1,1 2 3
5,1,4 5 6,ok,1,4 5 6'

"$sweep" "${options[@]}" --out a.csv
same 'status' 0 $?
same 'table' "$expected" "$(cat a.csv)"
same 'nothing is left behind' '' "$(ls -d a.csv.parts 2>/dev/null)"

# a point outside the range of its field is a row that says so
"$sweep" --scene scene.dlg --vary t.a=0.5,2 --run 0.1 --measure t.a --out b.csv 2>said
same 'status with failures' 1 $?
same 'rows of failures' $'point,t.a,status,t.a\n0,0.5,ok,0.5\n1,2,failed,' "$(cat b.csv)"
grep -q range b.csv.parts/1.log || { echo "1.log does not say why"; failed=1; }

# killed after some rows: those are not computed again
mkdir -p counted
cat >counted/manager <<END
#!/bin/bash
echo run >>"$folder/runs"
[ "\$(wc -l <"$folder/runs")" -eq 4 ] && kill -9 \$PPID
exec "$DIALOG_MANAGER" "\$@"
END
chmod +x counted/manager
DIALOG_MANAGER=$folder/counted/manager "$sweep" "${options[@]}" --jobs 1 --out c.csv >/dev/null 2>&1
DIALOG_MANAGER=$folder/counted/manager "$sweep" "${options[@]}" --jobs 1 --out c.csv
same 'status after going on' 0 $?
same 'table after going on' "$expected" "$(cat c.csv)"
same 'runs, one of them twice' 7 "$(wc -l <runs)"

# rows of another sweep are not mixed in
mkdir d.csv.parts
echo other >d.csv.parts/plan
"$sweep" "${options[@]}" --out d.csv 2>/dev/null
same 'status with foreign rows' 2 $?

# an array job: here the scheduler is a loop
mkdir -p fake
cat >fake/sbatch <<'END'
#!/bin/bash
for word in "$@"; do
  case $word in --array=*) last=${word##*-} ;; esac
  job=$word
done
for ((SLURM_ARRAY_TASK_ID = last; SLURM_ARRAY_TASK_ID >= 0; SLURM_ARRAY_TASK_ID--)); do
  export SLURM_ARRAY_TASK_ID
  bash -c "${job#--wrap=}"
done
END
chmod +x fake/sbatch
PATH=$folder/fake:$PATH "$sweep" "${options[@]}" --slurm --out e.csv
same 'table of the array job' "$expected" "$(cat e.csv)"

for bad in "--scene missing.dlg --vary t.a=1 --run 1 --measure t.a --out x.csv" "--vary t.a" "--nonsense" "--out"; do
  # shellcheck disable=SC2086
  "$sweep" $bad 2>/dev/null
  same "status of $bad" 2 $?
done
exit "$failed"
