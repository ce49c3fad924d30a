#!/usr/bin/env bash
# The LERF-Mask benchmark (Gaussian Grouping): figurines, ramen, teatime; true masks of a few views per prompt.
#
#   pipelines/lerf-mask.sh LERF_DIR MASKS_DIR OUT_DIR [options of ngs-gs.sh]
#
#   LERF_DIR   SCENE/ with images/, the poses, a trained splat, and test_mask/VIEW/PROMPT.png
#   MASKS_DIR  SCENE/PROMPT/ with the input masks of the other views, named like the images
#   OUT_DIR    SCENE/PROMPT/ per run, report.html and summary.json per scene
#
# VIEW must be the stem of an image, or its number if that is unique. No mask of a test view is read. Their photos are used
# for camera alignment, floaters and edges (--contour-views train: not for edges).
# Score: mean over the views of a prompt, over the prompts of a scene, over scenes; printed at the end.
# Exit code 1 if a prompt failed.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ $# -ge 3 ] || fail 2 "expected LERF_DIR MASKS_DIR OUT_DIR" "see $0 --help"
lerf=$(cd "$1" && pwd) masks=$2 out=$3
shift 3

summaries=() all_failed=0
for scene in figurines ramen teatime; do
  if [ ! -d "$lerf/$scene/test_mask" ]; then
    say "== $scene skipped: $lerf/$scene/test_mask does not exist"
    continue
  fi
  finished_runs=() failed_scenes=0
  while IFS= read -r prompt <&3; do
    if [ ! -d "$masks/$scene/$prompt" ]; then
      say "== $scene, $prompt skipped: $masks/$scene/$prompt does not exist"
      continue
    fi
    # True masks of one prompt, as a folder of views.
    truth=$out/$scene/truth/$prompt
    mkdir -p "$truth"
    for view in "$lerf/$scene/test_mask"/*/; do
      view=$(basename "$view")
      if [ -f "$lerf/$scene/test_mask/$view/$prompt.png" ]; then
        ln -sfn "$lerf/$scene/test_mask/$view/$prompt.png" "$truth/$view.png"
      fi
    done
    find "$lerf/$scene/test_mask" -mindepth 1 -maxdepth 1 -type d -printf '%f\n' | sort > "$out/$scene/held-out.txt"
    run_scene "$scene, $prompt" "$lerf/$scene" "$out/$scene/$prompt" --masks "$masks/$scene/$prompt" \
      --gt "$truth" --hold-out "$out/$scene/held-out.txt" "$@"
  done 3< <(find "$lerf/$scene/test_mask" -name '*.png' -printf '%f\n' | sed 's/\.png$//' | sort -u)
  all_failed=$((all_failed + failed_scenes))
  if [ ${#finished_runs[@]} -gt 0 ]; then
    compare_runs "$out/$scene" "${finished_runs[@]}"
    summaries+=("$out/$scene/summary.json")
  fi
done
[ ${#summaries[@]} -gt 0 ] || fail 5 "no scene finished"
mean_of_summaries "${summaries[@]}"
[ "$all_failed" -eq 0 ]
