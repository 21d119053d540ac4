#!/usr/bin/env bash
# Ours and every peer side by side on the same inputs, in turn: prints one Markdown table and leaves compare.md,
# compare.json and the plots planes-time.svg and planes-memory.svg in $WORK.
#   bash bench/compare.sh            1, 5, 20 and 100 megapixels, within a quarter of an hour once built; what would take
#                                    over a minute is extrapolated, at 100 megapixels all but ours and the plain twin
#   bash bench/compare.sh --quick    1 megapixel, one round, a minute once built
#   bash bench/compare.sh --full     everything is run, however long it takes
#   --write-results                  puts table and plots into bench/RESULTS.md and bench/peers; jobs and sizes that were
#                                    not run this time stay there under the heading of their own run
# More options go to hybrid-compare: --only planes|squares|icp|rays|e57, --rounds N, --threads N, --sizes 1,5,
# --minutes N, --e57 FILE.
# BUILD_DIR (default build-peers) is configured with -DHYBRID_PEERS=ON and built; WORK (default BUILD_DIR/compare) holds
# scans and results; HYBRID_PEERS_DIR: builds of programs that no package has (bench/peers/README.md). Scans are made
# once and kept: 100 megapixels take two minutes; with the results on them 4 GB.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${BUILD_DIR:-$root/build-peers}
work=${WORK:-$build/compare}
sizes=1,5,20,100
rounds=3
more=()
export HYBRID_COMMAND="bash bench/compare.sh${*:+ $*}"
while [ $# -gt 0 ]; do
  case $1 in
    --quick) sizes=1 rounds=1 more+=(--quick) ;;
    --sizes | --rounds)
      [ $# -ge 2 ] || { echo "compare.sh: $1 needs a value" >&2; exit 2; }
      if [ "$1" = --sizes ]; then sizes=$2; else rounds=$2; fi
      shift ;;
    --write-results) more+=(--write-results "$root/bench/RESULTS.md") ;;
    -h | --help) sed -n '2,14s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) more+=("$1") ;;
  esac
  shift
done
for size in ${sizes//,/ }; do
  [[ $size =~ ^[0-9]+(\.[0-9]+)?$ ]] || { echo "compare.sh: --sizes: expected megapixels like 1,5,20; found $size" >&2; exit 2; }
done

{
  cmake -S "$root" -B "$build" -G Ninja -DHYBRID_PEERS=ON -DCMAKE_BUILD_TYPE=Release
  cmake --build "$build" --parallel --target hybrid_peers
} >&2
HYBRID_COMMIT=$(git -C "$root" describe --always --dirty 2>/dev/null || echo "not known") \
  "$build/bin/hybrid-compare" --bin "$build/bin" --scenes "$work/scenes" --work "$work" --sizes "$sizes" --rounds "$rounds" "${more[@]}"
