# masks: loss of each method with degraded masks
# shellcheck shell=bash disable=SC2154
question_masks() {
  title 'B-IoU 0.005 on bird, every:4:2, true masks made wrong'
  label method method
  local bird damage masks
  bird=$(capture bird)
  for damage in unchanged eroded dilated missing swapped; do column "$damage" '' biou_005 mean 4 masks="$damage"; done
  for damage in unchanged eroded dilated missing swapped; do
    masks=$work/masks-$damage
    # shellcheck disable=SC2046
    degraded_masks "$bird/masks_gt" "$masks" $(flags_of_damage "$damage") --seed 1
    prepare "$damage" "$bird" --masks "$masks" --hold-out every:4:2
    methods 'flash cob bce ng-gs ngs' "$damage" "$bird/masks_gt" masks="$damage" run=seed-1
  done
}

# Options of ngs-scene degrade.
flags_of_damage() {
  case $1 in
    unchanged) echo '--missing 0' ;;
    eroded) echo '--mask-noise erode:3,jitter:2' ;;
    dilated) echo '--mask-noise dilate:3,jitter:2' ;;
    missing) echo '--missing 0.2' ;;
    swapped) echo '--wrong 0.1' ;;
  esac
}
