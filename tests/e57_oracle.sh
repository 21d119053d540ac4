#!/usr/bin/env bash
# Compares the E57 reader's values with an independent decoder, npm's web-e57 in node, on the public samples:
#   bash tests/e57_oracle.sh build/bin/hybrid [FILE...]
# For developers: (cd SOMEWHERE && npm install web-e57), then WEB_E57=SOMEWHERE/node_modules/web-e57. Without
# node, package or samples it is skipped (exit code 77).
set -uo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
hybrid=$1; shift
data=${HYBRID_DATA:-$root/../shared/data}
package=${WEB_E57:-$root/node_modules/web-e57}
skip() { echo "skipped: $*"; exit 77; }
command -v node >/dev/null || skip "no node"
[ -f "$package/e57.js" ] || skip "no web-e57: npm install web-e57, and WEB_E57=.../node_modules/web-e57"
files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(find "$data/scans" -name '*.e57' 2>/dev/null | sort)
[ ${#files[@]} -gt 0 ] || skip "no samples: needs ../shared/data or HYBRID_DATA"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
list=()
for file in "${files[@]}"; do
  to=$scratch/${#list[@]}.ptx  # holds all: order, no-returns, pose
  "$hybrid" convert "$file" "$to" >/dev/null 2>&1 || to=refused
  list+=("$file" "$to")
done
NODE_NO_WARNINGS=1 node --experimental-wasm-modules "$root/tests/e57_oracle.mjs" "$package" "${list[@]}"
