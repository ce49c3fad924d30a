#!/usr/bin/env bash
# What CI has no time for: makes the archives of Linux, CUDA (if nvcc is found) and Windows, and the image, and tests them;
# tests the studio as one page (if emscripten is found); runs the suites unit, contract and studio under ASan with UBSan,
# and under TSan (clang++ with libomp, which TSan knows).
#
#   tests/ci/weekly.sh [OUT]      OUT: folder of the files (default: build-bundle)
#
# A line per step: ok, FAIL or SKIP, and its minutes. Exit code 1 if a step failed. Logs: build-bundle/weekly/
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
out=${1:-$top/build-bundle} logs=$top/build-bundle/weekly
mkdir -p "$out" "$logs"

failed=0
step() {  # NAME COMMAND...
  local name=$1 word=ok begin=$SECONDS
  shift
  "$@" > "$logs/$name.log" 2>&1 || case $? in 77) word=SKIP ;; *) word=FAIL failed=1 ;; esac
  printf '%-4s %s, %d min\n' $word "$name" $(((SECONDS - begin) / 60)) >&2
}

# shellcheck disable=SC2317  # called by step
sanitized() {  # PRESET FOLDER
  NGS_PRESET=$1 "$top/pipelines/build.sh" --target tools test_unit test_contract &&
    ctest --test-dir "$top/$2" -L '^(unit|contract|studio)$' --output-on-failure
}

step linux "$top/pipelines/bundle.sh" -o "$out"
if PATH=$PATH:${CUDA_HOME:-/usr/local/cuda}/bin command -v nvcc > /dev/null; then
  step cuda "$top/pipelines/bundle.sh" --cuda -o "$out"
fi
step linux-test "$top/tests/ci/bundle.sh" "$out"
step windows "$top/pipelines/bundle/windows.sh" -o "$out"
step windows-system-test "$top/tests/ci/windows.sh"
step web "$top/tests/studio/web.sh"
step contract-suite env NGS_PRESET=ci "$top/pipelines/build.sh" --target test_contract ngs_bench
step windows-test "$top/tests/ci/windows-archive.sh" "$out" --contract ''
step container "$top/tests/ci/container.sh"
step asan sanitized asan-ubsan build-asan
if command -v clang++ > /dev/null; then
  export TSAN_OPTIONS=ignore_noninstrumented_modules=1  # system libraries
  step tsan sanitized tsan build-tsan
fi
exit "$failed"
