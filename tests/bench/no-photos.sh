#!/usr/bin/env bash
# ngs cut of splats without photos, with generated strokes on two renders, scored against ground truth that the cut does not use:
#
#   tests/bench/no-photos.sh [-o OUT] [--quality Q] [--up AXIS] photos CAPTURE
#   tests/bench/no-photos.sh [-o OUT] [--quality Q] [--up AXIS] statue MODEL IDS ID PLANE SCENE_JSON
#
#   photos CAPTURE  cuts point_cloud.ply; scores with images/, poses and masks_gt/ at the held-out views every:4:2. Strokes
#                   come from labels by masks_gt/ of the other views
#   statue MODEL IDS ID PLANE SCENE_JSON
#                   cuts an object, isolated from its splat, off its base. Ground truth: Gaussians above PLANE (A,B,C,D);
#                   IDS as for around.sh; scored with the held-out cameras of SCENE_JSON
#   -o OUT          output folder                                                                (default: no-photos)
#   --quality Q     of ngs cut                                                                     (default: standard)
#   --up AXIS       of ngs cut, for tilted pictures                                                    (default: auto)
#
# Marks two cameras of ngs-scene orbit, 90 degrees apart: a line along the object and a line around it
# (tests/bench/strokes/stroke_rule.h). Needs ngs_strokes, a target of the build. stdout: IoU, B-IoU 0.02 and B-IoU 0.005 of
# the photos' views; for a statue the output of ngs_strokes.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

out=no-photos quality=standard up=auto
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --quality | --up)
      [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help"
      case $1 in -o) out=$2 ;; --quality) quality=$2 ;; --up) up=$2 ;; esac
      shift 2 ;;
    -*) fail 2 "unknown option $1" "see $0 --help" ;;
    *) break ;;
  esac
done
what=${1:-}
[ "$what $#" = "photos 2" ] || [ "$what $#" = "statue 6" ] || fail 2 "expected photos or statue" "see $0 --help"
bin=$(find_bin)
mkdir -p "$out" || fail 8 "$out: cannot be created"

# cut MODEL IDS: cuts id 1 into $out/cut.
cut() {
  local words=(cut "$1" --quality "$quality" "--up=$up" -o "$out/cut" -w -q)
  [ -f "$out/cut/orbit/scene.json" ] || tool ngs "${words[@]}" > /dev/null
  tool ngs_strokes strokes "$1" "$2" 1 "$out/cut/orbit/scene.json" > "$out/strokes.json"
  tool ngs "${words[@]}" --strokes "$out/strokes.json" --report "$out/report.json" > /dev/null
}

# Photos of the capture are used only here: for strokes and score.
photos() {
  local model=$1/point_cloud.ply
  tool ngs-scene import "$1" --ply "$model" --images "$1/images" --masks "$1/masks_gt" --hold-out every:4:2 \
    -o "$out/photos.json" -w -q > /dev/null
  tool ngs-variance "$out/photos.json" -o "$out/boundary.ply" -w -q > /dev/null
  tool ngs-joint "$out/photos.json" "$out/boundary.ply" --method flash -o "$out/truth.ply" -w -q > /dev/null
  tool ngs_strokes ids "$out/truth.ply" "$out/ids.u8"
  cut "$model" "$out/ids.u8"
  score_masks "$out/photos.json" "$out/cut/labelled.ply" "$1/masks_gt" "$out/metrics.json"
  tr -d ' \n' < "$out/metrics.json" | grep -oE '"mean":\{[^}]*' |
    sed -E 's/.*"iou":([0-9.]*),.*"biou":([0-9.]*),"biou_005":([0-9.]*).*/\1 \2 \3/'
}

statue() {
  tool ngs_strokes alone "$1" "$2" "$3" "$out/alone.ply"
  tool ngs_strokes above "$out/alone.ply" "$4" "$out/above.u8"
  cut "$out/alone.ply" "$out/above.u8"
  tool ngs_strokes score "$out/alone.ply" "$out/above.u8" 1 "$5" "$out/cut/labelled.ply"
}

"$@"
