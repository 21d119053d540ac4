#!/usr/bin/env bash
# Time and memory of a view and of the atlas with many large photographs: bench/photograph_memory.sh CHURCH, a folder that
# `hybrid-synth church --preset demo` made. Its ten photographs, enlarged to 45 megapixels, are linked under COPIES (10) names
# each, a centimetre apart; the proxy alone carries them. Prints a Markdown table: photograph_mb, peak memory, CPU seconds, and
# whether the bytes are those of the first row. BUDGETS (default "4096 1024 512"), BUILD_DIR (build), WORK (a temporary folder).
set -euo pipefail
church=$(cd "$1" && pwd)
hybrid="$(cd "${BUILD_DIR:-$(dirname "$0")/../build}" && pwd)/bin/hybrid"
if [ -z "${WORK:-}" ]; then
  WORK=$(mktemp -d)
  trap 'rm -rf "$WORK"' EXIT
fi
mkdir -p "$WORK/photographs" "$WORK/cameras"
scale=5.375
copies=${COPIES:-10}
for picture in "$church"/photographs/*.jpg; do
  name=$(basename "$picture" .jpg)
  large="$WORK/photographs/$name-0.jpg"
  [ -e "$large" ] || oiiotool "$picture" --resize 7740x5805 --quality 92 -o "$large"
  for ((k = 1; k < copies; ++k)); do ln -f "$large" "$WORK/photographs/$name-$k.jpg"; done
done
awk -v s=$scale '!/^#/ { $3 *= s; $4 *= s; $5 *= s; $6 *= s; $7 *= s; print }' "$church/cameras/cameras.txt" >"$WORK/cameras/cameras.txt"
awk -v n="$copies" '/jpg$/ { for (k = 0; k < n; ++k) { name = $10; sub(/\.jpg$/, "-" k ".jpg", name)
  print ++id, $2, $3, $4, $5, $6 + 0.01 * k, $7, $8, 1, name "\n" } }' "$church/cameras/images.txt" >"$WORK/cameras/images.txt"
: >"$WORK/cameras/points3D.txt"
cp "$church/proxy.obj" "$WORK/"
cat >"$WORK/scene.toml" <<SCENE
[scene]
name = "many large photographs"
[model]
file = "proxy.obj"
unit = "m"
up = "z"
[photographs]
colmap = "cameras"
images = "photographs"
[[view]]
name = "front"
eye = [-4.6, -11.5, 1.9]
target = [0.5, 0.0, 4.7]
fov_deg = 60.0
size = [1920, 1080]
SCENE
echo "| | photograph_mb | peak MB | CPU s | same bytes |"
echo "|---|---|---|---|---|"
for what in view atlas; do
  first=
  for budget in ${BUDGETS:-4096 1024 512}; do
    out="$WORK/$what-$budget"
    rm -rf "$out"
    only=render
    [ $what = atlas ] && only=export
    /usr/bin/time -o "$WORK/time" -f "%M %U %S" "$hybrid" run "$WORK/scene.toml" --only $only --quiet --out "$out" \
      --set export.formats=glb --set "render.photograph_mb=$budget" >/dev/null
    read -r peak user system <"$WORK/time"
    sum=$(cd "$out" && find . -name "*.png" -o -name "*.exr" -o -name "*.glb" | sort | xargs cat | sha256sum)
    first=${first:-$sum}
    echo "| $what | $budget | $((peak / 1024)) | $(awk "BEGIN { print int($user + $system + 0.5) }") | $([ "$sum" = "$first" ] && echo yes || echo NO) |"
  done
done
