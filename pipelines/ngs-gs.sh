#!/usr/bin/env bash
# Cuts the object out of one scene: photos, poses, masks and a trained splat -> object:
#
#   pipelines/ngs-gs.sh SCENE_DIR OUT_DIR [options] [options of ngs-joint]
#
#   --model PLY          trained splat            (default: SCENE_DIR/point_cloud.ply, point_cloud/iteration_*/)
#   --masks DIR          input masks, by stem     (default: SCENE_DIR/masks, masks_sam)
#   --gt DIR             true masks               (default: SCENE_DIR/masks_gt, gt; else the held-out input masks)
#   --hold-out RULE      every:N:K or a file of names: test views, whose masks are used only for scoring
#   --image-scale S      working size             (default: 1, 1/2, 1/3 ... so that no side exceeds 800 px)
#   --quality Q          draft|standard|high|reference
#   --method M           ngs|ng-gs|bce|cob|flash|sa3d|saga|released
#   --artifacts all      also write queries.ply and field.ply if no stage reads them (default: needed)
#   --until FILE         stop at this artifact of OUT_DIR, e.g. --until boundary.ply
#   -j N, --threads N    threads of every tool; --seed N, --log-format F, --allow-empty, -q, -v likewise
#   --device D           device of tools with a CUDA path; other tools use the CPU
#   -n, --dry-run        print the commands only
#   -h, --help
#
# SCENE_DIR holds images/ and the poses: sparse/0 or colmap/sparse/0 (COLMAP), transforms.json, transforms_train.json,
# cameras.json or poses_bounds.npy; or images/ and scene.json of ngs-scene orbit, for a splat without photos.
# Writes to OUT_DIR: scene.json boundary.ply labelled.ply object.ply background.ply, masks/STEM.png of the held-out views
# (of all views without --hold-out), metrics.json, report.html and each tool's report in reports/; also queries.ply and
# field.ply if a stage needs the field (--method ng-gs, --effect nerf=on) or with --artifacts all. OUT_DIR must not be an
# input folder or contain input models or masks. A second call repeats only what changed. Exit codes are those of the tools;
# 1 if a bound of --fail-below in EVAL_FLAGS was not met.
#
# Options for the other tools go in SCENE_FLAGS, VARIANCE_FLAGS, SAMPLE_FLAGS, RBF_FLAGS, EXTRACT_FLAGS,
# RENDER_FLAGS, EVAL_FLAGS and REPORT_FLAGS, quoted as for the shell: SCENE_FLAGS='--mask-mode label --object-id 7' ...
# (JOINT_FLAGS too; options of ngs-joint given here follow them). Paths in these variables are absolute or relative
# to OUT_DIR; paths in options are relative to the current folder.
#
# Tools are searched in $NGS_BIN, then in the build folder, then in PATH.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

absolute() { case $1 in '' | /*) printf '%s' "$1" ;; *) printf '%s/%s' "$PWD" "$1" ;; esac; }
existing() { [ -e "$2" ] || fail 3 "$1 $2: no such file or folder"; absolute "$2"; }

export ARTIFACTS=needed SCENE='' MODEL='' MASKS='' GT='' HOLD_OUT='' IMAGE_SCALE=0 METHOD='' QUALITY='' DEVICE='' COMMON_FLAGS='' UNKEYED_FLAGS=''
out='' until=report.html dry_run='' joint=()
while [ $# -gt 0 ]; do
  option=$1 value=
  case $option in
    -h | --help) usage_of "$0"; exit 0 ;;
    -n | --dry-run) dry_run=1; shift; continue ;;
    -q | -v) UNKEYED_FLAGS+=" $option"; shift; continue ;;
    --allow-empty) COMMON_FLAGS+=" $option"; shift; continue ;;
    -j?*) UNKEYED_FLAGS+=" $option"; shift; continue ;;
    --model | --masks | --gt | --hold-out | --image-scale | --quality | --method | --until | --artifacts | \
      --seed | --device | --log-format | -j | --threads)
      [ $# -ge 2 ] || fail 2 "$option: no value given" "see $0 --help"
      value=$2
      shift 2 ;;
    --model=* | --masks=* | --gt=* | --hold-out=* | --image-scale=* | --quality=* | --method=* | --until=* | --artifacts=* | \
      --seed=* | --device=* | --log-format=* | --threads=*)
      value=${option#*=} option=${option%%=*}
      shift ;;
    --effects-from=* | --field=* | --options=* | --checkpoint=*)
      joint+=("${option%%=*}=$(absolute "${option#*=}")"); shift; continue ;;
    -*) joint+=("$option"); shift
      # After both folders, a word that follows an option of ngs-joint is its value.
      if [ -n "$out" ] && [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
        case $option in  # the stages run in OUT_DIR
          --effects-from | --field | --options | --checkpoint) joint+=("$(absolute "$1")") ;;
          *) joint+=("$1") ;;
        esac
        shift
      fi
      continue ;;
    *)
      if [ -z "$SCENE" ]; then SCENE=$option
      elif [ -z "$out" ]; then out=$option
      else fail 2 "unexpected argument '$option'" "see $0 --help"; fi
      shift; continue ;;
  esac
  case $option in
    --model) MODEL=$(existing --model "$value") ;;
    --masks) MASKS=$(existing --masks "$value") ;;
    --gt) GT=$(existing --gt "$value") ;;
    --hold-out) if [ -f "$value" ]; then HOLD_OUT=$(absolute "$value"); else HOLD_OUT=$value; fi ;;
    --image-scale) IMAGE_SCALE=$value ;;
    --quality) QUALITY=$value ;;
    --method) METHOD=$value ;;
    --until) until=$value ;;
    --artifacts)
      case $value in all | needed) ARTIFACTS=$value ;; *) fail 2 "--artifacts $value: expected all or needed" ;; esac ;;
    -j | --threads) UNKEYED_FLAGS+=$(printf ' %q' -j "$value") ;;
    --log-format) UNKEYED_FLAGS+=$(printf ' %q' "$option" "$value") ;;
    --device) DEVICE=$value ;;
    --seed) COMMON_FLAGS+=$(printf ' %q' "$option" "$value") ;;
  esac
done
[ -n "$out" ] || fail 2 "expected SCENE_DIR and OUT_DIR" "see $0 --help"
SCENE=$(existing SCENE_DIR "$SCENE")
[[ $IMAGE_SCALE =~ ^[0-9]*\.?[0-9]+$ ]] || fail 2 "--image-scale $IMAGE_SCALE: expected a number, 0 for automatic"
export JOINT_FLAGS="${JOINT_FLAGS:-}"
if [ ${#joint[@]} -gt 0 ]; then JOINT_FLAGS+=$(printf ' %q' "${joint[@]}"); fi
case ${until#./} in
  scene.json | boundary.ply | queries.ply | field.ply | labelled.ply | object.ply | background.ply) ;;
  metrics.json | report.html) ;;
  masks | masks/) until=.state/render.done ;;
  *) fail 2 "--until $until: expected scene.json, boundary.ply, queries.ply, field.ply, labelled.ply, object.ply, background.ply, masks, metrics.json or report.html" ;;
esac

# stages_until FILE [field.ply]: the stages needed for FILE, in order.
stages_until() {
  local to_labels="scene variance ${2:+sample rbf} joint"
  case $1 in
    scene.json) echo scene ;;
    boundary.ply) echo scene variance ;;
    queries.ply) echo scene variance sample ;;
    field.ply) echo scene variance sample rbf ;;
    labelled.ply) echo "$to_labels" ;;
    object.ply | background.ply) echo "$to_labels extract" ;;
    .state/render.done) echo "$to_labels render" ;;
    metrics.json) echo "$to_labels render eval" ;;
    *) echo "$to_labels extract render eval report" ;;
  esac
}

# Prints the result: outputs, scores, number of warnings, next step.
summary() {
  local odd masks scores took="$((SECONDS % 60)) s"
  if [ "$SECONDS" -ge 60 ]; then took="$((SECONDS / 60)) min $took"; fi
  odd=$(awk '/^  "warnings": \[$/ { inside = 1; next } /^  \]/ { inside = 0 } inside { ++n } END { print n + 0 }' reports/*.json)
  say "ngs-gs.sh: done in $took, in $PWD"
  if [ -f object.ply ]; then say "  object.ply, background.ply: plain splats for every viewer"; fi
  if [ -d masks ]; then
    masks=$(find masks -name '*.png' | wc -l)
    say "  masks/: $masks mask(s) of the result"
  fi
  if [ -f metrics.json ]; then
    scores=$(awk -F'[:,]' '/^  "mean": / { inside = 1; next } /^  \}/ { inside = 0 }
      BEGIN { called["iou"] = "IoU"; called["biou"] = "boundary IoU"; called["biou_005"] = "in its 0.5 % band" }
      inside && /"(iou|biou|biou_005)"/ { gsub(/[ "]/, "", $1); text = text sprintf("%s%s %.4f", text == "" ? "" : ", ", called[$1], $2) }
      END { print text }' metrics.json)
    say "  scores: $scores"
  fi
  if [ "$odd" -gt 0 ]; then say "  warnings: $odd, see reports/"; fi
  if [ -f report.html ]; then say "  next: open $PWD/report.html in a browser"; fi
}

command -v make > /dev/null || fail 8 "make: not found" "install it with $pipelines/setup.sh"
mkdir -p -- "$out" || fail 8 "$out: cannot be created"
BIN=$(find_bin)
export BIN NGS_STAGE=$pipelines/stage.sh
# Run in OUT_DIR, where every target is a plain name: make cannot handle spaces in OUT_DIR.
cd -- "$out"
export OUT=.
NGS_STAGES=$(stages_until "${until#./}" "$(bash "$NGS_STAGE" field)")
export NGS_STAGES
bash "$NGS_STAGE" check
bash "$NGS_STAGE" options
if [ -n "$dry_run" ]; then
  printf 'cd %q && mkdir -p .state reports\n' "$PWD"
  for stage in $(stages_until report.html "$(bash "$NGS_STAGE" field)"); do
    NGS_DRY_RUN=1 bash "$NGS_STAGE" "$stage"
  done
  exit 0
fi
# A second concurrent call on the same OUT_DIR waits for the lock, then finds nothing to do. All processes of a run hold the
# lock, so that a new run starts only after those of a killed run ended.
{ mkdir -p .state && : > .state/run.lock; } || fail 8 "$out: cannot be written"
exec 9> .state/run.lock
flock -n 9 || { say "another run is at work in $out, waiting for it"; flock 9; }
for folder in . reports .state; do  # not recursively: nested runs own their temporary files
  if [ -d "$folder" ]; then flock .state/stage.lock find "$folder" -maxdepth 1 -name '.ngs-*.tmp*' -delete; fi
done
rm -f .state/exit_code
unset MAKEFLAGS MFLAGS MAKEOVERRIDES  # from a calling make
# make and its children form a process group. A signal to this script alone, as sent by a scheduler, is forwarded to the
# group, and the script waits for its end: make waits for its stage, the stage for its tool.
stopped=''
start_make() {
  set -m
  NGS_STDERR=7 make --no-print-directory --silent -f "$pipelines/experiment.mk" "./$until" 2> .state/make.log &
  group=$!
  set +m
  trap 'stopped=143; kill -TERM -- "-$group" 2> /dev/null || true' TERM HUP
  trap 'stopped=130; kill -TERM -- "-$group" 2> /dev/null || true' INT
}
wait_for_make() {
  wait "$group" || made=$?
  if [ -n "$stopped" ]; then  # interrupted by the signal
    wait "$group" || true
    exit "$stopped"
  fi
}
made=0
exec 7>&2  # stderr of the tools; errors of make itself are shown only if no tool printed an error
start_make
wait_for_make
if [ "$made" -ne 0 ] && [ ! -s .state/exit_code ]; then cat .state/make.log >&2; fi
if [ "$made" -gt 128 ]; then exit "$made"; fi
if [ "$made" -ne 0 ]; then
  code=$(cat .state/exit_code 2> /dev/null || true)
  if [ -n "$code" ]; then exit "$code"; fi
  printf 0 2> /dev/null > .state/writable || fail 8 "$out: cannot be written"
  exit 70
fi
case " $UNKEYED_FLAGS " in *" -q "*) ;; *) if [ -t 2 ]; then summary; fi ;; esac
if [ -f .state/check_failed ]; then exit 1; fi
