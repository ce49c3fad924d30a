# captures: what every method makes of the capture bird
# shellcheck shell=bash disable=SC2154
question_captures() {
  title "The capture bird, means over the splits ${splits// /, }; CPU time of ngs-joint"
  label method method
  score_columns
  column 'B-IoU 0.005, split by split' '' biou_005 each 4
  column CPU s cpu_s mean 2
  local bird split names
  bird=$(capture bird)
  for split in $splits; do
    prepare "$split" "$bird" --masks "$bird/masks_sam" --hold-out "$split"
    names=$work/$split/names
    held_out "$bird" "$split" | sed 's/\.[^.]*$/.png/' > "$names"
    tool ngs-eval "$bird/masks_sam" "$bird/masks_gt" --views "$names" -o "$work/$split/input.json" -w -q > /dev/null
    row method='the input masks' run="$split" scores="$work/$split/input.json"
    methods 'flash sa3d saga cob bce released ng-gs ngs' "$split" "$bird/masks_gt" run="$split"
  done
}
