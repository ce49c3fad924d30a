#!/usr/bin/env bash
# Fuzzes the readers of untrusted files with libFuzzer (clang++, Debian package clang) under ASan and UBSan, and prints how
# often each reader ran:
#   tests/ci/fuzz.sh [--minutes M] [--jobs N] [--keep DIR] [READER...]
# READER: a folder of tests/fuzz/corpus; default: all of them. M minutes (default 30) each, N (default: one per CPU) in
# parallel, at the lowest priority. New inputs stay in build-fuzz/corpus, and the next call resumes from them. --keep copies
# 16 inputs per reader, of all sizes, from a set that covers all reached edges, to DIR/READER: with tests/fuzz/corpus as DIR,
# later runs of the suite fuzz replay them.
# A finding is written to build-fuzz/findings and gives exit code 1; without clang++ the exit code is 77 (skipped).
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
cd "$top"

minutes=30 jobs=$(nproc) keep="" readers=()
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) minutes=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --keep) keep=$2; shift 2 ;;
    -*) echo "unknown option $1; see --help" >&2; exit 2 ;;
    *) readers+=("$1"); shift ;;
  esac
done
if [ ${#readers[@]} -eq 0 ]; then readers=(tests/fuzz/corpus/*/); readers=("${readers[@]%/}"); readers=("${readers[@]##*/}"); fi
if ! command -v clang++ >/dev/null; then
  echo "skipped: no clang++ (Debian package clang); tests/fuzz/replay_test.cpp still replays the corpus" >&2
  exit 77
fi

cmake --preset fuzz >/dev/null
ninja -C build-fuzz "${readers[@]/#/fuzz_}" >&2
mkdir -p build-fuzz/findings build-fuzz/log
# inputs above 64 KiB reach no further code; an allocation of 512 MiB, 2 GiB in total or 300 s for one input are
# findings
limits=(-max_len=65536 -malloc_limit_mb=512 -rss_limit_mb=2048 -timeout=300)

fuzz() {  # READER
  mkdir -p "build-fuzz/corpus/$1"
  local TIMEFORMAT='cpu_s: %U'
  { time UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 nice -n 19 "build-fuzz/bin/fuzz_$1" "${limits[@]}" \
    -max_total_time=$((minutes * 60)) -print_final_stats=1 -artifact_prefix="build-fuzz/findings/$1-" \
    "build-fuzz/corpus/$1" "tests/fuzz/corpus/$1"; } >"build-fuzz/log/$1" 2>&1
}
keep_some() {  # READER
  local all=build-fuzz/kept/$1 files i
  rm -rf "$all"
  mkdir -p "$all" "$keep/$1"
  "build-fuzz/bin/fuzz_$1" "${limits[@]}" -max_len=2048 -use_counters=0 -set_cover_merge=1 "$all" "tests/fuzz/corpus/$1" \
    "build-fuzz/corpus/$1" >>"build-fuzz/log/$1" 2>&1
  mapfile -t files < <(ls -Sr "$all")
  for ((i = 0; i < ${#files[@]}; i += (${#files[@]} + 15) / 16)); do
    cp "$all/${files[i]}" "$keep/$1/found-${files[i]:0:10}"
  done
}
for reader in "${readers[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n || true; done
  fuzz "$reader" &
done
wait

printf '%-16s %12s %9s %9s %9s %9s  %s\n' reader executions 'wall s' 'CPU s' edges inputs finding
found=0
for reader in "${readers[@]}"; do
  log=build-fuzz/log/$reader
  line=$(grep -E ' cov: [0-9]+' "$log" | tail -1)
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  seconds=$(sed -n 's/^Done [0-9]* runs in \([0-9]*\) second.*/\1/p' "$log")
  finding=none
  if grep -q -E '^SUMMARY: ' "$log" || [ -z "$seconds" ]; then finding="see $log" found=1; fi
  printf '%-16s %12s %9s %9s %9s %9s  %s\n' "$reader" "${runs:--}" "${seconds:--}" "$(sed -n 's/^cpu_s: //p' "$log")" \
    "$(sed -E 's/.* cov: ([0-9]+).*/\1/' <<<"$line")" "$(find "build-fuzz/corpus/$reader" -type f | wc -l)" "$finding"
  if [ -n "$keep" ]; then keep_some "$reader"; fi
done
exit "$found"
