# captures: all methods on real captures, on removed views, on a splat with floaters
# shellcheck shell=bash disable=SC2154
question_captures() {
  title "Bird: average of $(splits_text), else every:4:2; deleted photos: run without test photos; floaters: another splat; CPU time: bird"
  label method method
  label 'what it is' what
  column IoU '' iou mean 4 set=bird
  column 'B-IoU 0.02' '' biou mean 4 set=bird
  column 'B-IoU 0.005' '' biou_005 mean 4 set=bird
  column 'deleted photos: B-IoU 0.005' '' biou_005 mean 4 set=deleted
  column 'skull: B-IoU 0.005' '' biou_005 mean 4 set=skull
  column 'floaters: B-IoU 0.005' '' biou_005 mean 4 set=floaters
  column CPU s cpu_s mean 2 set=bird
  local split
  for split in $splits; do capture_bird "$split"; done
  prepare skull "$(capture skull)" --masks "$(capture skull)/masks_sam" --hold-out every:4:2
  all_methods skull "$(capture skull)" set=skull run=every:4:2
  capture_floaters
}

# capture_floaters: the splat of bird with floaters in front of the object.
capture_floaters() {
  local bird
  bird=$(capture bird)
  prepare floaters "$bird" --model "$bird/point_cloud_floaters.ply" --masks "$bird/masks_sam" --hold-out every:4:2
  described_methods floaters "$bird/masks_gt" set=floaters run=every:4:2
}

# capture_bird SPLIT: with the photos of the held-out views, and without these views.
capture_bird() {
  local bird
  bird=$(capture bird)
  prepare "$1" "$bird" --masks "$bird/masks_sam" --hold-out "$1"
  all_methods "$1" "$bird" set=bird run="$1"
  without_views "$bird" "$bird/masks_sam" "$1" "$work/$1-less-scene"
  prepare "$1-less" "$work/$1-less-scene" --masks "$work/$1-less-scene/masks"
  seen_in=$1 described_methods "$1-less" "$bird/masks_gt" set=deleted run="$1"
}

# all_methods PREPARED CAPTURE KEY=VALUE...: scores of the input masks and of every method.
all_methods() {
  local scored=$work/$1/input.json rule
  rule=$(printf '%s\n' "${@:3}" | sed -n 's/^run=//p')
  held_out "$2" "$rule" | sed 's/\.[^.]*$/.png/' > "$work/$1/names"
  tool ngs-eval "$2/masks_sam" "$2/masks_gt" --views "$work/$1/names" -o "$scored" -w -q > /dev/null
  row method='(none)' what='the input masks of these views' scores="$scored" "${@:3}"
  described_methods "$1" "$2/masks_gt" "${@:3}"
}

# described_methods PREPARED TRUTH KEY=VALUE...
described_methods() {
  local method
  for method in flash sa3d saga cob bce released ng-gs ngs; do
    methods "$method" "$1" "$2" what="$(what_is "$method")" "${@:3}"
  done
}

what_is() {
  case $1 in
    flash) echo 'FlashSplat, closed form' ;;
    sa3d) echo 'SA3D-GS' ;;
    saga) echo 'SAGA' ;;
    cob) echo 'COB-GS' ;;
    bce) echo 'best labels of unchanged Gaussians' ;;
    released) echo 'steps of the published NG-GS code' ;;
    ng-gs) echo 'NG-GS as in the paper, NeRF on' ;;
    ngs) echo 'the default' ;;
  esac
}
