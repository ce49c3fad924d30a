# Counts the cases of every suite in the output of `ctest --output-junit FILE`:  awk -f count-tests.awk FILE
# A suite is one ctest test; its output lists its cases. A case that lacks a dependency prints "skipped: CASE: REASON" and
# its suite "skipped cases: N" (tests/support/skip.h): it counts as skipped, not as passed.
function finish() {
  if (counted) {
    if (suite ~ /_part[0-9]$/) n[4] = 0  # filtered: cases of the other parts
    n[2] -= own; n[4] += own
    printf "%-12s %6d cases %6d passed %6d failed %6d skipped\n", suite, n[1], n[2], n[3], n[4]
    for (i = 1; i <= 4; ++i) total[i] += n[i]
  }
  counted = own = 0
}
{ sub(/^[ \t]*<system-out>/, "") }
/<testcase / { finish(); match($0, /name="[^"]*"/); suite = substr($0, RSTART + 6, RLENGTH - 7) }
/test cases:/ {
  line = $0; gsub(/\033\[[0-9;]*m/, "", line); sub(/.*test cases:/, "", line); gsub(/[^0-9 ]/, " ", line)
  split(line, n, " "); counted = 1
}
/^skipped cases: / { own = $3 }
/^skipped: / { reason[++absent] = $0 }
/^[0-9]+ checks passed/ {
  counted = 1
  n[1] = $1 + $4 + $6; n[2] = $1; n[3] = $4; n[4] = $6
}
/<skipped/ { printf "%-12s skipped as a whole\n", suite }
/^contract cases: / { printf "%-12s %6d cases of the tools in them\n", "contract", $3 }
END {
  finish()
  printf "%-12s %6d cases %6d passed %6d failed %6d skipped\n", "total", total[1], total[2], total[3], total[4]
  for (i = 1; i <= absent; ++i) print reason[i]
}
