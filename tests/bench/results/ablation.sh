# ablation: each part of NG-GS and of the default switched off alone
# shellcheck shell=bash disable=SC2154
question_ablation() {
  title 'Bird, every:4:2 held out, one part left out at a time; CPU time of ngs-joint'
  label method method
  label without without
  score_columns
  column 'change of B-IoU 0.005' '' biou_005 change 4
  column CPU s cpu_s mean 1
  local bird
  bird=$(capture bird)
  prepare scene "$bird" --masks "$bird/masks_sam" --hold-out every:4:2
  without_each ng-gs boundary rbf hash nerf align smooth mask geometry
  without_each ngs exposure mask-outliers floaters components joint contours contour-iterations
}

# without_each METHOD EFFECT...: rows of the full method and of the method without each effect; METHODS as in `methods`.
without_each() {
  local method=$1 effect
  shift
  wanted "$method" || return 0
  cut_out "$method" scene "$bird/masks_gt" --method "$method"
  row_of "$method" method="$method" without=nothing
  for effect in "$@"; do
    cut_out "$method-$effect" scene "$bird/masks_gt" --method "$method" --effect "$effect=off"
    row_of "$method-$effect" method="$method" without="$effect"
  done
}
