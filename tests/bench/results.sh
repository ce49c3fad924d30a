#!/usr/bin/env bash
# Measured results: one JSON file per question, and the tables generated from these files.
#
#   tests/bench/results.sh QUESTION...        measures and writes tests/bench/results/QUESTION.json; `all`: all but the last line's
#   tests/bench/results.sh --list             all questions with their measuring time and topic
#   tests/bench/results.sh --table QUESTION   prints its table
#   tests/bench/results.sh no-harm            a gate too: exit code 1 if the default scores below the closed form
#   tests/bench/results.sh alone halves instances     with no-harm what `all` leaves out; perhaps of other commits
#   tests/bench/results.sh --write            updates the tables of BENCHMARKS.md, README.md and ngs-joint --help
#   tests/bench/results.sh --check            prints what --write would change; exit code 1 if anything differs, or if
#                                             questions, results and the pages' tables do not belong together
#
# Two threads, one run at a time; for tables with times, nothing else may run on the machine. An interrupted call resumes
# if the commit is the same: the runs are in build/results/COMMIT/QUESTION/ (delete a folder to measure it again).
#
#   NGS_SCENES     folder of the captures            (default: ../shared/scenes next to the checkout)
#   NGS_BIN        tools of another build, used as it is; NGS_COMMIT then names its commit
#   NGS_MACHINE    name of the machine in tables     (default: by the processor)
#   SPLITS='every:4:2' CAPTURES='bird' RECIPES='table' METHODS='flash ngs' REPEATS=1     a part of a question; noted in its table
#   VARIANTS='--no-finish|--fill off'    halves: options of ngs-extract, a row each after the row of its defaults
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/bench/results/helpers.sh
. "$top/tests/bench/results/helpers.sh"

results=$top/tests/bench/results
questions=(captures removed museum recipes qualities effects ablation times kernels stability)
separate=(alone halves no-harm instances)  # long, without times: before finish, fill, a default or ngs-group changes
for question in "${questions[@]}" "${separate[@]}"; do
  # shellcheck disable=SC1090
  . "$top/tests/bench/results/$question.sh"
done

# The last commit that changed the measured sources, without documents and files that --write generates.
commit_of_source() {
  local measured=(libngs tools ':!*.md' ":!tools/ngs-joint/quality_table.h")
  if [ -n "${NGS_COMMIT:-}" ]; then printf '%s\n' "$NGS_COMMIT"; return; fi
  [ -z "${NGS_BIN:-}" ] || fail 2 "NGS_BIN is set, NGS_COMMIT is not" "set it to the commit of these tools"
  git -C "$top" diff --quiet HEAD -- "${measured[@]}" ||
    fail 4 "libngs or tools differ from the last commit" "commit first: tables contain the commit"
  git -C "$top" log -1 --format=%h --abbrev=7 -- "${measured[@]}"
}

# Measures question $1 and writes its file. Adds up the times of interrupted calls.
measure() {
  question=$1 work=$runs/$1 began=$SECONDS
  mkdir -p "$work" "$results"
  say "== $question"
  trap 'spent' EXIT
  "question_$question" > "$work/lines.part"
  spent
  trap - EXIT
  result_of "$work/lines.part" "$(cat "$work/seconds")" > "$results/$question.json.part"
  mv "$results/$question.json.part" "$results/$question.json"
}

# Adds the time since `began` to the seconds of the question.
spent() {
  local before=0
  if [ -f "$work/seconds" ]; then before=$(cat "$work/seconds"); fi
  printf '%s\n' $((before + SECONDS - began)) > "$work/seconds"
  began=$SECONDS
}

# result_of LINES SECONDS: the JSON of `question`. Lines of the question override earlier lines.
result_of() {
  {
    line meta question "$question"
    line meta commit "$commit"
    line meta machine "$(machine_name)"
    line meta command "$(restrictions)tests/bench/results.sh $question"
    line meta defaults "$defaults"
    cat "$1"
    line meta seconds "$2"
  } | tables collect
}

list_questions() {
  local about
  for question in "${questions[@]}" "${separate[@]}"; do
    about='not measured'
    if [ -f "$results/$question.json" ]; then
      about="$(tables about "$results/$question.json" | cut -f1) s"
    fi
    printf '%-10s %12s   %s\n' "$question" "$about" "$(sed -n "s/^# $question: //p" "$top/tests/bench/results/$question.sh")"
  done
}

# new_texts FOLDER: writes the expected content of all generated files.
new_texts() {
  local page
  tables help "$results/qualities.json" > "$1/quality_table.h"
  for page in BENCHMARKS.md README.md; do
    tables page "$top/$page" "$results" "$defaults" > "$1/$page"
  done
}

# Calls COMMAND with each generated file and its expected content.
for_each_text() {  # FOLDER COMMAND...
  "${@:2}" "$top/tools/ngs-joint/quality_table.h" "$1/quality_table.h"
  "${@:2}" "$top/BENCHMARKS.md" "$1/BENCHMARKS.md"
  "${@:2}" "$top/README.md" "$1/README.md"
}
differs=0
compare_text() { diff "$@" || differs=1; }
replace_text() { cmp -s "$@" || cp "$2" "$1"; }

# Builds TARGETS unless NGS_BIN is set, and finds the tools.
prepare_tools() {
  if [ -z "${NGS_BIN:-}" ]; then "$pipelines/build.sh" --target "$@" >&2; fi
  bin=$(find_bin)
}
known() { case " ${questions[*]} ${separate[*]} " in *" $1 "*) ;; *) fail 2 "no question '$1'" "see $0 --list" ;; esac; }

case ${1:-} in
  -h | --help) usage_of "$0"; exit 0 ;;
  --list)
    list_questions ;;
  --table)
    known "${2:-}"
    prepare_tools tools
    defaults=$(hash_of_defaults)
    tables table "$results/$2.json" "$defaults" ;;
  --write | --check)
    prepare_tools tools
    defaults=$(hash_of_defaults) texts=$(mktemp -d)
    trap 'rm -rf "$texts"' EXIT
    new_texts "$texts"
    if [ "$1" = --check ]; then
      tables check "$results" "$top/BENCHMARKS.md" "$top/README.md" -- "${questions[@]}" -- "${separate[@]}"
      for_each_text "$texts" compare_text
      exit $differs
    fi
    for_each_text "$texts" replace_text ;;
  '' | -*) fail 2 "expected QUESTION..., all, --list, --table, --write or --check" "see $0 --help" ;;
  *)
    if [ "$*" = all ]; then set -- "${questions[@]}"; fi
    for name in "$@"; do known "$name"; done
    commit=$(commit_of_source)
    prepare_tools tools ngs_bench test_stability
    defaults=$(hash_of_defaults) runs=$top/build/results/$commit
    for name in "$@"; do
      measure "$name"
      if [ "$(type -t "check_$name")" = function ]; then "check_$name"; fi
    done ;;
esac
