#!/usr/bin/env bash
# The paper's figure 6 as numbers: every photograph made from the others by the proxy alone, by the scans alone and by both:
# bench/constituents.sh SCENE.toml [--set SECTION.KEY=VALUE]... prints a Markdown table. Beside a detail.ply, as
# hybrid-synth makes one, the same photographs on that true mesh are the last row. BUILD_DIR (default build) holds the
# programs, built with -DHYBRID_BENCH=ON; WORK (default: a temporary folder) keeps the runs.
set -euo pipefail
scene=$(realpath "$1")
shift
bin="$(cd "${BUILD_DIR:-$(dirname "$0")/../build}" && pwd)/bin"
if [ -z "${WORK:-}" ]; then
  WORK=$(mktemp -d)
  trap 'rm -rf "$WORK"' EXIT
fi
mkdir -p "$WORK"
left_out() { # FOLDER SCENE OPTION...
  local out="$WORK/$1"
  shift
  "$bin/hybrid" render "$@" --leave-one-out --out "$out" --quiet --force >/dev/null
}
for shown in proxy scan both; do left_out $shown "$scene" --show $shown "$@"; done
rows=(proxy scan both)
truth="$(dirname "$scene")/detail.ply"
if [ -e "$truth" ]; then
  mesh="$WORK/true-mesh"
  mkdir -p "$mesh"
  ln -sfn "$(dirname "$scene")"/{cameras,photographs} "$mesh/"
  # Neither scans nor views, and another model.
  awk '/^\[/ { keep = !/^\[\[(scan|view)\]\]/ } keep { sub(/"proxy.obj"/, "\"detail.obj\""); if (!/^truth/) print }' "$scene" >"$mesh/scene.toml"
  python3 - "$truth" "$mesh/detail.obj" <<'OBJ'
import struct, sys
data = open(sys.argv[1], "rb").read()
head, body = data[:data.index(b"end_header\n")].decode(), data.index(b"end_header\n") + 11
count = {line.split()[1]: int(line.split()[2]) for line in head.splitlines() if line.startswith("element")}
vertex, face = struct.Struct("<3f"), struct.Struct("<B3i2i")
with open(sys.argv[2], "w") as out:
    for i in range(count["vertex"]):
        out.write("v %.6f %.6f %.6f\n" % vertex.unpack_from(data, body + i * vertex.size))
    body += count["vertex"] * vertex.size
    for i in range(count["face"]):
        corners = face.unpack_from(data, body + i * face.size)
        out.write("f %d %d %d\n" % tuple(c + 1 for c in corners[1:4]))
OBJ
  left_out mesh "$mesh/scene.toml"
  rows+=(mesh)
fi
compare() { (cd "$WORK" && "$bin/hybrid-compare-views" "$scene" "$@"); }
compare "${rows[@]}" >"$WORK/all.json"
compare $(printf '%s\n' "${rows[@]}" | grep -v scan) >"$WORK/without-scan.json"
python3 - "$WORK" "${rows[@]}" <<'TABLE'
import json, sys
work, rows = sys.argv[1], sys.argv[2:]
table = {name: {row["folder"]: row for row in json.load(open(f"{work}/{name}.json"))["rows"]} for name in ("all", "without-scan")}
share = {name: 100 * json.load(open(f"{work}/{name}.json"))["share_seen_by_all"] for name in table}
print(f"| shown | seen, % | PSNR, dB, and SSIM of what it sees | on what all see ({share['all']:.1f} %) "
      f"| on what all but the scans alone see ({share['without-scan']:.1f} %) |\n|---|---|---|---|---|")
for row in rows:
    own = json.load(open(f"{work}/{row}/summary.json"))["leave_one_out"]["mean"]
    other = table["without-scan"].get(row)
    print(f"| {row} | {100 * own['share_seen']:.1f} | {own['psnr_db']:.2f}, {own['ssim']:.3f} "
          f"| {table['all'][row]['psnr_db']:.2f}, {table['all'][row]['ssim']:.3f} "
          f"| {'%.2f, %.3f' % (other['psnr_db'], other['ssim']) if other else '-'} |")
TABLE
