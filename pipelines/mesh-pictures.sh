#!/usr/bin/env bash
# One picture of objects: a row each, with the splat, its mesh, and the mesh with its colliders as wireframe.
#
#   pipelines/mesh-pictures.sh OUT.jpg OBJECT.ply... [-- options of ngs-mesh]    (default: --collider convex:8)
#
# An object next to a scene.json, as in a folder of ngs cut, is seen from the side of its cameras. Needs chromium. Everything
# else that it makes lies in OUT.jpg.work.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ $# -ge 2 ] || fail 2 "expected OUT.jpg and an object.ply" "$0 --help"
command -v chromium > /dev/null || fail 8 "chromium: not in PATH, and it draws the pictures" "apt-get install chromium"
bin=$(find_bin)
out=$(realpath -m "$1")
shift
work=$out.work rows=0 width=280 height=210
mkdir -p "$work"
page="<body style='margin:0;font-size:0'>"
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  run=$work/$rows
  mkdir -p "$run/reports"
  cp -- "$1" "$run/object.ply"
  if [ -f "$(dirname -- "$1")/scene.json" ]; then cp -- "$(dirname -- "$1")/scene.json" "$run/"; fi
  shift
  objects[rows]=$run
  rows=$((rows + 1))
  for layer in bare bare,mesh bare,collider; do
    page+="<iframe style='border:0' width=$width height=$height src='$rows.html#$layer'></iframe>"
  done
done
[ "${1:-}" != -- ] || shift
[ $# -gt 0 ] || set -- --collider convex:8
for ((k = 0; k < rows; ++k)); do
  tool ngs-mesh "${objects[k]}/object.ply" -o "${objects[k]}/mesh.glb" -w -q "$@" \
    --report "${objects[k]}/reports/ngs-mesh.json" > /dev/null
  tool ngs-report "${objects[k]}" -o "${objects[k]}/report.html" --viewer "$work/$((k + 1)).html" -w -q > /dev/null
done
printf '%s\n' "$page" > "$work/all.html"
chromium --headless --no-sandbox --enable-unsafe-swiftshader --hide-scrollbars --user-data-dir="$work/profile" \
  --virtual-time-budget=20000 \
  --window-size=$((3 * width)),$((rows * height)) --screenshot="$out" "file://$work/all.html" 2> "$work/chromium.log"
say "$out"
