# qualities: gain and cost of each --quality, and of the closed form (flash)
# shellcheck shell=bash disable=SC2154
question_qualities() {
  title "Bird, average of the splits $(splits_text); two threads"
  label quality method
  score_columns
  column wall s wall_s mean 1
  column CPU s cpu_s mean 1
  local bird split
  bird=$(capture bird)
  for split in $splits; do
    prepare "$split" "$bird" --masks "$bird/masks_sam" --hold-out "$split"
    methods 'flash draft standard high reference' "$split" "$bird/masks_gt" run="$split"
  done
}
