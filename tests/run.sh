#!/usr/bin/env bash
# Sets everything up and runs the tests: bash tests/run.sh [a regular expression of test names]
# BUILD_DIR (default build) and CMAKE_ARGS (e.g. -DHYBRID_WERROR=ON) may be set.
set -euo pipefail
cd "$(dirname "$0")/.."
bash datasets/setup.sh
build="${BUILD_DIR:-build}"
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release ${CMAKE_ARGS:-}
cmake --build "$build"
ctest --test-dir "$build" --output-on-failure -j "$(nproc)" ${1:+-R "$1"}
