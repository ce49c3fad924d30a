#!/usr/bin/env bash
# Cuts the object out of one scene: photos, poses, masks and a trained splat -> object. The chain of tools, one command each,
# of which a second call repeats only those that something has changed for:
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
#   --until FILE         stop after the step that writes this file of OUT_DIR: scene.json, boundary.ply, metrics.json ...
#   -j N, --seed N, --log-format F, --allow-empty, -q, -v     options of every tool
#   --device D           device of tools with a CUDA path; other tools use the CPU
#   -n, --dry-run        print the commands only; to run them by hand, put the tools in PATH
#
# Options for the other tools go in SCENE_FLAGS, VARIANCE_FLAGS, SAMPLE_FLAGS, RBF_FLAGS, EXTRACT_FLAGS, RENDER_FLAGS,
# EVAL_FLAGS and REPORT_FLAGS (JOINT_FLAGS too), quoted as for the shell: SCENE_FLAGS='--mask-mode label --object-id 7' ...
# A tool runs again if its options, its binary, a file named in its options, a file in SCENE_DIR or a file that it wrote has
# changed (name, size, time); -j, -q, -v and --log-format are no changes. Files that no call has written are never replaced.
# NGS_RUN is put before every call of a tool: NGS_RUN='srun -Q -n1 -c4' makes each a job step of Slurm. The exit code is that of
# the failed tool; 1 if a bound of --fail-below in EVAL_FLAGS was not met; 5 if --until names scores of nothing.
# The tools are searched in $NGS_BIN, then in the build folder, then in PATH.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

scene='' out='' artifacts=needed until='' views=all passes='check run' inputs=() import=() joint=() common=() unkeyed=() device=() extract=()
while [ $# -gt 0 ]; do
  case $1 in --*=*) set -- "${1%%=*}" "${1#*=}" "${@:2}" ;; esac
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -n | --dry-run) passes='check print'; shift ;;
    -q | -v | -j?*) unkeyed+=("$1"); shift ;;
    --allow-empty) common+=("$1"); shift ;;
    --model | --masks | --gt) need "$@"; inputs+=("$2"); import+=("$1" "$2"); shift 2 ;;
    --hold-out) need "$@"; views=held-out; import+=("$1" "$2"); shift 2 ;;
    --image-scale) need "$@"; import+=("$1" "$2"); shift 2 ;;
    --no-finish) extract+=("$1"); shift ;;
    --artifacts) need "$@"; artifacts=$2; shift 2 ;;
    --until) need "$@"; until=$2; shift 2 ;;
    --device) need "$@"; device=("$1" "$2"); shift 2 ;;
    -j | --threads | --log-format) need "$@"; unkeyed+=("$1" "$2"); shift 2 ;;
    --seed) need "$@"; common+=("$1" "$2"); shift 2 ;;
    -*) joint+=("$1"); shift ;;
    *) if [ -z "$scene" ]; then scene=$1; elif [ -z "$out" ]; then out=$1; else joint+=("$1"); fi; shift ;;
  esac
done
[ -n "$out" ] || fail 2 "expected SCENE_DIR and OUT_DIR" "see $0 --help"
case $until in queries.ply | field.ply) artifacts=all ;; esac
case $artifacts in all | needed) ;; *) fail 2 "--artifacts $artifacts: expected all or needed" ;; esac
refuse_out "$out" "$scene" "$scene"/{images,masks,masks_sam,masks_gt,gt} "${inputs[@]}"
bin=$(find_bin)
PATH=${bin:+$bin:}$PATH
joint_words=" ${JOINT_FLAGS:-} ${joint[*]}" method=ngs trace=() field=()
if [[ $joint_words =~ .*\ --method[\ =]([a-z0-9-]+) ]]; then method=${BASH_REMATCH[1]}; fi
case $method in ngs | ng-gs) trace=(--trace "$out/trace.jsonl") ;; esac  # baselines have no steps to trace

# step TOOL ARGUMENTS...: runs the tool with the options of all tools, its *_FLAGS and its report, after removing the files `stale`;
# not at all if nothing has changed since it last ran, or if an earlier step wrote `until`.
report='' stale=() planned=() reached='' changed=''
step() {
  local name=${report:-$1} flags=${1#ngs-} remove=("${stale[@]}") keyed=("$@") further=() words=()
  report='' stale=()
  [ "$pass" = check ] || [ -z "$reached" ] || return 0
  flags=${flags^^}_FLAGS
  eval "words=(${!flags:-})"
  case $1:$method in ngs-variance:* | ngs-rbf:* | ngs-render:* | ngs-joint:ngs | ngs-joint:ng-gs) words+=("${device[@]}") ;; esac
  if [[ $1 = ngs-* ]]; then words+=("${common[@]}") further=("${unkeyed[@]}" -w --report "$out/reports/$name.json"); fi
  keyed+=("${words[@]}")
  planned+=("$name")
  if [ "$pass" = run ] && [ "$1$changed" != ngs-report1 ] && is_unchanged "$out/.state/$name.step" "${keyed[@]}" "${further[@]: -1}"; then
    if [[ $1 = ngs-* ]]; then stage=$((stage + 1)); fi
  else
    if [ ${#remove[@]} -gt 0 ]; then run rm -rf "${remove[@]}"; fi
    run "${keyed[@]}" "${further[@]}"
    changed=1
    if [ "$pass" = run ]; then record "$out/.state/$name.step" "${keyed[@]}" "${further[@]: -1}"; fi
  fi
  if [ -n "$until" ] && [[ " ${*/#/|} " = *"|$out/$until "* ]]; then reached=1; fi
}

chain() {
  local alone=() field=()
  run mkdir -p "$out/.state" "$out/reports"
  step ngs-scene import "$scene" "${import[@]}" -o "$out/scene.json"
  step ngs-variance "$out/scene.json" -o "$out/boundary.ply"
  if [[ $artifacts = all || $method = ng-gs || $joint_words =~ (nerf|all)=on ]]; then  # otherwise ngs-joint needs no field
    step ngs-sample "$out/scene.json" "$out/boundary.ply" -o "$out/queries.ply"
    step ngs-rbf "$out/boundary.ply" "$out/queries.ply" -o "$out/field.ply"
    field=(--field "$out/field.ply")
  fi
  stale=("$out/trace.jsonl")
  step ngs-joint "$out/scene.json" "$out/boundary.ply" "${field[@]}" "${trace[@]}" "${joint[@]}" -o "$out/labelled.ply"
  stale=("$out/objects" "$out/background-filled.ply")
  step ngs-extract "$out/labelled.ply" --scene "$out/scene.json" --object-ply "$out/object.ply" --objects "$out/objects" \
    --background-ply "$out/background.ply" --background-filled "$out/background-filled.ply" "${extract[@]}"
  stale=("$out/.state/masks")
  step ngs-render "$out/scene.json" "$out/labelled.ply" --views $views --layers mask --scale 0 --format png -o "$out/.state/masks"
  stale=("$out/masks")
  step cp -r "$out/.state/masks" "$out/masks"
  report=ngs-eval-input stale=("$out/metrics_input.json")
  step ngs-eval "$out/scene.json" "$out/scene.json" --allow-empty -q -o "$out/metrics_input.json"
  failed=0  # the scores of the input masks need not meet a bound; nothing is scored alone if several objects are in one file
  if [ ! -d "$out/objects" ] && { [ $views = held-out ] || grep -qs '^  "truth"' "$out/scene.json"; }; then
    report=ngs-render-alone stale=("$out/.state/alone")
    step ngs-render "$out/scene.json" "$out/object.ply" --views $views --layers alpha --scale 0 --format png -o "$out/.state/alone"
    alone=(--alone "$out/.state/alone")
  fi
  stale=("$out/metrics.json")
  step ngs-eval "$out/masks" "$out/scene.json" "${alone[@]}" --allow-empty -o "$out/metrics.json"
  step ngs-report "$out" -o "$out/report.html"
}

for pass in $passes; do
  if [ "$pass" = run ]; then lock_out "$out" "${planned[@]}"; fi
  reached='' changed=''
  chain
  if [ -n "$until" ] && [ -z "$reached" ]; then fail 2 "--until $until: no step writes this file" "see the files of $0 -n"; fi
done
if [ "$pass$changed" = run ] && [[ " ${unkeyed[*]} " != *' -q '* ]]; then say "$out: nothing has changed since the last call"; fi
if [ "$pass" = run ] && [ -n "$until" ] && [ ! -e "$out/$until" ]; then
  fail 5 "$out/$until: not written, there is nothing to put in it" "scores need true masks (--gt) or views to hold out (--hold-out)"
fi
exit "$failed"
