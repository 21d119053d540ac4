#!/usr/bin/env bash
# From a scan's E57 to planes, pose and decimated points, all files written, of a room and of a church: ours and PCL's chain
# in turn. Prints a Markdown table of their parts and leaves end_to_end.md and end_to_end.json in $WORK.
#   bash bench/end_to_end.sh                   20 megapixels, 3 rounds, a quarter of an hour once built
#   bash bench/end_to_end.sh --sizes 1,5       sizes, megapixels
#   --write-results                            puts the table into bench/RESULTS.md
# More options go to hybrid-compare: --rounds N, --threads N. BUILD_DIR and WORK as for compare.sh.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${BUILD_DIR:-$root/build-peers}
work=${WORK:-$build/compare}
sizes=20
more=()
export HYBRID_COMMAND="bash bench/end_to_end.sh${*:+ $*}"
while [ $# -gt 0 ]; do
  case $1 in
    --write-results) more+=(--write-results "$root/bench/RESULTS.md") ;;
    -h | --help) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --sizes) sizes=${2:?end_to_end.sh: --sizes needs a value}; shift ;;
    *) more+=("$1") ;;
  esac
  shift
done
{
  cmake -S "$root" -B "$build" -G Ninja -DHYBRID_PEERS=ON -DCMAKE_BUILD_TYPE=Release
  targets=(hybrid hybrid-synth hybrid-score hybrid-compare)
  ninja -C "$build" -t query pcl_chain >/dev/null 2>&1 && targets+=(pcl_chain)
  cmake --build "$build" --parallel --target "${targets[@]}"
} >&2
HYBRID_COMMIT=$(git -C "$root" describe --always --dirty 2>/dev/null || echo "not known") \
  "$build/bin/hybrid-compare" --bin "$build/bin" --scenes "$work/scenes" --work "$work" --sizes "$sizes" \
  --only end-to-end "${more[@]}"
