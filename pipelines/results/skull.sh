# skull: the methods on a second capture, a skull on a board with strong shadows
# shellcheck shell=bash disable=SC2154
question_skull() {
  title 'The capture skull, every:4:2 held out; CPU time of ngs-joint'
  label method method
  score_columns
  column CPU s cpu_s mean 2
  local skull
  skull=$(capture skull)
  prepare scene "$skull" --masks "$skull/masks_sam" --hold-out every:4:2
  methods 'flash bce ng-gs ngs' scene "$skull/masks_gt" run=every:4:2
}
