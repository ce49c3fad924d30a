#!/usr/bin/env bash
# Scores of views without photo, compared with scores of views with photo but without mask:
#
#   tests/bench/removed-views.sh [-o OUT] [--split every:N:K]... [--run NAME=FLAGS]... [--seeds N] SCENE...
#
#   SCENE              folder as for ngs-gs.sh with COLMAP text, masks_sam/ or masks/ and true masks in masks_gt/; or the
#                      name of a recipe of ngs-synth, generated with masks off by 2 px
#   -o OUT             folder of scenes and runs; a second call makes only missing ones              (default: removed-views)
#   --split RULE       the views to hold out or remove                                            (default: every:4:2)
#   --run NAME=FLAGS   a row: flags of ngs-joint, e.g. 'ours=--quality high'       (default: flash, cob, bce, ng-gs, ngs)
#   --seeds N          seeds 0..N-1 of ngs-joint                                                  (default: 1)
#   --only SCORE       transductive, inductive or novel                       (default: transductive and inductive)
#   --novel            also the novel score
#   --fit-steps N      steps of ngs-fit for recipes and for the novel score                       (default: 1500)
#   --fit-flags FLAGS  of ngs-fit for the novel score         (default: --sh-degree 1 --max-gaussians 8000, as ngs-synth)
#
# transductive: the views' masks are held out, their photos and poses are used, as in NVOS.
# inductive: photo, mask and pose are deleted before the import; the result is rendered at the cameras of the whole
# capture. The splat was still fitted to the deleted photos: this favours methods that do not move Gaussians, and
# penalises methods that do.
# novel: inductive, with a splat fitted to the remaining photos only; the cameras of the whole capture are aligned
# with that splat. All are scored on the true masks, at the photos' size.
#
# stdout: a line per run: SCENE SPLIT NAME SEED SCORE IoU B-IoU_0.02 B-IoU_0.005, with tabs; then the means over all splits
# and seeds of a scene, and the gain over flash in B-IoU 0.005 if flash is among the runs.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

out=removed-views splits=() runs=() seeds=1 fit_steps=1500 scores=(transductive inductive) novel='' scenes=()
fit_flags=(--sh-degree 1 --max-gaussians 8000)
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    --novel) novel=novel; shift ;;
    -o | --split | --run | --seeds | --only | --fit-steps | --fit-flags)
      [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help"
      case $1 in
        -o) out=$2 ;;
        --split) splits+=("$2") ;;
        --run) runs+=("$2") ;;
        --seeds) seeds=$2 ;;
        --only) scores=("$2") ;;
        --fit-steps) fit_steps=$2 ;;
        --fit-flags) read -ra fit_flags <<< "$2" ;;
      esac
      shift 2 ;;
    -*) fail 2 "unknown option $1" "see $0 --help" ;;
    *) scenes+=("$1"); shift ;;
  esac
done
[ ${#scenes[@]} -gt 0 ] || fail 2 "expected SCENE..." "see $0 --help"
[[ $seeds =~ ^[1-9][0-9]*$ ]] || fail 2 "--seeds $seeds: expected a number of at least 1"
[[ ${scores[0]} =~ ^(transductive|inductive|novel)$ ]] ||
  fail 2 "--only ${scores[0]}: expected transductive, inductive or novel"
if [ -n "$novel" ] && [ "${scores[0]}" != novel ]; then scores+=(novel); fi
if [ ${#splits[@]} -eq 0 ]; then splits=(every:4:2); fi
if [ ${#runs[@]} -eq 0 ]; then
  for method in flash cob bce ng-gs ngs; do runs+=("$method=--method $method"); done
fi
for rule in "${splits[@]}"; do
  [[ $rule =~ ^every:[1-9][0-9]*:[0-9]+$ ]] || fail 2 "--split $rule: expected every:N:K"
done
for run in "${runs[@]}"; do
  [[ $run =~ ^[A-Za-z0-9_.-]+= ]] || fail 2 "--run '$run': expected NAME=FLAGS" "such as --run 'high=--quality high'"
done

bin=$(find_bin)
mkdir -p "$out" || fail 8 "$out: cannot be created"

# Prints the folder of scene $1: $1 itself, or a recipe generated in OUT.
folder_of() {
  if [ -d "$1" ]; then realpath "$1"; return; fi
  local made=$out/$1/capture
  if [ ! -f "$made/done" ]; then
    say "$1: making the recipe"
    tool ngs-synth "$1" -o "$made" --view-count 16 --fit-steps "$fit_steps" -w -q > /dev/null
    degraded_masks "$made/masks_gt" "$made/masks_sam" --mask-noise jitter:2 --seed 1
    touch "$made/done"
  fi
  realpath "$made"
}

masks_of() { if [ -d "$1/masks_sam" ]; then printf '%s\n' "$1/masks_sam"; else printf '%s\n' "$1/masks"; fi; }

# prepared WORK CAPTURE MASKS SPLIT-OR-EMPTY [MODEL]: writes WORK/scene.json and WORK/boundary.ply.
prepared() {
  if [ ! -f "$1/boundary.ply" ]; then
    evidence_of "$2" "$1" --masks "$3" ${4:+--hold-out "$4"} ${5:+--model "$5"} >&2
  fi
}

# fitted WORK: writes WORK/novel.ply, a splat of the photos in WORK/capture only.
fitted() {
  if [ -f "$1/novel.ply" ]; then return; fi
  say "$1: fitting a splat to the remaining photos"
  tool ngs-fit "$1/inductive/scene.json" --points "$1/capture/sparse/0/points3D.txt" -o "$1/novel.ply" -w -q \
    --steps "$fit_steps" "${fit_flags[@]}" > /dev/null
}

# scored WORK WHOLE TRUTH NAME SEED FLAGS...: runs ngs-joint on WORK and scores masks at the held-out cameras of WHOLE.
scored() {
  local work=$1 whole=$2 truth=$3 run=$1/runs/$4-$5
  if [ "$(cat "$run.done" 2> /dev/null)" = "${*:6}." ]; then return; fi
  mkdir -p "$work/runs"
  say "$run"
  tool ngs-joint "$work/scene.json" "$work/boundary.ply" -o "$run.ply" -w -q --seed "$5" --report "$run.json" "${@:6}"
  score_masks "$whole/scene.json" "$run.ply" "$truth" "$run.metrics.json"
  rm "$run.ply"
  printf '%s.' "${*:6}" > "$run.done"
}

mean_of() { sed -n '/"mean"/,/}/s/.*"'"$2"'": \([0-9.]*\).*/\1/p' "$1" | head -1; }

# score_scene NAME FOLDER SPLIT: prints the lines of one scene and split.
score_scene() {
  local work=$out/$1/$3 masks whole score scene run flags seed metrics
  masks=$(masks_of "$2")
  for score in "${scores[@]}"; do
    scene=$work/$score whole=$work/transductive
    prepared "$whole" "$2" "$masks" "$3"
    if [ "$score" != transductive ] && [ ! -f "$work/inductive/boundary.ply" ]; then
      without_views "$2" "$masks" "$3" "$work/capture"
      prepared "$work/inductive" "$work/capture" "$work/capture/masks" ''
    fi
    if [ "$score" = novel ]; then
      fitted "$work"
      prepared "$scene" "$work/capture" "$work/capture/masks" '' "$work/novel.ply"
      whole=$work/novel-whole
      prepared "$whole" "$2" "$masks" "$3" "$work/novel.ply"
    fi
    for run in "${runs[@]}"; do
      read -ra flags <<< "${run#*=}"
      for ((seed = 0; seed < seeds; ++seed)); do
        scored "$scene" "$whole" "$2/masks_gt" "${run%%=*}" "$seed" "${flags[@]}"
        metrics=$scene/runs/${run%%=*}-$seed.metrics.json
        printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$1" "$3" "${run%%=*}" "$seed" "$score" \
          "$(mean_of "$metrics" iou)" "$(mean_of "$metrics" biou)" "$(mean_of "$metrics" biou_005)"
      done
    done
  done
}

# Means of the lines on stdin over splits and seeds, and gains over flash.
means() {
  awk -F '\t' -v OFS='\t' '
    { key = $1 OFS "mean" OFS $3 OFS "-" OFS $5
      if (!(key in n)) order[++keys] = key
      ++n[key]; iou[key] += $6; wide[key] += $7; narrow[key] += $8 }
    END {
      for (i = 1; i <= keys; ++i) {
        key = order[i]; split(key, part, OFS)
        flash = part[1] OFS "mean" OFS "flash" OFS "-" OFS part[5]
        gain = flash in n ? sprintf("%+.4f", narrow[key] / n[key] - narrow[flash] / n[flash]) : ""
        printf "%s\t%.4f\t%.4f\t%.4f\t%s\n", key, iou[key] / n[key], wide[key] / n[key], narrow[key] / n[key], gain
      }
    }'
}

lines=$(mktemp)
trap 'rm -f "$lines"' EXIT
for scene in "${scenes[@]}"; do
  folder=$(folder_of "$scene")
  [ -d "$folder/masks_gt" ] || fail 3 "$scene: no folder masks_gt" "true masks are needed for the scores"
  for rule in "${splits[@]}"; do score_scene "$(basename "$scene")" "$folder" "$rule" | tee -a "$lines"; done
done
means < "$lines"
