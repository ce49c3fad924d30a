#!/usr/bin/env bash
# What ngs-joint makes of --time-budget on one scene: a run per budget, scored on the held-out views.
#
#   pipelines/budgets.sh scene.json boundary.ply MASKS_GT OUT [SECONDS...]
#   pipelines/budgets.sh scene.json boundary.ply MASKS_GT OUT 2 8 30 -- --quality high       further options of ngs-joint
#   pipelines/budgets.sh --object-id NAME=ID scene.json boundary.ply LABELS_GT OUT [...]     the truth is label maps
#
# Without SECONDS: 20 budgets from 1 to 60 s. OUT/budgets.json (data-schema/budgets.schema.json) and OUT/budgets.md hold
# budget, wall time, exit code and scores; the exit code is 1 where a run was late by more than 5 % and 0.5 s, or scored
# 0.001 less boundary IoU than a smaller budget did. Where a run fails it is that of ngs-joint, and nothing is written. Nothing
# else may run on the machine.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
object=
if [ "${1:-}" = --object-id ] && [ $# -ge 2 ]; then object=$2; shift 2; fi
[ $# -ge 4 ] || fail 2 "expected scene.json boundary.ply MASKS_GT OUT" "see $0 --help"
bin=$(find_bin)

scene=$1 boundary=$2 truth=$3 out=$4
shift 4
budgets=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do budgets+=("$1"); shift; done
if [ $# -gt 0 ]; then shift; fi
if [ ${#budgets[@]} -eq 0 ]; then budgets=(1 2 3 4 5 6 7 8 10 12 14 16 18 20 25 30 35 40 50 60); fi
mkdir -p "$out"

score() { sed -n '/"mean"/,/}/s/.*"'"$1"'": \([0-9.]*\).*/\1/p' "$out/$2.metrics.json" | head -1; }

# score_labels LABELLED METRICS: the object of the label maps that it renders to, in the held-out views.
score_labels() {
  rm -rf "$2.labels"
  tool ngs-render "$scene" "$1" --views held-out --layers labels --scale 0 -o "$2.labels" -w -q > /dev/null
  tool ngs-eval "$2.labels" "$truth" --label-map --object-id "$object" -o "$2" -w -q > /dev/null
  rm -r "$2.labels"
}

run() {  # BUDGET FLAGS...: a line of JSON
  local budget=$1 began ended rc=0
  began=$(date +%s.%N)
  tool ngs-joint "$scene" "$boundary" -o "$out/$budget.ply" -w -q --report "$out/$budget.json" --time-budget "${budget}s" "${@:2}" || rc=$?
  if [ "$rc" -ne 0 ] && [ "$rc" -ne 7 ]; then exit "$rc"; fi  # it has no result to score
  ended=$(date +%s.%N)
  if [ -n "$object" ]; then
    score_labels "$out/$budget.ply" "$out/$budget.metrics.json"
  else
    score_masks "$scene" "$out/$budget.ply" "$truth" "$out/$budget.metrics.json"
  fi
  rm "$out/$budget.ply"
  awk -v b="$budget" -v t="$began $ended" -v rc="$rc" -v iou="$(score iou "$budget")" -v biou="$(score biou "$budget")" \
    -v fine="$(score biou_005 "$budget")" 'BEGIN { split(t, at, " ");
      printf "{\"budget_s\": %s, \"wall_s\": %.2f, \"exit_code\": %d, \"iou\": %.4f, \"biou\": %.4f, \"biou_005\": %.4f}", b, at[2] - at[1], rc, iou, biou, fine }'
}

lines=()
for budget in "${budgets[@]}"; do
  line=$(run "$budget" "$@")
  lines+=("$line")
  echo "$line" >&2
done
{
  printf '{"ngs_budgets": 1,\n "runs": [\n'
  for i in "${!lines[@]}"; do printf '  %s%s\n' "${lines[i]}" "$([ "$i" -lt $((${#lines[@]} - 1)) ] && echo ,)"; done
  printf ' ]}\n'
} >"$out/budgets.json"

fields() { printf '%s\n' "${lines[@]}" | sed 's/[^0-9. ]*"[a-z_0-9]*": *//g; s/[},]/ /g'; }
{
  echo '| budget s | wall s | exit code | IoU | B-IoU 0.02 | B-IoU 0.005 |'
  echo '|---|---|---|---|---|---|'
  fields | awk '{ printf "| %s | %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $6 }'
} | tee "$out/budgets.md"
fields | awk '
  { late = $2 - $1; if (late > 0.5 && late > 0.05 * $1) { ++bad; print "late by " late " s: " $1 } }
  { if ($5 < best - 0.001) { ++bad; print "worse than a smaller budget: " $1 }; if ($5 > best) best = $5 }
  END { exit bad > 0 }'
