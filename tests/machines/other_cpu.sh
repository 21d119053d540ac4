#!/usr/bin/env bash
# Runs the tiny room on a CPU of another class, emulated (Debian: qemu-user): its labels and planes are this CPU's,
# byte for byte. Takes two minutes. Usage: other_cpu.sh FOLDER_OF_PROGRAMS [CPU, as in `qemu-x86_64 -cpu help`]
# Haswell-noTSX has AVX2, Nehalem SSE 4.2: 8 and 4 lanes where AVX-512 has 16.
set -euo pipefail
programs=$1 cpu=${2:-Haswell-noTSX}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$programs/hybrid-synth" room --seed 1 --preset tiny --out "$scratch/room" >/dev/null
"$programs/hybrid" run "$scratch/room/scene.toml" --out "$scratch/here" --quiet >/dev/null
# Kernels kept for this CPU are none for that one.
POCL_CACHE_DIR=$scratch/kernels qemu-x86_64 -cpu "$cpu" "$programs/hybrid" run "$scratch/room/scene.toml" \
  --out "$scratch/there" --quiet 2>"$scratch/log" || { cat "$scratch/log" >&2; exit 1; }
for file in scans/{west,east}/{labels.exr,planes.json}; do
  cmp "$scratch/here/$file" "$scratch/there/$file"
done
echo "$cpu: labels and planes are the same bytes"
