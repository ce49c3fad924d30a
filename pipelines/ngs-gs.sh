#!/usr/bin/env bash
# Cuts the object out of one scene: photos, poses, masks and a trained splat -> object. The chain of tools, one command each:
#
#   pipelines/ngs-gs.sh SCENE_DIR OUT_DIR [options] [options of ngs-joint]
#
#   --model PLY, --masks DIR, --gt DIR    trained splat, input masks and true masks, if `ngs-scene import SCENE_DIR`
#                        does not find them itself
#   --hold-out RULE      every:N:K or a file of names: test views, whose masks are used only for scoring
#   --image-scale S      working size             (default: 1, 1/2, 1/3 ... so that no side exceeds 800 px)
#   --quality Q          draft|standard|high|reference
#   --method M           ngs|ng-gs|bce|cob|flash|sa3d|saga|released
#   --no-finish          do not clip Gaussians of object.ply that reach out of its masks
#   --artifacts all      also write queries.ply and field.ply if no stage reads them (default: needed)
#   -j N, --seed N, --log-format F, --allow-empty, -q, -v     options of every tool
#   --device D           device of tools with a CUDA path; other tools use the CPU
#   -n, --dry-run        print the commands only; to run them by hand, put the tools in PATH
#
# Options for the other tools go in SCENE_FLAGS, VARIANCE_FLAGS, SAMPLE_FLAGS, RBF_FLAGS, EXTRACT_FLAGS, RENDER_FLAGS,
# EVAL_FLAGS and REPORT_FLAGS (JOINT_FLAGS too), quoted as for the shell: SCENE_FLAGS='--mask-mode label --object-id 7' ...
# A call like the last one, on unchanged files, does nothing; experiment.mk runs only the stages that changed. Files that no call
# has written are never replaced. The exit code is that of the failed tool; 1 if a bound of --fail-below in EVAL_FLAGS was not met.
# The tools are searched in $NGS_BIN, then in the build folder, then in PATH.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

words=("$@") scene='' out='' artifacts=needed views=all passes='check run' inputs=() import=() joint=() common=() device=() alone=() extract=() report=
while [ $# -gt 0 ]; do
  case $1 in --*=*) set -- "${1%%=*}" "${1#*=}" "${@:2}" ;; esac
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -n | --dry-run) passes='check print'; shift ;;
    -q | -v | --allow-empty | -j?*) common+=("$1"); shift ;;
    --model | --masks | --gt) need "$@"; inputs+=("$2"); import+=("$1" "$2"); shift 2 ;;
    --hold-out) need "$@"; views=held-out; import+=("$1" "$2"); shift 2 ;;
    --image-scale) need "$@"; import+=("$1" "$2"); shift 2 ;;
    --no-finish) extract+=("$1"); shift ;;
    --artifacts) need "$@"; artifacts=$2; shift 2 ;;
    --device) need "$@"; device=("$1" "$2"); shift 2 ;;
    -j | --threads | --seed | --log-format) need "$@"; common+=("$1" "$2"); shift 2 ;;
    -*) joint+=("$1"); shift ;;
    *) if [ -z "$scene" ]; then scene=$1; elif [ -z "$out" ]; then out=$1; else joint+=("$1"); fi; shift ;;
  esac
done
[ -n "$out" ] || fail 2 "expected SCENE_DIR and OUT_DIR" "see $0 --help"
case $artifacts in all | needed) ;; *) fail 2 "--artifacts $artifacts: expected all or needed" ;; esac
refuse_out "$out" "$scene" "$scene"/{images,masks,masks_sam,masks_gt,gt} "${inputs[@]}"
bin=$(find_bin)
PATH=${bin:+$bin:}$PATH
joint_words=" ${JOINT_FLAGS:-} ${joint[*]}" method=ngs trace=() field=()
if [[ $joint_words =~ .*\ --method[\ =]([a-z0-9-]+) ]]; then method=${BASH_REMATCH[1]}; fi
case $method in ngs | ng-gs) trace=(--trace "$out/trace.jsonl") ;; esac  # baselines have no steps to trace

# step TOOL ARGUMENTS...: runs the tool with the options of all tools, its *_FLAGS and its report.
step() {
  local name=${report:-$1} flags=${1#ngs-} words=()
  flags=${flags^^}_FLAGS
  eval "words=(${!flags:-})"
  case $1:$method in ngs-variance:* | ngs-rbf:* | ngs-render:* | ngs-joint:ngs | ngs-joint:ng-gs) words+=("${device[@]}") ;; esac
  run "$@" "${words[@]}" "${common[@]}" -w --report "$out/reports/$name.json"
}

chain() {
  run mkdir -p "$out/.state" "$out/reports"
  step ngs-scene import "$scene" "${import[@]}" -o "$out/scene.json"
  step ngs-variance "$out/scene.json" -o "$out/boundary.ply"
  if [[ $artifacts = all || $method = ng-gs || $joint_words =~ (nerf|all)=on ]]; then  # otherwise ngs-joint needs no field
    step ngs-sample "$out/scene.json" "$out/boundary.ply" -o "$out/queries.ply"
    step ngs-rbf "$out/boundary.ply" "$out/queries.ply" -o "$out/field.ply"
    field=(--field "$out/field.ply")
  fi
  step ngs-joint "$out/scene.json" "$out/boundary.ply" "${field[@]}" "${trace[@]}" "${joint[@]}" -o "$out/labelled.ply"
  step ngs-extract "$out/labelled.ply" --scene "$out/scene.json" --object-ply "$out/object.ply" --objects "$out/objects" \
    --background-ply "$out/background.ply" --background-filled "$out/background-filled.ply" "${extract[@]}"
  run rm -rf "$out/masks" "$out/.state/masks" "$out/.state/alone"
  step ngs-render "$out/scene.json" "$out/labelled.ply" --views $views --layers mask --scale 0 --format png -o "$out/.state/masks"
  run cp -r "$out/.state/masks" "$out/masks"
  report=ngs-eval-input step ngs-eval "$out/scene.json" "$out/scene.json" --allow-empty -q -o "$out/metrics_input.json"
  failed=0  # the scores of the input masks need not meet a bound
  alone=()  # nothing is scored, or several objects are in one file
  if [ ! -d "$out/objects" ] && { [ $views = held-out ] || grep -qs '^  "truth"' "$out/scene.json"; }; then
    report=ngs-render-alone step ngs-render "$out/scene.json" "$out/object.ply" --views $views --layers alpha --scale 0 \
      --format png -o "$out/.state/alone"
    alone=(--alone "$out/.state/alone")
  fi
  step ngs-eval "$out/masks" "$out/scene.json" "${alone[@]}" --allow-empty -o "$out/metrics.json"
  step ngs-report "$out" -o "$out/report.html"
}

for pass in $passes; do
  if [ "$pass" = run ]; then
    key=$(key_of ngs-joint "$out" "${words[@]}" "$(exported_flags)")
    if is_finished "$out" "$key"; then say "$out: nothing has changed since the last call"; exit 0; fi
    lock_out "$out"
  fi
  chain
done
if [ "$failed" -eq 0 ] && [ "$pass" = run ]; then printf '%s\n' "$key" > "$out/.state/call"; fi
exit "$failed"
