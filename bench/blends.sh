#!/usr/bin/env bash
# Every photograph left out in turn and made from the others, by every blend and both weights, scored on the
# pixels that all of them see: bench/blends.sh SCENE.toml [--set SECTION.KEY=VALUE]... prints a Markdown table.
# BUILD_DIR (default build) holds the programs, built with -DHYBRID_BENCH=ON; WORK (default: a temporary folder)
# keeps the six runs and blends.json.
set -euo pipefail
scene=$1
shift
bin="${BUILD_DIR:-$(dirname "$0")/../build}/bin"
if [ -z "${WORK:-}" ]; then
  WORK=$(mktemp -d)
  trap 'rm -rf "$WORK"' EXIT
fi
runs=()
for weights in angle ulr; do
  for blend in nearest linear dual; do
    run="$WORK/$weights-$blend"
    "$bin/hybrid" render "$scene" --leave-one-out --out "$run" --quiet --force "$@" \
      --set "render.blend=$blend" --set "render.weights=$weights" >/dev/null
    runs+=("$run")
  done
done
"$bin/hybrid-compare-views" "$scene" "${runs[@]}" >"$WORK/blends.json"
python3 - "$WORK/blends.json" <<'TABLE'
import json, sys
result = json.load(open(sys.argv[1]))
print(f"{result['scene']}: {result['photographs']} photographs, {100 * result['share_seen_by_all']:.2f} % of their "
      f"pixels seen by all; masks {'identical' if result['masks_identical'] else 'DIFFER'}\n")
print("| weights | blend | PSNR dB | SSIM | detail |\n|---|---|---|---|---|")
for row in result["rows"]:
    options = row["options"]
    print(f"| {options['weights']} | {options['blend']} | {row['psnr_db']:.2f} | {row['ssim']:.4f} | {row['detail']:.3f} |")
TABLE
