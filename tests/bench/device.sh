#!/usr/bin/env bash
# Everything that a short loan of a GPU is for: builds for it, compares the device with the CPU, runs the sanitizers over
# the cooperative kernels, measures, and writes one JSON (data-schema/device.schema.json).
#   tests/bench/device.sh OUT.json [SCENE_DIR...]      SCENE_DIR as for pipelines/ngs-gs.sh; JOBS=16
# Exit code 77: no device; 1: a comparison or a sanitizer failed, the JSON says which.
set -euo pipefail
out=$(realpath -m "$1"); shift
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$root/build-device; bin=$build/bin; jobs=${JOBS:-$(nproc)}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
architecture=${NGS_CUDA_ARCHITECTURE:-native}
nvidia-smi -L > "$work/smi" 2> /dev/null || { echo "skipped: no device"; exit 77; }

cmake -S "$root" -B "$build" -G Ninja -DNGS_WITH_CUDA=ON -DNGS_CUDA_REPORT=ON -DCMAKE_CUDA_ARCHITECTURES="$architecture" > "$work/configure.log"
ninja -C "$build" -j "$jobs" test_parity test_emulated ngs_device_bench ngs-scene ngs-variance ngs-sample ngs-rbf ngs-joint ngs-render \
  > "$work/build.log" 2>&1 || { tail -40 "$work/build.log"; exit 1; }

check() {  # name, seconds, then the command: its exit code into a file
  local name=$1 limit=$2; shift 2
  local code=0; timeout "$limit" "$@" > "$work/$name.log" 2>&1 || code=$?
  echo "$code" > "$work/$name.code"
  echo "$name: exit $code"
}
check emulated 120 "$bin/test_emulated"
NGS_PARITY_TABLE=1 check parity 120 "$bin/test_parity"
[ "$(cat "$work/parity.code")" = 77 ] && { cat "$work/parity.log"; exit 77; }
if command -v compute-sanitizer > /dev/null; then
  check memcheck 90 compute-sanitizer --tool memcheck --error-exitcode 9 "$bin/test_parity" -tc="splat: a device*,film*,hash*,volume*,align*,photometric*,joint: losses and parameters*"
  check racecheck 90 compute-sanitizer --tool racecheck --error-exitcode 9 "$bin/test_parity" -tc="splat: a device*,evidence*,film*"
fi
check bench 120 "$bin/ngs_device_bench"

for scene in "$@"; do  # the tools on both devices
  name=$(basename "$scene"); masks=$scene/masks; [ -d "$masks" ] || masks=$scene/masks_sam
  ( cd "$work"; mkdir "$name"; cd "$name"
    "$bin/ngs-scene" import "$scene" --masks "$masks" --hold-out every:4:2 -o scene.json > /dev/null
    for device in cpu cuda; do
      mkdir "$device"
      run() { local tool=$1; shift; "$bin/ngs-$tool" "$@" --device "$device" -q --report "$device/$tool.json"; }
      run variance scene.json -o "$device/boundary.ply"
      "$bin/ngs-sample" scene.json "$device/boundary.ply" -o "$device/queries.ply" -q > /dev/null
      run rbf "$device/boundary.ply" "$device/queries.ply" -o "$device/field.ply"
      timeout 45 "$bin/ngs-joint" scene.json "$device/boundary.ply" --steps 60 --effect view-trust=off --effect floaters=off \
        --effect edges=off -o "$device/labelled.ply" --device "$device" -q --report "$device/joint.json"
      run render scene.json "$device/boundary.ply" --views held-out --layers color,mask -o "$device/pictures"
    done ) || echo "tools on $name: failed"
done

python3 - "$work" "$out" << 'PY'
import json, pathlib, sys
work, out = pathlib.Path(sys.argv[1]), sys.argv[2]
text = lambda p: p.read_text() if p.exists() else ""
checks = [{"name": p.stem, "exit": int(text(p))} for p in sorted(work.glob("*.code"))]
worst = {}
for line in text(work / "parity.log").splitlines():
    if line.startswith("parity\t"):
        _, _, op, ratio, bound = line.split("\t")
        if float(ratio) >= worst.get(op, {"ratio": -1})["ratio"]: worst[op] = {"op": op, "ratio": float(ratio), "bound": float(bound)}
bench = text(work / "bench.log")
tools = []
for report in sorted(work.glob("*/c*/*.json")):
    r = json.loads(text(report))
    tools.append({"scene": report.parts[-3], "device": report.parts[-2], "tool": r["tool"], "wall_s": r["stages"]["wall_s"],
                  "max_rss_mib": r["stages"]["max_rss_mib"]})
result = {"device": text(work / "smi").strip(), "checks": checks, "parity": list(worst.values()),
          "benchmark": json.loads(bench[bench.find("{"):]) if "{" in bench else None, "tools": tools,
          "ptxas": [l for l in text(work / "build.log").splitlines() if "ptxas info" in l or "bytes stack frame" in l]}
pathlib.Path(out).write_text(json.dumps(result, indent=2) + "\n")
sys.exit(any(c["exit"] for c in checks))
PY
