#!/usr/bin/env bash
# Writes the table of --quality from the benchmark: the paragraph in the help text of ngs-joint and the one in README.md.
#
#   pipelines/quality-table.sh                    from pipelines/quality.json
#   pipelines/quality-table.sh POINTS.csv WHAT    that from the quality@... rows of pipelines/work-precision.mk, the mean of
#                                                 those of one quality (repeats, or pages joined by cat); WHAT was run
#   pipelines/quality-table.sh --check            changes nothing, says what differs
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case $#:${1:-} in
  *:-h | *:--help) usage_of "$0"; exit 0 ;;
  0: | 1:--check | 2:*) ;;
  *) fail 2 "expected nothing, --check, or POINTS.csv WHAT" "see $0 --help" ;;
esac
json=$pipelines/quality.json header=$pipelines/../tools/ngs-joint/quality_table.h readme=$pipelines/../README.md

from_csv() {  # one object per line, in the order of --quality
  awk -F, -v what="$2" '
    $1 == "quality" && $4 == 0 { ++runs[$2]; iou[$2] += $7; biou[$2] += $8; fine[$2] += $9; cpu[$2] += $6 }
    END {
      printf "{\"what\": \"%s\",\n \"points\": [", what
      n = split("draft standard high reference", order, " ")
      for (i = 1; i <= n; ++i) if (r = runs[q = order[i]])
        printf "%s\n  {\"quality\": \"%s\", \"cpu_s\": %.1f, \"iou\": %.4f, \"biou\": %.4f, \"biou_005\": %.4f}", (some++ ? "," : ""), q, cpu[q] / r, iou[q] / r, biou[q] / r, fine[q] / r
      print "\n ]}"
    }' "$1"
}

rows() {  # FORMAT: quality, CPU seconds, scores
  sed -n 's/.*"quality": "\([a-z]*\)", "cpu_s": \([0-9.]*\), "iou": \([0-9.]*\), "biou": \([0-9.]*\), "biou_005": \([0-9.]*\).*/\1 \2 \3 \4 \5/p' "$json" |
    while read -r quality cpu iou biou fine; do
      # shellcheck disable=SC2059
      printf "$1" "$quality" "$cpu" "$iou" "$biou" "$fine"
    done
}
what() { sed -n 's/.*"what": "\(.*\)",$/\1/p' "$json"; }

header_text() {
  echo '#pragma once'
  echo '// Written by pipelines/quality-table.sh from pipelines/quality.json; do not edit.'
  echo
  echo 'namespace ngs::joint {'
  echo
  echo 'inline constexpr const char* kQualityTable ='
  echo '    "quality, as measured:\n"'
  echo "    \"  $(what)\\n\""
  echo '    "              CPU s     IoU   B-IoU   0.005\n"'
  rows '    "  %-10s %7s  %.4f  %.4f  %.4f\\n"\n' | sed '$s/$/;/'
  echo
  echo '}  // namespace ngs::joint'
}
readme_text() {
  echo '<!-- quality: written by pipelines/quality-table.sh -->'
  echo "| \`--quality\` | CPU s of ngs-joint | IoU | B-IoU 0.02 | B-IoU 0.005 |"
  echo '|---|---|---|---|---|'
  rows '| `%s` | %s | %.4f | %.4f | %.4f |\n'
  echo
  echo "Measured: $(what)."
  echo '<!-- /quality -->'
}
new_readme() {
  readme_text >"$1.block"
  awk -v block="$1.block" '
    /^<!-- quality:/ { while ((getline line < block) > 0) print line; skip = 1 }
    !skip { print }
    /^<!-- \/quality -->/ { skip = 0 }' "$readme"
}

if [ $# -eq 2 ]; then from_csv "$1" "$2" >"$json"; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
header_text >"$work/header"
new_readme "$work/readme" >"$work/new"
if [ "${1:-}" = --check ]; then
  diff "$header" "$work/header" && diff "$readme" "$work/new"
else
  cp "$work/header" "$header"
  cp "$work/new" "$readme"
fi
