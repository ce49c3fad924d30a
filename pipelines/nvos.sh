#!/usr/bin/env bash
# The NVOS benchmark: 8 tasks over 7 LLFF scenes, one true mask of one target view each.
#
#   pipelines/nvos.sh NVOS_DIR LLFF_DIR MASKS_DIR OUT_DIR [options of ngs-gs.sh]
#
#   NVOS_DIR   the labels: masks/TASK/IMAGE_mask.png
#   LLFF_DIR   SCENE/ with images/, the poses and a trained splat (point_cloud.ply or point_cloud/iteration_*/)
#   MASKS_DIR  TASK/ with the input masks of the views, named like the images; "scribbles": made by ngs-mask
#              from the strokes in NVOS_DIR/scribbles/TASK/ (pos_*.png, neg_*.png) on the view named in reference_image/TASK/
#   OUT_DIR    one folder per task, report.html and summary.json
#
# No mask of the target view is read, and with "scribbles" its photo does not affect masks of other views. Its photo is used for
# camera alignment, floaters and edges (--contour-views train: not for edges). The mean is over tasks, unweighted; "mAcc" of
# the papers is pixel accuracy. The scores depend on which views have an input mask and on how the splat was trained: state
# both.
# Tasks without a scene, masks or truth are reported and skipped. Exit code 1 if a task failed.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ $# -ge 4 ] || fail 2 "expected NVOS_DIR LLFF_DIR MASKS_DIR OUT_DIR" "see $0 --help"
nvos=$1 llff=$2 masks=$3 out=$4
shift 4

targets="fern IMG_4027
flower IMG_2962
fortress IMG_1800
horns_center DJI_20200223_163024_597
horns_left DJI_20200223_163024_597
leaves IMG_2997
orchids IMG_4480
trex DJI_20200223_163619_411"

# from_scribbles TASK SCENE: makes masks of all views from the strokes of a task; prints their folder.
from_scribbles() {
  local to=$out/$1.scribbles view strokes=$nvos/scribbles/$1 bin
  view=$(basename "$(ls "$nvos/reference_image/$1"/* | head -n 1)")
  bin=$(find_bin)
  mkdir -p "$to"
  if [ ! -d "$to/masks" ]; then
    "${bin:+$bin/}ngs-scene" import "$2" --hold-out "$out/$1.target" -o "$to/scene.json" -w -q > /dev/null || return
    "${bin:+$bin/}ngs-mask" "$to/scene.json" --view "${view%.*}" -q -o "$to/masks" --report "$to/ngs-mask.json" \
      --object-scribbles "$(ls "$strokes"/pos_*.png | head -n 1)" --background-scribbles "$(ls "$strokes"/neg_*.png | head -n 1)" || return
  fi
  printf '%s' "$to/masks"
}

mkdir -p "$out"
while read -r task target <&3; do
  scene=$llff/${task%%_*} truth=$nvos/masks/$task
  missing=
  given=$masks/$task
  if [ "$masks" = scribbles ]; then given=$nvos/scribbles/$task; fi
  for path in "$scene" "$truth" "$given"; do
    if [ ! -d "$path" ]; then missing=$path; fi
  done
  if [ -n "$missing" ]; then
    say "== $task skipped: $missing does not exist"
    continue
  fi
  printf '%s\n' "$target" > "$out/$task.target"
  if [ "$masks" = scribbles ] && ! given=$(from_scribbles "$task" "$scene"); then
    failed_scenes=$((failed_scenes + 1))
    continue
  fi
  run_scene "$task" "$scene" "$out/$task" --masks "$given" --gt "$truth" --hold-out "$out/$task.target" "$@"
done 3<<< "$targets"
compare_runs "$out" "${finished_runs[@]}"
[ "$failed_scenes" -eq 0 ]
