#!/usr/bin/env bash
# Every photograph left out in turn and made from the others, by every blend, both weights, and with and without
# equalised exposures, scored on the pixels that all of them see: bench/blends.sh SCENE.toml [--set SECTION.KEY=VALUE]... prints a Markdown table.
# BUILD_DIR (default build) holds the programs, built with -DHYBRID_BENCH=ON; WORK (default: a temporary folder)
# keeps the runs, of which those that are there are not made again, and blends.json. BLENDS, WEIGHTS and EQUALISE
# (default "nearest linear dual multi-band", "angle ulr", "false true") choose fewer.
set -euo pipefail
scene=$1
shift
bin="${BUILD_DIR:-$(dirname "$0")/../build}/bin"
if [ -z "${WORK:-}" ]; then
  WORK=$(mktemp -d)
  trap 'rm -rf "$WORK"' EXIT
fi
runs=()
for equalise in ${EQUALISE:-false true}; do
  for weights in ${WEIGHTS:-angle ulr}; do
    for blend in ${BLENDS:-nearest linear dual multi-band}; do
      run="$WORK/$weights-$blend-$equalise"
      runs+=("$run")
      [ -e "$run/summary.json" ] && continue  # the last that a run writes
      "$bin/hybrid" render "$scene" --leave-one-out --out "$run" --quiet --force "$@" \
        --set "render.blend=$blend" --set "render.weights=$weights" --set "render.equalise=$equalise" >/dev/null
    done
  done
done
"$bin/hybrid-compare-views" "$scene" "${runs[@]}" >"$WORK/blends.json"
python3 - "$WORK/blends.json" <<'TABLE'
import json, sys
result = json.load(open(sys.argv[1]))
print(f"{result['scene']}: {result['photographs']} photographs, {100 * result['share_seen_by_all']:.2f} % of their "
      f"pixels seen by all; masks {'identical' if result['masks_identical'] else 'DIFFER'}\n")
print("| weights | blend | equalise | PSNR dB | SSIM | detail |\n|---|---|---|---|---|---|")
for row in result["rows"]:
    options = row["options"]
    print(f"| {options['weights']} | {options['blend']} | {options['equalise']} | {row['psnr_db']:.2f} | {row['ssim']:.4f} | {row['detail']:.3f} |")
TABLE
