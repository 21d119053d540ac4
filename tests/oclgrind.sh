#!/usr/bin/env bash
# Runs every kernel test at its small sizes under oclgrind: out-of-bounds accesses and data races fail.
# Usage: tests/oclgrind.sh PATH_OF_hybrid_tests
set -euo pipefail
tests=$1
suites=$(bash "$(dirname "$0")/kernels/filter.sh")
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# PORTABLE, as on a GPU: its interpreter knows no vector reductions.
# -O1: at its default level its compiler leaves hints in inlined functions that its interpreter does not know.
HYBRID_SMALL_SIZES=1 oclgrind --build-options "-O1 -DPORTABLE" --data-races --max-errors 20 --log "$log" "$tests" --gtest_filter="$suites"
if [ -s "$log" ]; then
  echo "oclgrind found:" >&2
  cat "$log" >&2
  exit 1
fi
