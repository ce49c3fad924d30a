# alone: object.ply rendered alone against its labels in the scene: all methods on captures, floaters and recipes
# shellcheck shell=bash disable=SC2154
#
# Alpha at one half against the true masks of the held-out views. With METHODS that contain BEA-GS also flash's labels trained
# by the losses of BEA-GS (tests/bench/occupancy), which take minutes a scene.
alone_captures=${CAPTURES:-bird floaters lego skull}

question_alone() {
  title 'B-IoU 0.005 of the object: its labels in the scene, and object.ply rendered alone; every:4:2'
  label method method
  local set scene
  for set in $alone_captures $recipes; do
    column "$set: in the scene" '' biou_005 mean 4 set="$set"
    column alone '' alone mean 4 set="$set"
    column 'not finished' '' unfinished mean 4 set="$set"
  done
  for set in $alone_captures; do alone_capture "$set"; done
  for set in $recipes; do
    scene=$work/$set-scene
    if [ ! -f "$scene/done" ]; then
      tool ngs-synth "$set" -o "$scene" --view-count 16 --fit-steps 1500 -w -q > /dev/null
      touch "$scene/done"
    fi
    degraded_masks "$scene/masks_gt" "$scene/masks_2px" --mask-noise jitter:2 --seed 1
    prepare "$set" "$scene" --masks "$scene/masks_2px" --hold-out every:4:2
    alone_methods "$set" "$scene/masks_gt"
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
  case " ${METHODS:-} " in *' BEA-GS '*) alone_published "$1" "$2" ;; esac
}
score_of() { tables score "$work/$1.json" biou_005; }

# alone_published PREPARED TRUTH: the row of BEA-GS, with k as published.
alone_published() {
  local run=$work/$1-published scene=$work/$1
  if [ ! -f "$run/alone.json" ]; then
    say "$question: $1, BEA-GS"
    mkdir -p "$run"
    tool ngs-joint "$scene/scene.json" "$scene/boundary.ply" --method flash -o "$run/labelled.ply" -w -q > /dev/null
    tool ngs_occupancy "$scene/scene.json" "$run/labelled.ply" 2000 "$run/object.ply" "$run/background.ply"
    alone_masks "$scene/scene.json" "$run/object.ply" "$2" "$run/alone.json"
  fi
  row method=BEA-GS set="$1" alone="$(score_of "$1-published/alone")"
}
