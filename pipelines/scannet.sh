#!/usr/bin/env bash
# ScanNet scenes: converts exported poses to transforms.json, uses label maps as masks, scores per instance.
#
#   pipelines/scannet.sh SCANS_DIR OUT_DIR --object-id ID,ID,... [--masks DIR] [--scenes "A B"] [options of ngs-gs.sh]
#
#   SCANS_DIR  SCENE/ with color/N.jpg, pose/N.txt (camera -> world, OpenCV axes), intrinsic/intrinsic_color.txt,
#              instance-filt/N.png, and a trained splat point_cloud.ply
#   --masks    SCENE/ with label maps N.png that use the ids of instance-filt (default: instance-filt itself,
#              that is, perfect input masks; only the held-out views are scored)
#   --object-id  the ids of instance-filt to cut out; use one call per scene
#
# The paper states no protocol for ScanNet. Here: every 8th frame is held out, score per instance, mean over the
# instances of a scene, then over scenes. Frames whose pose is not finite are left out.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ $# -ge 2 ] || fail 2 "expected SCANS_DIR OUT_DIR" "see $0 --help"
scans=$(cd "$1" && pwd) out=$2
shift 2
masks='' objects='' scenes='' rest=()
while [ $# -gt 0 ]; do
  case $1 in
    --masks) masks=$2; shift 2 ;;
    --object-id) objects=$2; shift 2 ;;
    --scenes) scenes=$2; shift 2 ;;
    *) rest+=("$1"); shift ;;
  esac
done

# transforms SCENE FILE: in nerfstudio's convention the camera looks along -z with y up, so columns 1 and 2 change sign.
transforms() {
  local scene=$1 pose
  {
    awk 'NR == 1 { fx = $1; cx = $3 } NR == 2 { fy = $2; cy = $3 }
      END { printf "{\"fl_x\": %s, \"fl_y\": %s, \"cx\": %s, \"cy\": %s, \"frames\": [", fx, fy, cx, cy }' \
      "$scene/intrinsic/intrinsic_color.txt"
    local separator=''
    for pose in $(cd "$scene/pose" && printf '%s\n' *.txt | sort -n); do
      if grep -qi -e inf -e nan "$scene/pose/$pose"; then
        say "$scene: frame ${pose%.txt} has no finite pose, left out"
        continue
      fi
      printf '%s\n' "$separator"
      awk -v name="${pose%.txt}" '{ rows = rows (NR > 1 ? ", " : "") sprintf("[%.9g, %.9g, %.9g, %.9g]", $1, -$2, -$3, $4) }
        END { printf "{\"file_path\": \"images/%s.jpg\", \"transform_matrix\": [%s]}", name, rows }' "$scene/pose/$pose"
      separator=','
    done
    printf '\n]}\n'
  } > "$2"
}

[ -n "$objects" ] || fail 2 "no --object-id given, expected ids of instance-filt" "e.g. --object-id 3,7"
SCENE_FLAGS="${SCENE_FLAGS:-} --mask-mode label" EVAL_FLAGS="${EVAL_FLAGS:-} --label-map"
for id in ${objects//,/ }; do
  SCENE_FLAGS+=" --object-id $id=$id" EVAL_FLAGS+=" --object-id $id"
done
export SCENE_FLAGS EVAL_FLAGS

mkdir -p "$out"
out=$(cd "$out" && pwd)
[ -n "$scenes" ] || scenes=$(cd "$scans" && for s in */pose; do printf '%s ' "${s%/pose}"; done)
for name in $scenes; do
  scene=$scans/$name view=$out/$name/scene
  if [ ! -d "$scene/pose" ]; then say "== $name skipped: $scene/pose does not exist"; continue; fi
  # A folder with the layout of a capture.
  mkdir -p "$view"
  ln -sfn "$scene/color" "$view/images"
  for model in point_cloud.ply point_cloud; do
    if [ -e "$scene/$model" ]; then ln -sfn "$scene/$model" "$view/$model"; fi
  done
  if [ -n "$masks" ]; then ln -sfn "$(cd "$masks/$name" && pwd)" "$view/masks"; else ln -sfn "$scene/instance-filt" "$view/masks"; fi
  transforms "$scene" "$view/transforms.json.new"
  # Keep the file if the poses did not change, so that no stage runs again.
  cmp -s "$view/transforms.json.new" "$view/transforms.json" || cp "$view/transforms.json.new" "$view/transforms.json"
  rm "$view/transforms.json.new"
  run_scene "$name" "$view" "$out/$name/run" --gt "$scene/instance-filt" --hold-out every:8:0 "${rest[@]}"
done
compare_runs "$out" "${finished_runs[@]}"
[ "$failed_scenes" -eq 0 ]
