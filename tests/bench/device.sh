#!/usr/bin/env bash
# All checks that need a GPU, in less than 8 minutes: builds, compares the device with the CPU, runs sanitizers on the
# cooperative kernels, and measures. Writes one JSON (data-schema/device.schema.json), also after failures.
#   tests/bench/device.sh OUT.json [SCENE_DIR...]      SCENE_DIR as for pipelines/ngs-gs.sh
#   JOBS=N               compile N files at a time; default: all CPUs
#   NGS_DEVICE_BUILD=DIR run DIR/bin, built before with -DNGS_WITH_CUDA=ON; build nothing
#   NGS_DEVICE_SECONDS=N start no step after N seconds, and end the running one; default 465
#   NGS_CUDA_ARCHITECTURE=90  value of CMAKE_CUDA_ARCHITECTURES; default: native
# Exit code 0: all passed; 1: a step failed or had no time, listed in the JSON; 2: usage; 77: no device, no JSON.
set -euo pipefail
unset CDPATH
[[ $# -ge 1 && $1 != -* ]] || { sed -n '2,4p' "${BASH_SOURCE[0]}" >&2; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
out=$(realpath -m "$1"); shift
scenes=(); for scene in "$@"; do scenes+=("$(realpath -e "$scene")") || exit 2; done
build=${NGS_DEVICE_BUILD:-$root/build-device}; bin=$(realpath -m "$build")/bin
PATH=$PATH:/usr/local/cuda/bin:/usr/local/cuda/compute-sanitizer
last_s=${NGS_DEVICE_SECONDS:-465}
work=$(mktemp -d); mkdir "$work/logs" "$work/scenes"
nvidia-smi -L > "$work/smi" 2> /dev/null && grep -q '^GPU' "$work/smi" || { rm -rf "$work"; echo "skipped: no device"; exit 77; }

finish() {  # also after a signal
  local code=$?
  trap - EXIT
  [ "$code" = 77 ] || python3 "$root/tests/bench/device_report.py" "$work" "$out" || code=1
  rm -rf "$work"
  exit "$code"
}
trap finish EXIT
trap 'exit 143' TERM INT

step() {  # NAME LIMIT_S COMMAND...: records exit code (124: out of time) and time; returns the exit code
  local name=${1//[^A-Za-z0-9._ -]/_} limit=$2 code=0 begin=$SECONDS; shift 2
  [ "$limit" -lt $((last_s - begin)) ] || limit=$((last_s - begin))
  if [ "$limit" -gt 0 ]; then
    timeout -k 5 "$limit" "$@" > "$work/logs/$name" 2>&1 || code=$?
  else
    code=124
  fi
  printf '%s\t%s\t%s\n' "$name" "$code" $((SECONDS - begin)) >> "$work/steps"
  echo "$name: exit $code, $((SECONDS - begin)) s"
  [ "$code" = 0 ] || tail -5 "$work/logs/$name" 2> /dev/null || true
  return "$code"
}
compiled() { ninja -C "$build" -j "${JOBS:-$(nproc)}" "$@"; }
export -f compiled; export build JOBS

if [ -z "${NGS_DEVICE_BUILD:-}" ]; then
  step configure 60 cmake -S "$root" -B "$build" -G Ninja -DNGS_WITH_CUDA=ON -DNGS_CUDA_REPORT=ON \
    -DCMAKE_CUDA_ARCHITECTURES="${NGS_CUDA_ARCHITECTURE:-native}" || exit 1
  step build 300 bash -c 'compiled test_parity ngs_device_bench' || exit 1
  grep -E 'ptxas info|bytes stack frame' "$work/logs/build" > "$work/ptxas" || true
fi

step parity 60 env NGS_PARITY_TABLE=1 "$bin/test_parity" || { [ $? != 77 ] || { echo "skipped: no device for CUDA"; exit 77; }; }
# memcheck: small cases of every kernel. racecheck: all kernels with shared memory, with both kinds of sums.
memory='splat: a*,evidence*,knn*,hash*,film*,volume*,rbf*,align*,photometric*,adam*,joint: losses and parameters*'
races='splat: a*,evidence*,knn*,film*,photometric*,joint: losses and parameters*'
step memcheck 75 compute-sanitizer --tool memcheck --error-exitcode 9 "$bin/test_parity" -tc="$memory" || true
step racecheck 75 compute-sanitizer --tool racecheck --error-exitcode 9 --kernel-name kns=block_kernel "$bin/test_parity" \
  -tc="$races" || true
step bench 90 "$bin/ngs_device_bench" || true

run() {  # LIMIT_S RUN DEVICE TOOL ARGUMENTS...: runs in the scene's folder
  local limit=$1 name=$2 device=$3 tool=$4; shift 4
  step "$(basename "$PWD")-$device-$name" "$limit" "$bin/$tool" "$@" --device "$device" -q --report "$device/$name.json"
}
on_device() {
  local device=$1 model=$1/boundary.ply
  mkdir "$device"
  run 30 variance "$device" ngs-variance scene.json -o "$model" || return 0
  run 30 draft "$device" ngs-joint scene.json "$model" --quality draft -o "$device/draft.ply" || true
  run 60 standard "$device" ngs-joint scene.json "$model" -o "$device/standard.ply" || true
  run 30 fit "$device" ngs-fit scene.json --random-points 20000 --steps 300 -o "$device/fit.ply" || true
  run 20 render "$device" ngs-render scene.json "$model" --views held-out --layers color,mask -o "$device/pictures" || true
  run 40 ng-gs "$device" ngs-joint scene.json "$model" --method ng-gs -o "$device/ng-gs.ply" || true
  [ "$device" = cpu ] ||
    run 40 ng-gs-atomic "$device" ngs-joint scene.json "$model" --method ng-gs --fast-atomics -o "$device/atomic.ply" || true
  step "$(basename "$PWD")-$device-sample" 20 "$bin/ngs-sample" scene.json "$model" -o "$device/queries.ply" -q || return 0
  run 20 rbf "$device" ngs-rbf "$model" "$device/queries.ply" -o "$device/field.ply" || true
}
same_bytes() {  # what has the same order of sums on both
  local file
  for file in boundary.ply draft.ply standard.ply fit.ply pictures; do
    if [ -e "cuda/$file" ] && [ -e "cpu/$file" ]; then
      step "$(basename "$PWD")-same-bytes-$file" 20 diff -rq "cpu/$file" "cuda/$file" || true
    fi
  done
}
if [ ${#scenes[@]} -gt 0 ] && [ -z "${NGS_DEVICE_BUILD:-}" ]; then
  step build-tools 200 bash -c 'compiled ngs-scene ngs-variance ngs-sample ngs-rbf ngs-joint ngs-render ngs-fit' || scenes=()
fi
for n in "${!scenes[@]}"; do
  scene=${scenes[$n]}; masks=$scene/masks; [ -d "$masks" ] || masks=$scene/masks_sam
  mkdir "$work/scenes/$n-$(basename "$scene")"; cd "$work/scenes/$n-$(basename "$scene")"
  step "$(basename "$PWD")-import" 30 "$bin/ngs-scene" import "$scene" --masks "$masks" --hold-out every:4:2 -o scene.json || continue
  for device in cuda cpu; do on_device "$device"; done
  same_bytes
done
