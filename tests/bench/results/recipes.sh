# recipes: methods on five synthetic scenes, with masks off by 2 px
# shellcheck shell=bash disable=SC2154
question_recipes() {
  title 'B-IoU 0.005, 16 views of 320x240, masks wrong by 2 px, every:4:2'
  label method method
  local recipe
  for recipe in $recipes; do column "$recipe" '' biou_005 mean 4 recipe="$recipe"; done
  column 'mean' '' biou_005 mean 4
  column 'mean B-IoU 0.02' '' biou mean 4
  column 'mean CPU' s cpu_s mean 2
  for recipe in $recipes; do
    prepare_recipe "$recipe"
    methods 'flash cob bce ng-gs draft ngs' "$recipe" "$work/$recipe-scene/masks_gt" recipe="$recipe" run=seed-0
  done
}
