#!/usr/bin/env bash
# Prints the --gtest_filter of all kernel tests.
grep -rhoP '^TEST(_P)?\(\K\w+' "$(dirname "$0")" --include='*.cpp' | sort -u | sed 's/$/.*/' | paste -sd:
