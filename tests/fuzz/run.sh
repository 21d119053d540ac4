#!/usr/bin/env bash
# Fuzzes the readers: bash tests/fuzz/run.sh [TARGET|all] [EXECUTIONS]
# Builds with clang (AddressSanitizer, UndefinedBehaviorSanitizer), runs each target up to EXECUTIONS in all
# (default 10,000,000; scans only unless a target is named) and prints for each how many ran and what was
# found. Corpus, findings and counts are kept in $HYBRID_FUZZ_DIR (default /tmp/hybrid-fuzz): the same command
# goes on where the last one was ended, by Ctrl-C too, for as many nights as it takes; $HYBRID_FUZZ_DIR/counts
# holds the executions of all of them. HYBRID_FUZZ_SECONDS limits the time per target, HYBRID_FUZZ_JOBS=2 runs
# two targets at a time.
# bash tests/fuzz/run.sh minimise: writes the smallest corpora that cover the same to tests/fuzz/corpus.
set -uo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
dir=${HYBRID_FUZZ_DIR:-/tmp/hybrid-fuzz}
what=${1:-all} executions=${2:-10000000} seconds=${HYBRID_FUZZ_SECONDS:-0}
mkdir -p "$dir"
build() {
  flock 9  # one of several campaigns at a time
  cmake -S "$root" -B "$dir/build" -G Ninja -DHYBRID_FUZZ=ON -DHYBRID_BENCH=OFF -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_C_COMPILER=clang >"$dir/configure.log" || { cat "$dir/configure.log" >&2; return 1; }
  nice -n 19 ninja -C "$dir/build" hybrid_fuzz >"$dir/build.log" || { tail -40 "$dir/build.log" >&2; return 1; }
}
[ "$what" = only ] || build 9>"$dir/lock" || exit 1
fuzz=$dir/build/bin/hybrid_fuzz
# One allocation of 64 MiB, for inputs of some kilobytes, is a finding (as is a second for one input). No stack of
# every allocation, and a quarantine that stays in the cache: they cost a sixth of the time. No new mapping for
# the shadow of a large buffer: it cost range images a third. New memory is left as it is: filled with one byte,
# what is read of it looks the same in every reading of a file, and nobody sees that it was read. To see where
# memory of a finding came from, run its input alone with ASAN_OPTIONS=malloc_context_size=30.
export ASAN_OPTIONS=allocator_may_return_null=0:detect_leaks=0:quarantine_size_mb=1:malloc_context_size=0:max_malloc_fill_size=0:max_allocation_size_mb=64:clear_shadow_mmap_threshold=$((1 << 30))
export UBSAN_OPTIONS=print_stacktrace=1

scans="samples ptx pts xyz ply_ascii ply_binary pcd_ascii pcd_binary pcd_compressed las foreign_exr range_exr records_exr e57 e57_xml e57_bits"
grouped() { sed -E ':a; s/^([0-9]+)([0-9]{3})/\1,\2/; ta' <<<"$1"; }  # 1234567 -> 1,234,567
# Executions of a target in all campaigns: counted in a file of its own, so that targets can run side by side.
count_of() { if [ -s "$dir/executions/$1" ]; then cat "$dir/executions/$1"; else echo 0; fi; }
write_counts() {
  (cd "$dir/executions" && for file in *; do [ -s "$file" ] && echo "$file $(cat "$file")"; done) >"$dir/counts.$$"
  mv "$dir/counts.$$" "$dir/counts"
}
limit() { "$fuzz" --list | awk -v name="$1" '$1 == name { print $2 }'; }

run_one() {  # until the executions of all runs together are reached, or a finding stops it
  local target=$1 corpus=$dir/corpus/$1 found=$dir/findings/$1 count=$dir/executions/$1
  local before done speed=0 size log status
  size=$(limit "$target")
  [ -n "$size" ] || { echo "no target $target; there are:" >&2; "$fuzz" --list >&2; return 2; }
  mkdir -p "$corpus" "$found" "$dir/executions"
  HYBRID_FUZZ_TARGET=$target "$fuzz" --seeds "$corpus" || return 1
  [ -d "$root/tests/fuzz/corpus/$target" ] && cp -n "$root/tests/fuzz/corpus/$target"/* "$corpus"
  before=$(count_of "$target") done=$before
  if [ "$done" -lt "$executions" ]; then
    log=$found/log
    HYBRID_FUZZ_TARGET=$target nice -n 19 "$fuzz" -runs=$((executions - done)) -max_total_time="$seconds" \
      -max_len="$size" -rss_limit_mb=3000 -timeout=100 -print_final_stats=1 \
      -artifact_prefix="$found/" -reload=0 -entropic=0 "$corpus" >"$log" 2>&1
    status=$?
    done=$((done + $(awk '/stat::number_of_executed_units/ { n = $2 } END { print n + 0 }' "$log")))
    speed=$(awk '/stat::average_exec_per_sec/ { n = $2 } END { print n + 0 }' "$log")
    echo "$done" >"$count"
    write_counts
    [ "$status" -eq 0 ] || grep -m1 -E 'ERROR|what\(\)|runtime error|SUMMARY' "$log"
  fi
  printf '%s: %s in this run (%d per second), %s in all, %d findings\n' "$target" "$(grouped $((done - before)))" \
    "$speed" "$(grouped "$done")" "$(find "$found" -name 'crash-*' -o -name 'oom-*' -o -name 'timeout-*' | wc -l)"
}

minimise() {  # into the repository: what covers the same, the smallest first, at most 40 inputs of 4 KiB
  local target=$1 to=$root/tests/fuzz/corpus/$1 least=$dir/least
  rm -rf "$least" && mkdir -p "$least"
  HYBRID_FUZZ_TARGET=$target nice -n 19 "$fuzz" -merge=1 -max_len=4096 "$least" "$dir/corpus/$target" \
    >"$dir/merge.log" 2>&1 || { tail -3 "$dir/merge.log" >&2; return 1; }
  mkdir -p "$to"
  find "$to" -type f ! -name 'finding-*' -delete
  HYBRID_FUZZ_TARGET=$target "$fuzz" --seeds "$to"
  find "$least" -type f -printf '%s %p\n' | sort -n | awk 'NR % 3 == 1 { print $2 }' | head -40 |
    while read -r file; do cp "$file" "$to/$(basename "$file" | cut -c1-12)"; done
  du -sb "$to"
}

[ "$what" = all ] && trap : INT  # Ctrl-C ends the targets, and the sum is printed
case $what in
  minimise) for target in $scans; do minimise "$target"; done ;;
  all) printf '%s\n' $scans | xargs -P "${HYBRID_FUZZ_JOBS:-1}" -I TARGET bash "$0" only "$executions" TARGET ;;
  only) run_one "$3" ;;  # of `all`: built already
  *) run_one "$what" ;;
esac
status=$?
if [ "$what" = all ]; then
  [ -s "$dir/counts" ] && awk '{ sum += $2 } END { print sum }' "$dir/counts" | { read -r sum; echo "all targets: $(grouped "${sum:-0}") in all campaigns"; }
fi
exit $status
