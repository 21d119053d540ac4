#!/usr/bin/env bash
# Runs every kernel test on a GPU. Usage: kernels_on_gpu.sh PATH_OF_hybrid_tests [PATH_OF_libhybrid_as_a_gpu.so]
# With the second as if the CPU were one.
set -euo pipefail
suites=$(bash "$(dirname "$0")/../kernels/filter.sh")
LD_PRELOAD=${2:-} HYBRID_TEST_DEVICE=gpu "$1" --gtest_filter="$suites"
