# inductive: the methods where the scored views were not there at all: photo, mask and pose taken away
# shellcheck shell=bash disable=SC2154
question_inductive() {
  title "The capture bird, scored in views whose photo, mask and pose were taken away, means over the splits ${splits// /, }"
  label method method
  score_columns
  column 'B-IoU 0.005, split by split' '' biou_005 each 4
  local bird split
  bird=$(capture bird)
  for split in $splits; do
    prepare "$split" "$bird" --masks "$bird/masks_sam" --hold-out "$split"
    without_views "$bird" "$split" "$work/$split-scene"
    prepare "$split-less" "$work/$split-scene" --masks "$work/$split-scene/masks"
    seen_in=$split methods 'flash bce ng-gs ngs' "$split-less" "$bird/masks_gt" run="$split"
  done
}

# without_views SCENE_DIR SPLIT TO: the capture as if the views of SPLIT had never been taken (COLMAP text).
without_views() {
  local kept
  rm -rf "$3"
  mkdir -p "$3/images" "$3/masks" "$3/sparse/0"
  ln -s "$(realpath "$1/point_cloud.ply")" "$3/point_cloud.ply"
  held_out "$1" "$2" > "$3/taken"
  find -L "$1/images" -type f -printf '%f\n' | grep -vxFf "$3/taken" | while read -r kept; do
    ln -s "$(realpath "$1/images/$kept")" "$3/images/"
    ln -s "$(realpath "$1/masks_sam/${kept%.*}.png")" "$3/masks/"
  done
  cp "$1/sparse/0/cameras.txt" "$1/sparse/0/points3D.txt" "$3/sparse/0/"
  # An image is two lines, the first of which ends with its name; the second may be empty.
  awk 'FNR == NR { taken[$1]; next } /^#/ { print; next } !second { drop = $NF in taken } { if (!drop) print; second = !second }' \
    "$3/taken" "$1/sparse/0/images.txt" > "$3/sparse/0/images.txt"
}
