#!/usr/bin/env bash
# A night on a real Slurm of two hosts (cluster.sh), one of which loses its power while it works:
#   night.sh BIN SCENE     BIN: folder of the programs; SCENE: folder of a small scene
# All units are done, the bytes are those of a run on one machine, the lost tasks were queued again, and the
# catalogue is made. Exit code 77 where Slurm is not installed or this is not root.
set -uo pipefail
skip() { echo "skipped: $*"; exit 77; }
if [ "${INSIDE_NIGHT:-}" != 1 ]; then
  [ "$(id -u)" = 0 ] || skip "namespaces need root"
  for program in munged slurmctld slurmd sbatch unshare ip; do
    command -v $program >/dev/null || skip "no $program (packages munge slurmctld slurmd slurm-client iproute2)"
  done
  unshare --net --mount --pid --fork --kill-child=KILL --mount-proc true 2>/dev/null ||
    skip "this machine does not allow namespaces"
  folder=$(mktemp -d)
  INSIDE_NIGHT=1 NIGHT_FOLDER=$folder unshare --net --mount --pid --fork --kill-child=KILL --mount-proc \
    timeout 240 bash "$0" "$@"
  code=$?
  rm -rf "$folder"
  exit $code
fi

here=$(dirname "$0")
. "$here/cluster.sh"
bin=$(cd "$1" && pwd) scene=$(cd "$2" && pwd) work=$NIGHT_FOLDER
export PATH=$bin:$PATH
fail() {
  echo "FAILED: $*"
  squeue; sinfo -N
  tail -n 20 "$work"/store/slurm/1/*.log "$work"/cluster/slurmctld.log
  exit 1
}

# Scenes of other contents each, or they would be one.
mkdir -p "$work/archive"
for name in a b c d e; do
  cp -r "$scene" "$work/archive/$name"
  sed -i "s/\"mini\"/\"mini $name\"/" "$work/archive/$name/scene.toml"
  printf "\\x0$((16#$(printf '%s' "$name")))" | dd of="$work/archive/$name/s.ply" bs=1 seek=$(($(stat -c %s "$scene/s.ply") - 12)) conv=notrunc status=none
done
head -c 5000 "$scene/s.ply" >"$work/archive/e/s.ply" # cut short: its scene is partial here and there

start_cluster "$work/cluster" || { echo "FAILED: the cluster does not start"; exit 1; }

for store in alone store; do
  hybrid batch plan "$work/archive" --out "$work/$store" --quiet >/dev/null
  code=$?
  [ $code -eq 0 ] || [ $code -eq 3 ] || fail "plan: $code"
done
hybrid batch run --out "$work/alone" --jobs 1 --quiet >/dev/null
[ $? -eq 3 ] || fail "the run on one machine: exit code $?, expected 3 for the scan that is cut short"

# Bundles of one unit, so that 4 tasks and more are in arrays of at most MaxArraySize = 4.
hybrid batch run --out "$work/store" --engine slurm --bundle 0 --slurm-args "--partition=all" >"$work/jobs" ||
  fail "submission"
cat "$work/jobs"
[ "$(grep -c ': planes,' "$work/jobs")" = 2 ] || fail "expected two arrays for five planes units"

# Scenes wait for the arrays that have their planes, not for all; every array asks for memory and time.
planes=$(sed -n 's/^job \([0-9]*\): planes, .*/\1/p' "$work/jobs" | head -n 1)
grep -q ": scene, 4 tasks .* after $planes\$" "$work/jobs" || fail "the first four scenes wait for more than their planes"
scontrol show job "$planes" | grep -q 'MinMemoryNode=[1-9][0-9][0-9]M' || fail "no memory was asked for"
scontrol show job "$planes" | grep -q 'TimeLimit=00:1[0-9]:00' || fail "no time was asked for"

# The power fails while n2 works on a unit, which takes a second at least with the start of the program.
for _ in $(seq 1000); do
  grep -qsh '^task .* on n2' "$work"/store/slurm/1/*.log && break
  sleep 0.03
done
power_cut "$work/cluster" n2 2>/dev/null
echo "n2 is cut off"

for _ in $(seq 400); do
  [ -z "$(squeue -h -t PD,R,CG,CF -o %i)" ] && break
  sleep 0.5
done
[ -z "$(squeue -h -t PD,R,CG,CF -o %i)" ] || fail "jobs are left"
cat "$work"/store/slurm/1/*.log | grep '^task' | sort
grep -qh '^task .* on n2' "$work"/store/slurm/1/*.log || fail "n2 has done nothing"
grep -qh '^task .* start [1-9]' "$work"/store/slurm/1/*.log || fail "no task was queued again"

list() { # path and content of all objects and links, without what tells of the run itself
  (cd "$1" && find objects results \( -type f -o -type l \) ! -name record.json ! -name timing.json \
    ! -name timing.js ! -name log.txt | sort | while read -r file; do
    if [ -L "$file" ]; then echo "$file -> $(readlink "$file")"; else sha256sum "$file"; fi
  done)
}
list "$work/alone" >"$work/alone.list"
list "$work/store" >"$work/store.list"
diff "$work/alone.list" "$work/store.list" || fail "the stores differ"
[ "$(wc -l <"$work/store.list")" -gt 100 ] || fail "hardly anything was made"
hybrid batch verify "$work/store" || fail "the store does not verify"
[ -s "$work/store/catalogue.sqlite" ] || fail "no catalogue"
hybrid batch run --out "$work/store" --engine slurm | grep -q "nothing to do" || fail "a second submission has jobs"
echo "all units done, the bytes are those of one machine"
