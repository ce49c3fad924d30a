# effects: automatic switches against all switches on: scores and time
# shellcheck shell=bash disable=SC2154
question_effects() {
  title "every:4:2 held out; times are medians of $repeats"
  label scene scene
  label effects method
  score_columns
  column 'change of B-IoU 0.005' '' biou_005 change 4
  column wall s wall_s median 1
  column CPU s cpu_s median 1
  column 'wall against auto' '' wall_s ratio 1
  local bird
  bird=$(capture bird)
  prepare bird "$bird" --masks "$bird/masks_sam" --hold-out every:4:2
  auto_and_all bird "$bird/masks_gt"
  prepare_recipe torus-box
  auto_and_all torus-box "$work/torus-box-scene/masks_gt"
}

# auto_and_all PREPARED TRUTH: alternates both settings, so that slow phases of the machine affect both.
auto_and_all() {
  local run which
  for run in $(seq "$repeats"); do
    for which in auto 'everything on'; do
      # shellcheck disable=SC2046
      cut_out "$1-$which-$run" "$1" "$2" $(flags_of "$which")
      row_of "$1-$which-$run" scene="$1" method="$which" run="$run"
    done
  done
}
