#!/usr/bin/env bash
# Inserts the help texts of the tools into their pages (tools/ngs-NAME/ngs-NAME.md):
#
#   tests/ci/tool-pages.sh --write [DIR]     rewrites the pages
#   tests/ci/tool-pages.sh --check [DIR]     prints differences without changing the pages; exit code 1 if there are any
#
# The script writes the text between two marks of a page, 100 columns wide:
#
#   <!-- help -->            --help all of the tool and of each of its commands
#   <!-- help: common -->    in DIR/README.md: the part common to all tools, left out of the pages
#   <!-- /help -->           end of a generated text
#
# DIR is the folder of the pages (default: tools). Tools are searched in $NGS_BIN, then in the build folder, then in PATH.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in
  -h | --help) usage_of "$0"; exit 0 ;;
  --write | --check) [ $# -le 2 ] || fail 2 "expected --write or --check, and a folder" "see $0 --help" ;;
  *) fail 2 "expected --write or --check" "see $0 --help" ;;
esac
task=$1 pages=${2:-$top/tools}
[ -f "$pages/README.md" ] || fail 3 "$pages: no README.md, expected the folder of the tools' pages"
bin=$(find_bin)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# help_of TOOL [COMMAND]: help text, independent of terminal and locale.
help_of() { COLUMNS=100 LC_ALL=C "${bin:+$bin/}$1" "${@:2}" --help all < /dev/null; }
# The paragraphs of a help text that are the same for every tool.
common_part() { awk 'BEGIN { RS = ""; ORS = "\n\n" } tolower($0) ~ /^(common|flags of all tools|exit codes)/'; }
# The other paragraphs.
beyond_common() { awk 'BEGIN { RS = ""; ORS = "\n\n" } FILENAME != "-" { known[$0]; next } !($0 in known)' "$work/common" -; }
# shellcheck disable=SC2016  # literal backticks
fenced() { printf '```text\n%s\n```\n' "$(cat)"; }  # $(...) strips trailing empty lines

synopsis_of() {  # TOOL
  local command commands
  commands=$("${bin:+$bin/}$1" --print-commands)
  help_of "$1" | beyond_common | fenced
  for command in $commands; do
    printf '\n'
    help_of "$1" "$command" | beyond_common | fenced
  done
}

# fill TOOL PAGE: rewrites the page, or prints the differences.
fill() {
  local line inside=
  while IFS= read -r line; do
    if [ "$line" = '<!-- /help -->' ]; then inside=; fi
    if [ -z "$inside" ]; then printf '%s\n' "$line"; fi
    case $line in
      '<!-- help -->') inside=1; synopsis_of "$1" ;;
      '<!-- help: common -->') inside=1; fenced < "$work/common" ;;
    esac
  done < "$2" > "$work/new"
  [ -z "$inside" ] || fail 3 "$2: expected '<!-- /help -->' after the last mark"
  if [ "$task" = --check ]; then
    diff -u "$2" "$work/new" || differs=1
  elif ! cmp -s "$2" "$work/new"; then
    cp "$work/new" "$2"
  fi
}

differs=0
help_of ngs-variance | common_part > "$work/common"
fill ngs-variance "$pages/README.md"
for folder in "$pages"/ngs/ "$pages"/ngs-*/; do
  tool=$(basename "$folder")
  grep -qsx '<!-- help -->' "$folder$tool.md" || fail 3 "$folder$tool.md: expected the page of $tool, with a line '<!-- help -->'"
  fill "$tool" "$folder$tool.md"
done
exit "$differs"
