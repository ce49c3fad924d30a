#!/usr/bin/env bash
# Checks that two builds write the same bytes for the same inputs: runs the chain on several scenes, with every method.
#
#   tests/ci/same-bytes.sh OLD_BUILD NEW_BUILD [--quick] [--scenes DIR] [-o OUT]
#
#   OLD_BUILD, NEW_BUILD  folders with bin/ of the tools
#   --quick               only a small torus-box with every method, and the draft of bird: less than a minute
#   --scenes DIR          folder of captures (default: ../shared/scenes next to the checkout); bird is compared if it exists
#   -o, --output OUT      output folder (default: build/same-bytes)
#
# OLD_BUILD generates the scenes once: that of the demo, the five recipes of ngs-synth at a small size, and one with two
# objects. Each build then runs its own chain on them.
# JSON files are compared key by key, without times, versions and paths; other files byte by byte. stdout: a table with a
# line per run, then keys that only one build writes (renamed ones are in both lists) and texts that differ; these two are
# no failures. OUT/artifacts.tsv lists every artifact. Outputs of OLD_BUILD are kept for the next call. Exit code 1 if an
# artifact or a number differs or is missing, or if a tool failed.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

scenes=$top/../shared/scenes out=$top/build/same-bytes quick='' builds=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    --quick) quick=1; shift; continue ;;
    --scenes | -o | --output) [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help" ;;&
    --scenes) scenes=$2; shift 2 ;;
    -o | --output) out=$2; shift 2 ;;
    -*) fail 2 "unknown option '$1'" "see $0 --help" ;;
    *) builds+=("$1"); shift ;;
  esac
done
[ ${#builds[@]} -eq 2 ] || fail 2 "expected OLD_BUILD NEW_BUILD" "see $0 --help"
for build in "${builds[@]}"; do
  [ -x "$build/bin/ngs-scene" ] ||
    fail 8 "$build: no bin/ngs-scene" "build the tools into build/ with $pipelines/build.sh"
done
# shellcheck disable=SC2034  # read by name: ${!side}
old=$(cd "${builds[0]}/bin" && pwd) new=$(cd "${builds[1]}/bin" && pwd)
mkdir -p "$out"
out=$(cd "$out" && pwd)

# --- the scenes -------------------------------------------------------------------------------------------------------

small=(--view-count 8 --width-px 128 --height-px 96 --fit-steps 200 --mask-noise jitter:1.5)
demo=(--view-count 16 --width-px 320 --height-px 240 --fit-steps 800 --mask-noise jitter:1.5)
recipes=(torus-box two-spheres leaves bones table)
every_method=(default draft ng-gs flash sa3d cob bce saga released)

make_scene() {  # NAME RECIPE FLAGS...: generated once, by the old build
  local folder=$out/inputs/$1
  if [ -f "$folder/point_cloud.ply" ]; then return; fi
  mkdir -p "$out/inputs"
  "$old/ngs-synth" "$2" -o "$folder" -w -q "${@:3}" --report "$folder.json"
}

# --- the runs of one build --------------------------------------------------------------------------------------------

# joint_words RUN: sets `words` to the options of ngs-joint.
joint_words() {
  case $1 in
    default) words=() ;;
    draft) words=(--quality draft) ;;
    saga) words=(--method saga --saga-steps 100) ;;
    *) words=(--method "$1") ;;
  esac
}

# run TOOL ARGUMENTS...: runs a tool in the folder of the scene; writes its report and exit code for the comparison.
run() {
  local tool=$1 report=$1 code=0
  shift
  if [ "$1" = --report-name ]; then report=$2; shift 2; fi
  mkdir -p reports "$(dirname "reports/$report")"
  "$bin/$tool" "$@" -w --report "reports/$report.json" > /dev/null 2> "reports/$report.log" || code=$?
  printf '%s %s\n' "$report" "$code" >> exit_codes
  [ "$code" -eq 0 ]
}

score() {  # MASKS METRICS REPORT: for binary masks, or masks with one folder per object
  local words=() id
  if [ -n "$label_map" ]; then
    words=(--label-map --layout object/view)
    for id in 1 2; do words+=(--object-id "object-$id=$id"); done
  fi
  run ngs-eval --report-name "$3" "$1" "$truth" "${words[@]}" -o "$2"
}

run_joint() {  # RUN: one method with its outputs
  local words
  joint_words "$1"
  mkdir -p "$1"
  run ngs-joint --report-name "$1/ngs-joint" scene.json boundary.ply --field field.ply "${words[@]}" \
    -o "$1/labelled.ply" || return 0
  run ngs-extract --report-name "$1/ngs-extract" "$1/labelled.ply" --object-ply "$1/object.ply" \
    --background-ply "$1/background.ply" || true
  run ngs-render --report-name "$1/ngs-render" scene.json "$1/labelled.ply" --views held-out --layers mask --scale 0 \
    -o "$1/masks" || return 0
  score "$1/masks" "$1/metrics.json" "$1/ngs-eval" || true
}

# Further outputs of the tools, from the result of the default method.
run_others() {
  local size
  size=$(sed -n 's/.*"width":\([0-9]*\),"height":\([0-9]*\),.*/\1 \2/p;T;q' scene.json)
  mkdir -p others
  awk '{
    printf "{\"ngs_prompts\": 1, \"view\": \"0000.png\", \"width\": %d, \"height\": %d, ", $1, $2
    printf "\"boxes\": [[%d, %d, %d, %d]]}\n", $1 / 4, $2 / 4, $1 * 3 / 4, $2 * 5 / 6
  }' <<< "$size" > others/prompts.json
  run ngs-mask scene.json --prompts others/prompts.json -o others/masks --soft others/soft || true
  run ngs-render scene.json default/labelled.ply --layers color,mask,alpha,depth,labels,overlay -o others/pictures ||
    true
  run ngs-extract --report-name ngs-extract-inpaint default/labelled.ply --scene scene.json --inpaint others/inpaint \
    --supersplat others/supersplat.ply --labelled others/decided.ply || true
  run ngs-fit scene.json --points "$source/sparse/0/points3D.txt" --steps 40 --sh-degree 1 -o others/fit.ply || true
  run ngs-variance --report-name ngs-variance-shard scene.json --shard 1/2 --partial others/shard.evidence || true
}

# run_chain SIDE SCENE SOURCE MASKS TRUTH RUNS...: all runs of one build on one scene, in OUT/SIDE/SCENE. Both builds read the
# same photos and masks; outputs of OLD_BUILD are reused while its tools, inputs and this script do not change.
run_chain() {
  local side=$1 name=$2 bin=${!1} source=$3 masks=$4 truth=$5 label_map='' import=() run_name key
  shift 5
  case $masks in */labels) label_map=1 import=(--mask-mode label) ;; esac
  key=$(printf '%s\n' "$*" && fingerprint "$bin" "$source" "$top/tests/ci/same-bytes.sh")
  if [ "$side" = old ] && [ "$(cat "$out/old/$name.key" 2> /dev/null)" = "$key" ]; then return; fi
  say "== $name: $side build"
  rm -rf "$out/${side:?}/$name" "$out/$side/$name.key"
  mkdir -p "$out/$side/$name"
  cd "$out/$side/$name"
  if run ngs-scene import "$source" --ply "$source/point_cloud.ply" --masks "$masks" --hold-out every:4:2 \
      "${import[@]}" -o scene.json &&
    run ngs-variance scene.json -o boundary.ply && run ngs-sample scene.json boundary.ply -o queries.ply &&
    run ngs-rbf boundary.ply queries.ply -o field.ply; then
    for run_name in "$@"; do
      if [ "$run_name" = others ]; then run_others; else run_joint "$run_name"; fi
    done
  fi
  cd "$out"
  printf '%s\n' "$key" > "$out/$side/$name.key"
}

run_recipe() {  # SIDE RECIPE: generates the scene with this build
  local side=$1 bin=${!1}
  mkdir -p "$out/$side/synth"
  cd "$out/$side/synth"
  rm -rf "$2"
  run ngs-synth --report-name "$2" "$2" -o "$2" "${small[@]:0:6}" --fit-steps 30 --mask-noise jitter:1.5 || true
  cd "$out"
}

# --- both builds ------------------------------------------------------------------------------------------------------

compare() {  # SCENE SOURCE MASKS TRUTH RUNS...: both builds
  run_chain old "$@"
  run_chain new "$@"
  compared+=("$1")
}

compared=(synth)
key=$(fingerprint "$old" && printf '%s\n' "${demo[@]}" "${small[@]}")
if [ "$(cat "$out/inputs.key" 2> /dev/null)" != "$key" ]; then rm -rf "$out/inputs" "$out/inputs.key"; fi

if [ -n "$quick" ]; then recipes=(torus-box); fi
for recipe in "${recipes[@]}"; do
  make_scene "$recipe" "$recipe" "${small[@]}"
  source=$out/inputs/$recipe
  compare "$recipe" "$source" "$source/masks" "$source/masks_gt" "${every_method[@]}" others
  run_recipe old "$recipe"
  run_recipe new "$recipe"
done
source=$out/inputs/torus-box
compare two-objects "$source" "$source/labels" "$source/labels_gt" draft flash bce
if [ -z "$quick" ]; then
  make_scene demo torus-box "${demo[@]}"
  source=$out/inputs/demo
  compare demo "$source" "$source/masks" "$source/masks_gt" "${every_method[@]}" others
fi
printf '%s\n' "$key" > "$out/inputs.key"
bird=$scenes/bird
if [ ! -d "$bird" ]; then
  say "$bird: does not exist, skipped"
elif [ -n "$quick" ]; then
  compare bird "$(cd "$bird" && pwd)" "$bird/masks_sam" "$bird/masks_gt" draft
else
  compare bird "$(cd "$bird" && pwd)" "$bird/masks_sam" "$bird/masks_gt" "${every_method[@]}" others
fi
python3 "$top/tests/ci/same_bytes.py" "$out" "${compared[@]}"
