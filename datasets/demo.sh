#!/usr/bin/env bash
# Sets everything up and runs the main job: bash datasets/demo.sh [SCENE.toml]
# Without an argument: makes the synthetic church first. A scene with a truth.json beside it is scored against it. Results
# and pictures land in out/<scene>.
set -euo pipefail
cd "$(dirname "$0")/.."
scene="${1:-}"
edits=()
bash datasets/setup.sh
build="${BUILD_DIR:-build}"
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release ${CMAKE_ARGS:-} >/dev/null
cmake --build "$build" --target hybrid hybrid-synth hybrid-score
if [ -z "$scene" ]; then
  "$build/bin/hybrid-synth" church --out out/church-synthetic/scene --seed 1 --preset demo
  scene=out/church-synthetic/scene/scene.toml
  out=out/church-synthetic/result
  edits=(--set edit.openings=cut)  # its proxy has no openings
else
  out="out/$(basename "$(dirname "$(realpath "$scene")")")/result"
fi
"$build/bin/hybrid" run "$scene" --out "$out" "${edits[@]}"
truth="$(dirname "$scene")/truth.json"
if [ -e "$truth" ]; then
  echo
  "$build/bin/hybrid-score" "$truth" "$out"
fi
echo
echo "Look at: $out/report/index.html (all pictures and figures on one page)"
echo "         $out/scans/*/range.png classes.png, $out/report/registration-*.png, $out/views/*.png"
