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
"$pipelines/build.sh"

failed=0
ctest --test-dir build --output-on-failure --output-junit tests.xml --test-output-size-passed 10000000 \
  "$@" || failed=$?

# A suite is one ctest test; what it says about its cases is in its output. Counting these shows a suite that
# passes because it skipped.
awk '
  /<testcase / { match($0, /name="[^"]*"/); suite = substr($0, RSTART + 6, RLENGTH - 7) }
  /test cases:/ {
    line = $0; gsub(/\033\[[0-9;]*m/, "", line); sub(/.*test cases:/, "", line); gsub(/[^0-9 ]/, " ", line)
    split(line, n, " ")
    printf "%-12s %6d cases %6d passed %6d failed %6d skipped\n", suite, n[1], n[2], n[3], n[4]
    for (i = 1; i <= 4; ++i) total[i] += n[i]
  }
  /^[0-9]+ checks passed/ {
    printf "%-12s %6d cases %6d passed %6d failed %6d skipped\n", "clients", $1 + $4 + $6, $1, $4, $6
    total[1] += $1 + $4 + $6; total[2] += $1; total[3] += $4; total[4] += $6
  }
  /<skipped/ { printf "%-12s skipped as a whole\n", suite }
  /^contract cases: / { printf "%-12s %6d cases of the tools in them\n", "contract", $3 }
  tolower($0) ~ /message: .*skip/ { ++absent }
  END {
    printf "%-12s %6d cases %6d passed %6d failed %6d skipped\n", "total", total[1], total[2], total[3], total[4]
    if (absent) printf "%d checks were skipped because something they need is absent\n", absent
  }' build/tests.xml
exit "$failed"
