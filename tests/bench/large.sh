#!/usr/bin/env bash
# The chain on large scenes: import, evidence, draft; wall and CPU seconds and peak memory of each tool.
#
#   tests/bench/large.sh six CAPTURE [OUT]    three rooms of CAPTURE: 6.2e6 Gaussians of museum, 300 photos of 2.1 Mpx
#   tests/bench/large.sh ten CAPTURE [OUT]    five rooms: 1.03e7 Gaussians of museum, 1000 photos of 0.3 Mpx
#   tests/bench/large.sh unseen CAPTURE [OUT] CAPTURE alone, with two copies of its model behind its walls, and with nine
#                                           outside all views: cost of occluded and off-screen Gaussians
#   tests/bench/large.sh balls [OUT]          100 objects at once: 1e6 Gaussians, 60 photos of 0.3 Mpx
#
#   CAPTURE   a folder with sparse/, images/, masks_label/ and point_cloud.compressed.ply, such as the scene museum
#   OUT       output folder     (default: large/WHAT)
#
# Rooms are copies of the capture's model side by side, with enlarged copies of its photos. A camera sees another room only
# through its own room. A room reuses cameras to get more views than the capture. The chain cuts out object 2 of the first
# room, which the photos of other rooms do not show. Needs ngs_large, a target of the build.
#
# stdout: a line per tool: TOOL WALL_S CPU_S PEAK_MIB EXIT_CODE; for `unseen`, after a line with number and place of the
# copies. NGS_THREADS applies.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in
  six | ten | unseen)
    [ $# -ge 2 ] || fail 2 "expected a CAPTURE" "see $0 --help"
    what=$1 capture=$2 out=${3:-large/$1} ;;
  balls) what=$1 capture='' out=${2:-large/$1} ;;
  -h | --help) usage_of "$0"; exit 0 ;;
  *) fail 2 "expected six, ten, unseen or balls" "see $0 --help" ;;
esac
bin=$(find_bin)
scene=$out/scene

make_scene() {
  local model=$capture/point_cloud.compressed.ply
  rm -rf "$scene.part"
  case $what in
    six) tool ngs_large rooms "$scene.part" "$capture" "$model" 3 300 1792x1161 ;;
    ten) tool ngs_large rooms "$scene.part" "$capture" "$model" 5 1000 680x441 ;;
    balls) tool ngs_large balls "$scene.part" 100 1e6 60 ;;
  esac
  mv "$scene.part" "$scene"
}

# Runs a tool and prints its line; exits with its code on failure.
timed() {
  local code=0
  /usr/bin/time -f '%e %U %S %M' -o "$out/$1.time" "${bin:+$bin/}$1" "${@:2}" -w -q --report "$out/$1.json" > /dev/null || code=$?
  tail -n 1 "$out/$1.time" |
    awk -v tool="$1" -v code="$code" '{ printf "%-14s %8.1f %8.1f %7d %d\n", tool, $1, $2 + $3, $4 / 1024, code }'
  if [ "$code" -ne 0 ]; then exit "$code"; fi
}

# The chain up to a draft, for photos and masks of CAPTURE, with MODEL and further options of import.
#   chain CAPTURE MODEL [OPTION...]
chain() {
  timed ngs-scene import "$1" --model "$2" --masks "$1/masks_label" --mask-mode label "${@:3}" -o "$out/scene.json"
  timed ngs-variance "$out/scene.json" -o "$out/boundary.ply"
  timed ngs-joint "$out/scene.json" "$out/boundary.ply" --quality draft -o "$out/labelled.ply"
}

mkdir -p "$out" || fail 8 "$out: cannot be created"
case $what in
  unseen)
    top=$out
    for model in '1 outside' '3 hidden' '10 outside'; do
      out=$top/${model/ /-}
      echo "$model"
      mkdir -p "$out"
      # shellcheck disable=SC2086  # two words
      [ -f "$out/model.ply" ] || tool ngs_large copies "$out/model.ply" "$capture" "$capture/point_cloud.compressed.ply" $model
      chain "$capture" "$out/model.ply" --hold-out every:4:2 --object-id angel=2
    done ;;
  *)
    [ -d "$scene" ] || make_scene
    objects=()
    [ "$what" = balls ] || objects=(--object-id angel=2)
    chain "$scene" "$scene/point_cloud.ply" --hold-out every:10:5 "${objects[@]}" ;;
esac
