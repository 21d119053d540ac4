#!/usr/bin/env bash
# Ours and every peer side by side on the same inputs, in turn: prints one Markdown table and leaves compare.md,
# compare.json and the plots planes-time.svg and planes-memory.svg in $WORK.
#   bash bench/compare.sh            1, 5, 20 and 100 megapixels; what would take a minute is extrapolated
#   bash bench/compare.sh --quick    1 megapixel, one round, under 2 minutes once built and the scan is made
#   bash bench/compare.sh --full     everything is run, however long it takes
# More options go to hybrid-compare: --only planes|squares|icp|rays, --rounds N, --threads N, --sizes 1,5.
# BUILD_DIR (default build-peers) is configured with -DHYBRID_PEERS=ON and built; WORK (default BUILD_DIR/compare) holds
# scenes and results; HYBRID_PEERS_DIR: builds of programs that no package has (bench/peers/README.md). The scenes are
# made once and kept (100 megapixels: about 2 GB, a quarter of an hour); their making is not part of the comparison.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${BUILD_DIR:-$root/build-peers}
work=${WORK:-$build/compare}
sizes=1,5,20,100
rounds=3
more=()
while [ $# -gt 0 ]; do
  case $1 in
    --quick) sizes=1 rounds=1 more+=(--quick) ;;
    --sizes | --rounds)
      [ $# -ge 2 ] || { echo "compare.sh: $1 needs a value" >&2; exit 2; }
      if [ "$1" = --sizes ]; then sizes=$2; else rounds=$2; fi
      shift ;;
    -h | --help) sed -n '2,13s/^# \{0,1\}//p' "$0"; exit 0 ;;
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
mkdir -p "$work/scenes"
for size in 0.25 ${sizes//,/ }; do
  scene=$work/scenes/room-$size
  [ -e "$scene/scene.toml" ] && continue
  echo "making $scene" >&2
  "$build/bin/hybrid-synth" room --out "$scene" --seed 1 --preset tiny --megapixels "$size" --quiet
done
HYBRID_COMMIT=$(git -C "$root" describe --always --dirty 2>/dev/null || echo "not known") \
  "$build/bin/hybrid-compare" --bin "$build/bin" --scenes "$work/scenes" --work "$work" --sizes "$sizes" --rounds "$rounds" "${more[@]}"
