#!/usr/bin/env bash
# ngs cut --around --method flash on objects of a splat with known ground truth, with generated strokes:
#
#   tests/bench/around.sh [-o OUT] [--scene SCENE_JSON] MODEL IDS ID...
#
#   MODEL                a splat
#   IDS                  a file with one byte per Gaussian: the id of its object
#   ID                   an object to cut out
#   -o OUT               output folder                                                            (default: around)
#   --scene SCENE_JSON   cameras for scoring, held-out ones if there are any                      (default: those of the cut)
#
# Marks two cameras of ngs-scene orbit, 90 degrees apart: a line along the object and a line around it
# (tests/bench/strokes/stroke_rule.h). Needs ngs_strokes, a target of the build.
#
# stdout: a line per object: ID WALL_S CPU_S SCORES. Times are those of the cut, including reading and writing. Scores compare
# masks rendered from the labels with masks rendered from the ids.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

out=around scene=""
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --scene)
      [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help"
      if [ "$1" = -o ]; then out=$2; else scene=$2; fi
      shift 2 ;;
    -*) fail 2 "unknown option $1" "see $0 --help" ;;
    *) break ;;
  esac
done
[ $# -ge 3 ] || fail 2 "expected MODEL IDS ID..." "see $0 --help"
model=$1 ids=$2
shift 2
bin=$(find_bin)
mkdir -p "$out" || fail 8 "$out: cannot be created"

for id in "$@"; do
  folder=$out/object-$id
  ball=$(tool ngs_strokes ball "$model" "$ids" "$id")
  cut=(cut "$model" "--around=$ball" --method flash -o "$folder" -w -q)
  [ -f "$folder/orbit/scene.json" ] || tool ngs "${cut[@]}" > /dev/null
  tool ngs_strokes strokes "$model" "$ids" "$id" "$folder/orbit/scene.json" > "$out/strokes-$id.json"
  tool ngs "${cut[@]}" --strokes "$out/strokes-$id.json" --report "$out/report-$id.json" > /dev/null
  times=$(grep -m 2 -oE '"(wall|cpu)_s": [0-9.]+' "$out/report-$id.json" | grep -oE '[0-9]+[.]?[0-9]*' | paste -sd ' ')
  scores=$(tool ngs_strokes score "$model" "$ids" "$id" "${scene:-$folder/orbit/scene.json}" "$folder/labelled.ply")
  printf '%s %s %s\n' "$id" "$times" "$scores"
done
