#!/usr/bin/env bash
# Times whole tools on a scene: median of RUNS (3) wall and CPU seconds and the peak memory, from the tools' reports.
#   tests/bench/tools.sh SCENE_DIR [THREADS]      build first; SCENE_DIR as for pipelines/ngs-gs.sh
set -euo pipefail
scene=$(realpath "$1"); threads=${2:-2}; runs=${RUNS:-3}
bin=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/build/bin
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT; cd "$work"
masks=$scene/masks; [ -d "$masks" ] || masks=$scene/masks_sam

timed() {  # name, then the command without its reporting options
  local name=$1; shift
  for ((i = 0; i < runs; ++i)); do "$@" -w -q -j "$threads" --report "$work/$i.json" > /dev/null; done
  python3 - "$name" "$work" "$runs" << 'PY'
import json, statistics, sys
name, work, runs = sys.argv[1], sys.argv[2], int(sys.argv[3])
stages = [json.load(open(f"{work}/{i}.json"))["stages"] for i in range(runs)]
median = lambda key: statistics.median(s[key] for s in stages)
print(f"{name:<28} {median('wall_s'):8.2f} s {median('cpu_s'):8.2f} CPU s {median('max_rss_mib'):8.0f} MiB")
PY
}

timed "import" "$bin/ngs-scene" import "$scene" --masks "$masks" --hold-out every:4:2 -o scene.json
timed "variance" "$bin/ngs-variance" scene.json -o boundary.ply
timed "joint flash" "$bin/ngs-joint" scene.json boundary.ply --method flash -o out.ply
timed "joint bce" "$bin/ngs-joint" scene.json boundary.ply --method bce -o out.ply
timed "joint draft" "$bin/ngs-joint" scene.json boundary.ply --quality draft -o labelled.ply
timed "render held-out masks" "$bin/ngs-render" scene.json labelled.ply --views held-out --layers mask -o masks
