#!/usr/bin/env bash
# Sets up, builds and runs all tests; prints how many passed, failed and were skipped, per suite and in total.
#   pipelines/check.sh [--no-setup] [ctest arguments, e.g. -L unit]
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
cd "$pipelines/.."
if [ "${1:-}" = "--no-setup" ]; then
  shift
else
  "$pipelines/setup.sh"
fi
NGS_PRESET=${NGS_PRESET:-ci} "$pipelines/build.sh"  # all tests; device code is compiled if nvcc is found

failed=0
ctest --test-dir build -j2 --output-on-failure --output-junit tests.xml --test-output-size-passed 10000000 \
  "$@" || failed=$?

awk -f "$top/tests/ci/count-tests.awk" build/tests.xml
exit "$failed"
