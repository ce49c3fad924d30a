# alone: object.ply rendered alone against its labels in the scene: all methods on captures, floaters and recipes
# shellcheck shell=bash disable=SC2154
#
# Alpha at one half against the true masks of the held-out views; of recipes without the parts that other things hide.
alone_captures=${CAPTURES:-bird floaters lego skull}

question_alone() {
  title 'B-IoU 0.005 of the object: its labels in the scene, and object.ply rendered alone; every:4:2'
  label method method
  local set
  for set in $alone_captures $recipes; do
    column "$set: in the scene" '' biou_005 mean 4 set="$set"
    column alone '' alone mean 4 set="$set"
    column 'not finished' '' unfinished mean 4 set="$set"
  done
  for set in $alone_captures; do alone_capture "$set"; done
  for set in $recipes; do
    prepare_recipe "$set" --truth halves
    alone_methods "$set" "$work/$set-scene/masks_gt"
  done
}

alone_capture() {
  local folder model=()
  folder=$(capture "${1/floaters/bird}")
  if [ "$1" = floaters ]; then model=(--model "$folder/point_cloud_floaters.ply"); fi
  prepare "$1" "$folder" "${model[@]}" --masks "$folder/masks_sam" --hold-out every:4:2
  alone_methods "$1" "$folder/masks_gt"
}

# alone_methods PREPARED TRUTH
alone_methods() {
  local method
  for method in flash sa3d bce cob ng-gs ngs; do
    wanted "$method" || continue
    # shellcheck disable=SC2046
    scores_alone=1 cut_out "$1-$method" "$1" "$2" $(flags_of "$method")
    row method="$method" set="$1" scores="$work/$1-$method/metrics.json" alone="$(score_of "$1-$method/alone")" \
      unfinished="$(score_of "$1-$method/unfinished")"
  done
}
score_of() { tables score "$work/$1.json" biou_005; }
