# budgets: what --time-budget reaches
# shellcheck shell=bash disable=SC2154
question_budgets() {
  title 'The capture bird under --time-budget, every:4:2 held out; wall time of the whole process'
  label 'budget s' budget
  column wall s wall_s mean 1
  score_columns
  local bird code=0
  bird=$(capture bird)
  if [ ! -f "$work/done" ]; then
    prepare scene "$bird" --masks "$bird/masks_sam" --hold-out every:4:2
    NGS_BIN=$bin "$pipelines/budgets.sh" "$work/scene/scene.json" "$work/scene/boundary.ply" "$bird/masks_gt" "$work" \
      2 4 8 16 >&2 || code=$?
    [ "$code" -le 1 ] || return "$code"  # 1: a run was late, which the table shows
    touch "$work/done"
  fi
  line rows budgets "$work/budgets.json"
}
