# masks: what wrong masks cost each method
# shellcheck shell=bash disable=SC2154
question_masks() {
  title 'The capture bird from its true masks made wrong, every:4:2 held out; B-IoU 0.005'
  label method method
  local bird damage flags
  bird=$(capture bird)
  for damage in unchanged eroded dilated missing wrong; do column "$damage" '' biou_005 mean 4 masks="$damage"; done
  while read -r damage flags; do
    # shellcheck disable=SC2086
    degraded_masks "$bird/masks_gt" "$work/masks-$damage" $flags --seed 1
    prepare "$damage" "$bird" --masks "$work/masks-$damage" --hold-out every:4:2
    methods 'flash cob bce ng-gs ngs' "$damage" "$bird/masks_gt" masks="$damage" run=seed-1
  done << 'END'
unchanged --missing 0
eroded --mask-noise erode:3,jitter:2
dilated --mask-noise dilate:3,jitter:2
missing --missing 0.2
wrong --wrong 0.1
END
}
