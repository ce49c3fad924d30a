# floaters: the methods on a splat of bird that has floaters before the object
# shellcheck shell=bash disable=SC2154
question_floaters() {
  title 'The splat of bird that has floaters, every:4:2 held out; CPU time of ngs-joint'
  label method method
  score_columns
  column CPU s cpu_s mean 2
  local bird
  bird=$(capture bird)
  prepare scene "$bird" --model "$bird/point_cloud_floaters.ply" --masks "$bird/masks_sam" --hold-out every:4:2
  methods 'flash cob bce ng-gs ngs' scene "$bird/masks_gt" run=every:4:2
}
