#!/usr/bin/env bash
# Demo of the whole chain: installs, builds, makes a synthetic capture (a torus through a box in a textured room, with
# noisy masks), fits a splat, cuts the object out, and scores it in test views.
#
#   pipelines/demo.sh [OUT_DIR] [--no-setup] [options of ngs-gs.sh]        (OUT_DIR: build/demo)
#
# 12 to 26 seconds on two cores once built. A second call reuses the scene of the first, and cuts again.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
out=$top/build/demo setup=1
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then out=$1; shift; fi
if [ "${1:-}" = --no-setup ]; then setup=; shift; fi

if [ -n "$setup" ]; then
  "$pipelines/setup.sh"
  "$pipelines/build.sh" --target tools
fi
bin=$(find_bin)
mkdir -p "$out"
out=$(cd "$out" && pwd)

# masks/ has contours off by 1.5 px, as from a typical segmenter.
if [ ! -f "$out/scene/point_cloud.ply" ]; then
  say "== making the scene"
  "${bin:+$bin/}ngs-synth" torus-box -o "$out/scene" -w --view-count 16 --width-px 320 --height-px 240 --fit-steps 800 \
    --mask-noise jitter:1.5 --report "$out/ngs-synth.json"
fi
say "== cutting out the object"
REPORT_FLAGS="--viewer $(printf %q "$out/torus-box/object.html") ${REPORT_FLAGS:-}" "$pipelines/ngs-gs.sh" "$out/scene" "$out/torus-box" \
  --gt "$out/scene/masks_gt" --hold-out every:4:2 --quality draft "$@"
if [ "$out/torus-box/labelled.ply" -nt "$out/pictures" ]; then
  "${bin:+$bin/}ngs-render" "$out/torus-box/scene.json" "$out/torus-box/labelled.ply" --views held-out --layers overlay,color,mask \
    -o "$out/pictures" -w -q > /dev/null
fi

say "
in $out/torus-box:
  report.html    the report; object.html shows the object in 3D
  object.ply     the object, for SuperSplat or any viewer of splats
  metrics.json   scores; metrics_input.json: scores of the input masks
pictures of the held-out views: $out/pictures"
