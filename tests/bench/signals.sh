#!/usr/bin/env bash
# How long the tools go on after SIGTERM, in several phases of each:
#   tests/bench/signals.sh SCENE_DIR OUT_DIR [CASE...]
# SCENE_DIR: a capture as pipelines/ngs-gs.sh takes it, with label maps (option SCENE_FLAGS) or masks. CASE: a name of the
# table below; default: all. OUT_DIR keeps the artifacts that the cases start from. The tools come from $NGS_BIN, else from
# the build folder.
# A line each: case, seconds before the signal, the tool's progress then, milliseconds until it has ended, its exit code, its
# memory in MiB, and the unfinished files that it left. Exit code 1 where one took more than a second or left a file.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=pipelines/common.sh
. "$here/../../pipelines/common.sh"
if [ $# -lt 2 ]; then usage_of "$0"; exit 2; fi
scene=$(cd "$1" && pwd)
mkdir -p "$2"
cd "$2"
shift 2
bin=$(find_bin)
model=$(find "$scene" -maxdepth 1 -name 'point_cloud*.ply' | sort | head -n 1)
eval "scene_flags=(${SCENE_FLAGS:-})"
import=(ngs-scene import "$scene" --model "$model" "${scene_flags[@]}")
[ -f scene.json ] || tool "${import[@]}" -o scene.json -q > /dev/null
[ -f boundary.ply ] || tool ngs-variance scene.json -o boundary.ply -q > /dev/null
[ -d masks ] || tool ngs-render scene.json boundary.ply --views all --layers mask --scale 0 -o masks -q > /dev/null

only=$*
# A box in the middle of the first view, for ngs-mask.
sed -n '/"views"/{n;s/.*"name":\("[^"]*"\),"width":\([0-9]*\),"height":\([0-9]*\).*/\1 \2 \3/p;q}' scene.json > view
read -r name width height < view
printf '{"ngs_prompts": 1, "view": %s, "width": %d, "height": %d, "boxes": [[%d, %d, %d, %d]]}\n' "$name" "$width" "$height" \
  $((width / 3)) $((height / 3)) $((width * 2 / 3)) $((height * 2 / 3)) > box.json

# NAME SECONDS,SECONDS... COMMAND...; outputs go to work/
failed=0
measure() {
  local name=$1 at=$2 delay pid start_ms took_ms code memory left said
  shift 2
  if [ -n "${only:-}" ] && [[ " $only " != *" $name "* ]]; then return; fi
  for delay in ${at//,/ }; do
    rm -rf work && mkdir work
    "${bin:+$bin/}$1" "${@:2}" -v --log-format json > work.out 2> work.err &
    pid=$!
    sleep "$delay"
    if ! kill -0 "$pid" 2> /dev/null; then wait "$pid" || true; printf '%-16s %6s  had ended\n' "$name" "$delay"; return; fi
    memory=$(awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$pid/status")
    start_ms=$(date +%s%3N)
    kill -TERM "$pid" 2> /dev/null
    code=0
    wait "$pid" || code=$?
    took_ms=$(($(date +%s%3N) - start_ms))
    left=$(find work -name '.ngs-*.tmp*' | wc -l)
    said=$(tail -n 1 work.err | cut -c 1-60)
    printf '%-16s %6s %6d ms  exit %3d %6d MiB  left %d  %s\n' "$name" "$delay" "$took_ms" "$code" "$memory" "$left" "$said"
    if [ "$took_ms" -gt 1000 ] || [ "$left" -gt 0 ]; then failed=1; fi
  done
}


measure import 1,4,15 "${import[@]}" -o work/scene.json
measure check 2,8 ngs-scene check scene.json
measure variance 0.5,3,8,20 ngs-variance scene.json -o work/b.ply
measure sample 1,3,6 ngs-sample scene.json boundary.ply -o work/q.ply
measure flash 1,3,6 ngs-joint scene.json boundary.ply --method flash -o work/l.ply
measure draft 1,4,10,25 ngs-joint scene.json boundary.ply --quality draft -o work/l.ply
measure standard 2,6,15,40,90 ngs-joint scene.json boundary.ply -o work/l.ply
measure checkpoint 15,40 ngs-joint scene.json boundary.ply --checkpoint work/state --checkpoint-every 1 -o work/l.ply
measure render 1,4,10 ngs-render scene.json boundary.ply --views all --layers color,mask -o work/r
measure mask 1,4,12,30 ngs-mask scene.json --prompts box.json -o work/m
measure eval 0.3,1,2 ngs-eval masks masks -o work/metrics.json
measure fit 2,6,20 ngs-fit scene.json -o work/m.ply --steps 1000
measure fit-checkpoint 15,30 ngs-fit scene.json -o work/m.ply --steps 1000 --checkpoint work/state --checkpoint-every 5
measure extract 0.3,1,2 ngs-extract boundary.ply --object work/o.ply --background work/b.ply --min-component 50
measure extract-sog 1.5,3,6 ngs-extract boundary.ply --object work/o.sog --background work/b.sog
measure clean 1,3 ngs-clean boundary.ply -o work/cleaned
measure orbit 1,4,10 ngs-scene orbit "$model" -o work/scene.json
exit "$failed"
