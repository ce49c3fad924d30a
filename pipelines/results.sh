#!/usr/bin/env bash
# Measured results: a question each, with a JSON file each, and the tables that are made of them.
#
#   pipelines/results.sh QUESTION...        measures; tests/bench/results/QUESTION.json; `all` is every question
#   pipelines/results.sh --list             the questions, what they ask, and how long each took
#   pipelines/results.sh --table QUESTION   prints its table
#   pipelines/results.sh --write            fills the tables of BENCHMARKS.md and README.md, and that of ngs-joint --help
#   pipelines/results.sh --check            says what --write would change; exit code 1 where it would change anything
#
# Two threads, one run at a time; nothing else may run on the machine where a table has times. A call that was broken off
# goes on where it was, as long as the commit is the same: the runs are in build/results/COMMIT/QUESTION/ (delete a folder
# there to measure it anew).
#
#   NGS_SCENES     folder of the captures            (default: ../shared/scenes beside the checkout)
#   NGS_BIN        tools of another build, which is not built anew; NGS_COMMIT then names its commit
#   NGS_MACHINE    how the tables call the machine   (default: by the processor)
#   SPLITS='every:4:2' RECIPES='table' REPEATS=1     a part of a question; its table says so
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"
# shellcheck source=pipelines/results/helpers.sh
. "$pipelines/results/helpers.sh"

top=$(cd "$pipelines/.." && pwd)
results=$top/tests/bench/results
help_header=$top/tools/ngs-joint/quality_table.h
questions=(captures inductive skull floaters masks recipes qualities effects ablation budgets times kernels stability goals)
for question in "${questions[@]}"; do
  # shellcheck disable=SC1090
  . "$pipelines/results/$question.sh"
done

# The last commit that changed what is measured: not the documents, nor what --write itself writes.
commit_of_source() {
  local measured=(libngs tools ':!*.md' ":!tools/ngs-joint/quality_table.h")
  if [ -n "${NGS_COMMIT:-}" ]; then printf '%s\n' "$NGS_COMMIT"; return; fi
  [ -z "${NGS_BIN:-}" ] || fail 2 "NGS_BIN is set, but not NGS_COMMIT" "name the commit that these tools were built from"
  git -C "$top" diff --quiet HEAD -- "${measured[@]}" || fail 4 "libngs or tools differ from the last commit" "commit first: a table names one"
  git -C "$top" log -1 --format=%h --abbrev=7 -- "${measured[@]}"
}

# Measures question $1 and writes its file. The times of broken-off calls add up.
measure() {
  question=$1 work=$runs/$1 began=$SECONDS
  mkdir -p "$work" "$results"
  say "== $question"
  trap 'spent' EXIT
  "question_$question" > "$work/lines.part"
  spent
  trap - EXIT
  {
    heading
    cat "$work/lines.part"
    line meta seconds "$(seconds_of_work)"
  } | tool ngs_results collect > "$results/$question.json.part"
  mv "$results/$question.json.part" "$results/$question.json"
}

# Adds the time since `began`.
spent() {
  local before=0
  if [ -f "$work/seconds" ]; then before=$(cat "$work/seconds"); fi
  printf '%s\n' $((before + SECONDS - began)) > "$work/seconds"
  began=$SECONDS
}

# A question that runs nothing has no time of its own.
seconds_of_work() { case $question in goals) echo 0 ;; *) cat "$work/seconds" ;; esac; }

# What goes before the lines of the question, which may say otherwise.
heading() {
  line meta question "$question"
  line meta commit "$commit"
  line meta machine "$(machine_name)"
  line meta command "$(restrictions)pipelines/results.sh $question"
  line meta defaults "$(hash_of_defaults)"
}

list_questions() {
  local about
  for question in "${questions[@]}"; do
    about='not measured'
    if [ -f "$results/$question.json" ]; then about="$(tool ngs_results about "$results/$question.json" | cut -f1) s"; fi
    printf '%-10s %12s   %s\n' "$question" "$about" "$(sed -n "s/^# $question: //p" "$pipelines/results/$question.sh")"
  done
}

# new_texts FOLDER: what the generated files should be.
new_texts() {
  local page defaults
  defaults=$(hash_of_defaults)
  for page in BENCHMARKS.md README.md; do
    tool ngs_results page "$top/$page" "$results" "$defaults" > "$1/$page"
  done
  if [ -f "$results/qualities.json" ]; then tool ngs_results help "$results/qualities.json" > "$1/quality_table.h"; fi
}

compare_texts() {  # FOLDER
  local differs=0
  for page in BENCHMARKS.md README.md; do diff "$top/$page" "$1/$page" || differs=1; done
  diff "$help_header" "$1/quality_table.h" || differs=1
  return $differs
}

replace_texts() {  # FOLDER
  local page
  for page in BENCHMARKS.md README.md; do cmp -s "$1/$page" "$top/$page" || cp "$1/$page" "$top/$page"; done
  cmp -s "$1/quality_table.h" "$help_header" || cp "$1/quality_table.h" "$help_header"
}

ready() { bin=$(find_bin); }
build_if_ours() { [ -n "${NGS_BIN:-}" ] || "$pipelines/build.sh" --target "$@" >&2; ready; }
known() { case " ${questions[*]} " in *" $1 "*) ;; *) fail 2 "no question '$1'" "see $0 --list" ;; esac; }

case ${1:-} in
  -h | --help) usage_of "$0"; exit 0 ;;
  --list) build_if_ours ngs_results; list_questions ;;
  --table)
    known "${2:-}"
    build_if_ours ngs_results tools
    tool ngs_results table "$results/$2.json" "$(hash_of_defaults)" ;;
  --write | --check)
    build_if_ours ngs_results tools
    texts=$(mktemp -d)
    trap 'rm -rf "$texts"' EXIT
    new_texts "$texts"
    if [ "$1" = --write ]; then replace_texts "$texts"; else compare_texts "$texts"; fi ;;
  '' | -*) fail 2 "expected QUESTION..., all, --list, --table, --write or --check" "see $0 --help" ;;
  *)
    if [ "$*" = all ]; then set -- "${questions[@]}"; fi
    for asked in "$@"; do known "$asked"; done
    commit=$(commit_of_source)
    build_if_ours tools ngs_results ngs_bench test_stability
    runs=$top/build/results/$commit
    for asked in "$@"; do measure "$asked"; done ;;
esac
