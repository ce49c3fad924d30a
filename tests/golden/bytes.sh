#!/bin/sh
# Runs the chain on a tiny scene and compares its results with the SHA-256 sums of golden.sha256. A plain POSIX script, so
# that it also runs on bare systems, for builds other than this one (tests/ci/bundle.sh).
#
#   tests/golden/bytes.sh BIN_DIR OUT_DIR            prints the files that differ; exit code 1 if there are any
#   tests/golden/bytes.sh BIN_DIR OUT_DIR --write    after a change that is meant to change results: writes the sums
set -eu
golden=$(cd "$(dirname "$0")" && pwd)/golden.sha256
bin=$(cd "$1" && pwd)
rm -rf "$2"
mkdir -p "$2"
cd "$2"

run() { tool=$1; shift; "$bin/$tool" "$@" -q > /dev/null; }
run ngs-synth two-spheres -o scene --view-count 8 --width-px 96 --height-px 72 --fit-steps 120 --fit-max-gaussians 1500 \
  --mask-noise jitter:1
run ngs cut scene --hold-out every:4:2 --quality draft --keep -o draft
run ngs-joint draft/scene.json draft/boundary.ply --method flash -o flash.ply
run ngs-extract draft/labelled.ply --object-ply object.spz
run ngs-extract draft/labelled.ply --object-ply object.sog
run ngs-fit draft/scene.json --points scene/sparse/0/points3D.txt --steps 40 -o fit.ply

files="scene/point_cloud.ply scene/images/0000.png scene/masks/0000.png scene/layers/0000.exr fit.ply draft/boundary.ply
  flash.ply draft/labelled.ply draft/object.ply draft/background.ply draft/masks/0002.png draft/masks/0006.png object.spz
  object.sog"
# shellcheck disable=SC2086  # a list of words
if [ "${3:-}" = --write ]; then sha256sum $files > "$golden"; else sha256sum --check --quiet "$golden"; fi
