#!/usr/bin/env bash
# One stage of experiment.mk: `stage.sh STAGE` runs its tool. `stage.sh key STAGE` writes the dependencies of the stage,
# besides earlier artifacts, to OUT/.state/STAGE.key if they changed. With NGS_DRY_RUN, only prints commands.
# `stage.sh check` fails if a stage would replace foreign files in OUT; every other call checks this first, too.
# `stage.sh options` fails if a tool would reject its options; `stage.sh scored` fails without scores;
# `stage.sh field` prints field.ply if a stage reads it or ARTIFACTS is all.
# NGS_STAGES names the stages of the whole run; tools then print their position (NGS_STAGE_OF).
# All values are passed in the environment, so that paths may contain any character. Not called by hand.
set -euo pipefail
if [ -n "${NGS_STDERR:-}" ]; then exec 2>&"$NGS_STDERR"; fi
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

# The tool gets the same signal and removes its unfinished files.
trap 'exit 143' TERM HUP
trap 'exit 130' INT

for name in ARTIFACTS SCENE MODEL MASKS GT HOLD_OUT METHOD QUALITY DEVICE {SCENE,VARIANCE,SAMPLE,RBF,JOINT,EXTRACT,RENDER,EVAL,REPORT,COMMON,UNKEYED}_FLAGS; do
  declare "$name=${!name:-}"
done

# make replaces exit codes by its own; this file passes the tool's code to ngs-gs.sh.
# Code 1 is reserved for --fail-below; a 1 here means that mkdir, rm or mv failed.
trap 'code=$?; if [ $code -eq 1 ]; then code=8; fi; if [ $code -ne 0 ] && [ -d "$OUT/.state" ]; then printf %s $code > "$OUT/.state/exit_code"; fi' EXIT

first_existing() {  # prints the first path that exists
  local path
  for path in "$@"; do
    if [ -e "$path" ]; then printf '%s' "$path"; return; fi
  done
}

source_of_scene() {  # same order as ngs-scene
  first_existing "$SCENE/cameras.bin" "$SCENE/cameras.txt" "$SCENE/sparse" "$SCENE/colmap/sparse/0" \
    "$SCENE/transforms.json" "$SCENE/transforms_train.json" "$SCENE/cameras.json" "$SCENE/poses_bounds.npy" \
    "$SCENE/scene.json"
}

photo_folders() {  # one per line: images/, and the folders named in a transforms file
  local source
  printf '%s\n' "$SCENE/images"
  source=$(source_of_scene)
  case $source in
    *.json) { grep -o '"file_path" *: *"[^"]*/' "$source" || true; } | sed 's/.*: *"//' | sort -u |
      while IFS= read -r folder; do case $folder in /*) printf '%s\n' "$folder" ;; *) printf '%s\n' "$SCENE/$folder" ;; esac; done ;;
  esac
}

model_of_scene() {
  if [ -n "$MODEL" ]; then printf '%s' "$MODEL"; return; fi
  local trained
  trained=$(first_existing "$SCENE/point_cloud.ply" "$SCENE/model.ply")
  # Output of the Inria trainer: the last iteration, as in ngs-scene; other folders there are copies.
  if [ -z "$trained" ] && [ -d "$SCENE/point_cloud" ]; then
    trained=$(find -L "$SCENE/point_cloud" -mindepth 2 -maxdepth 2 -regex '.*/iteration_[0-9]+/point_cloud\.ply' | sort -V | tail -n 1)
  fi
  if [ -z "$trained" ] && [ "$(source_of_scene)" = "$SCENE/scene.json" ]; then  # scene of ngs-scene orbit names its model
    trained=$(sed -n 's/^ *"model": "\(.*\)",$/\1/p' "$SCENE/scene.json")
    case $trained in '' | /*) ;; *) trained=$SCENE/$trained ;; esac
  fi
  printf '%s' "$trained"
}

masks_of_scene() {
  if [ -n "$MASKS" ]; then printf '%s' "$MASKS"; else first_existing "$SCENE/masks" "$SCENE/masks_sam"; fi
}

# True masks: GT, else masks_gt/ or gt/ of the scene, else the input masks of the held-out views, which no stage reads.
truth_of_scene() {
  if [ -n "$GT" ]; then printf '%s' "$GT"; return; fi
  local truth
  truth=$(first_existing "$SCENE/masks_gt" "$SCENE/gt")
  if [ -z "$truth" ] && [ -z "$(no_input_as_truth)" ]; then truth=$(masks_of_scene); fi
  printf '%s' "$truth"
}

# mask_setting NAME: mask setting in scene.json; empty before ngs-scene has run.
mask_setting() { sed -n "/^ *\"masks\":/{s/.*\"$1\":\"\{0,1\}\([a-z0-9]*\).*/\1/p;q}" "$OUT/scene.json" 2> /dev/null || true; }

# Prints why input masks cannot be used as ground truth; empty if they can.
no_input_as_truth() {
  if [ -z "$HOLD_OUT" ] || [ -z "$(masks_of_scene)" ]; then
    echo "no held-out views"
  elif [ -f "$OUT/scene.json" ] && ! grep -q '"mask":.*"split":"held-out"' "$OUT/scene.json"; then
    echo "no held-out view has an input mask"
  else
    unlike_truth
  fi
}

# Prints why ngs-eval cannot read the input masks as ngs-scene does; empty if it can.
unlike_truth() {
  if [ "$(mask_setting invert)" = true ]; then
    echo "the input masks are inverted"
  elif [ "$(mask_setting mode)" = bands ]; then
    echo "the input masks are bands"
  fi
}

tool_path() {
  if [ -n "${BIN:-}" ]; then printf '%s/%s' "$BIN" "$1"; else command -v "$1" || printf '%s' "$1"; fi
}

# device_of TOOL: prints its --device option. Tools and methods without a CUDA path would reject it.
device_of() {
  case $1:${METHOD:-ngs} in
    ngs-variance:* | ngs-rbf:* | ngs-render:* | ngs-joint:ngs | ngs-joint:ng-gs) if [ -n "$DEVICE" ]; then printf -- '--device %q' "$DEVICE"; fi ;;
  esac
}

# at NAME: a path in OUT, quoted for `step`; absolute, so that a printed rm is safe in any folder.
at() { printf %q "$(realpath -m "$OUT")/$1"; }
# step COMMAND: runs a shell command of a stage; a dry run prints it.
step() { if [ -n "${NGS_DRY_RUN:-}" ]; then printf '%s\n' "$1"; else eval "$1"; fi; }

# run TOOL ARGUMENTS...: runs a tool with its report in reports/. Continues after code 7 (budget reached, partial result).
run() {
  local tool=$1 name=$1 code=0
  shift
  if [ "${1:-}" = --report-name ]; then name=$2; shift 2; fi
  eval "set -- \"\$@\" --report \"\$OUT/reports/\$name.json\" -w $COMMON_FLAGS $(device_of "$tool") $UNKEYED_FLAGS"
  if [ -n "${NGS_DRY_RUN:-}" ]; then
    printf '%q ' "$tool" "$@"
    printf '\n'
    return
  fi
  mkdir -p "$OUT/reports"
  { printf '%q ' "$tool" "$@"; printf '\n'; } > "$OUT/reports/$name.sh"  # for the report page
  "$(tool_path "$tool")" "$@" || code=$?
  if [ "$code" -eq 7 ]; then
    say "$tool stopped at its budget; continuing with its partial result"
  elif [ "$code" -eq 1 ]; then  # finished, but a bound of --fail-below was not met
    if [ "$name" = ngs-eval ]; then printf 1 > "$OUT/.state/check_failed"; fi
  elif [ "$code" -ne 0 ]; then
    exit "$code"
  fi
}

flags() {  # splits a *_FLAGS variable, quoted for the shell, into the array `words`
  eval "words=(${1:-})"
}

stage_scene() {
  local source model masks optional=()
  source=$(source_of_scene) model=$(model_of_scene) masks=$(masks_of_scene)
  [ -n "$source" ] || fail 3 "$SCENE: no poses found (sparse/, colmap/sparse/0, transforms.json, cameras.json, poses_bounds.npy, or the scene.json of ngs-scene orbit)" \
    "make poses from photos with colmap automatic_reconstructor; for a splat without photos use: ngs cut MODEL.ply"
  [ -n "$model" ] || fail 3 "$SCENE: no point_cloud.ply found" "give one with --model, or fit one: ngs-fit"
  [ -n "$masks" ] || [ -n "${NO_MASKS:-}" ] || fail 3 "$SCENE: no folder 'masks' found" "give one with --masks DIR"
  case $source in */sparse | */sparse/0 | */cameras.bin | */cameras.txt) source=$SCENE ;; esac
  if [ -d "$SCENE/images" ]; then optional+=(--images "$SCENE/images"); fi
  if [ -n "$HOLD_OUT" ]; then optional+=(--hold-out "$HOLD_OUT"); fi
  flags "$SCENE_FLAGS"
  if [ -n "$masks" ]; then optional+=(--masks "$masks"); fi
  run ngs-scene import "$source" --ply "$model" "${optional[@]}" --image-scale "$IMAGE_SCALE" \
    "${words[@]}" -o "$OUT/scene.json"
}

stage_variance() {
  flags "$VARIANCE_FLAGS"
  run ngs-variance "$OUT/scene.json" "${words[@]}" -o "$OUT/boundary.ply"
}

stage_sample() {
  flags "$SAMPLE_FLAGS"
  run ngs-sample "$OUT/scene.json" "$OUT/boundary.ply" "${words[@]}" -o "$OUT/queries.ply"
}

stage_rbf() {
  flags "$RBF_FLAGS"
  run ngs-rbf "$OUT/boundary.ply" "$OUT/queries.ply" "${words[@]}" -o "$OUT/field.ply"
}

say_unless_quiet() { case " $UNKEYED_FLAGS " in *" -q "*) ;; *) say "$1" ;; esac; }

# Prints field.ply if ngs-joint reads it. Otherwise ngs-joint has the field off, or computes it itself with the same result.
field() {
  local i
  flags "$JOINT_FLAGS"
  if [ -n "$METHOD" ]; then words+=(--method "$METHOD"); fi
  if [ "$ARTIFACTS" = all ]; then echo field.ply; return; fi
  for i in "${!words[@]}"; do
    case ${words[i]}${words[i + 1]:+ ${words[i + 1]}} in
      "--method ng-gs" | "--method ng-gs "* | --method=ng-gs* | *nerf=on* | *all=on*) echo field.ply; return ;;
    esac
  done
}

stage_joint() {
  local field trace=(--trace "$OUT/trace.jsonl")
  flags "$JOINT_FLAGS"
  field=$(field)
  if [ -n "$METHOD" ]; then words+=(--method "$METHOD"); fi
  if [ -n "$QUALITY" ]; then words+=(--quality "$QUALITY"); fi
  if [ -z "$field" ]; then say_unless_quiet "queries.ply and field.ply are not needed (write them with --artifacts all)"; fi
  case " ${words[*]/#--method=/--method } " in
    *" --method ngs "* | *" --method ng-gs "*) ;;
    *" --method "*)  # baselines have no steps to trace
      trace=()
      step "rm -f $(at trace.jsonl)" ;;
  esac
  run ngs-joint "$OUT/scene.json" "$OUT/boundary.ply" ${field:+--field "$OUT/field.ply"} "${trace[@]}" "${words[@]}" \
    -o "$OUT/labelled.ply"
}

stage_extract() {
  flags "$EXTRACT_FLAGS"
  run ngs-extract "$OUT/labelled.ply" --object "$OUT/object.ply" --background "$OUT/background.ply" "${words[@]}"
}

# The render stage replaces the folder OUT/masks. Foreign masks in it would be lost, and if used as ground truth they would
# be compared with themselves.
refuse_foreign_masks() {
  local path out
  out=$(realpath -m "$OUT")
  for path in "$SCENE" "$SCENE"/{images,masks,masks_sam,masks_gt,gt} "$MASKS" "$GT"; do
    if [ -z "$path" ] || [ ! -e "$path" ]; then continue; fi
    if [ "$OUT" -ef "$path" ]; then fail 2 "$out: is also the input $path" "choose another folder for the outputs"; fi
    case $(realpath "$path")/ in
      "$(realpath -m "$OUT/masks")"/*)
        fail 2 "$out/masks: contains the input $path, but result masks are written there" \
          "choose another folder for the outputs" ;;
    esac
  done
  path=$(foreign_masks)
  if [ -n "$path" ]; then
    fail 2 "$out/masks: contains $path, which no run has rendered; result masks are written there" \
      "move it elsewhere; if it is an input, pass it with --masks or --gt"
  fi
}

# The first file of OUT/masks that is not in the list of the last render; older versions wrote an empty list.
foreign_masks() {
  local rendered=$OUT/.state/masks_rendered
  if [ ! -d "$OUT/masks" ] || { [ -e "$rendered" ] && [ ! -s "$rendered" ]; }; then return; fi
  listed_in "$OUT/masks" | LC_ALL=C comm -23 - "$([ -e "$rendered" ] && echo "$rendered" || echo /dev/null)" |
    sed -n '1{s|^\./||;p}'
}
listed_in() { (cd "$1" && find . ! -type d | LC_ALL=C sort); }

# The model must not be an output file: the next call would cut the object out of its own result.
refuse_own_model() {
  local model path
  model=$(model_of_scene)
  for path in "$OUT"/{boundary,queries,field,labelled,object,background}.ply; do
    if [ -n "$model" ] && [ "$path" -ef "$model" ]; then
      fail 2 "$(realpath -m "$path"): is the input model, but the result is written there" "choose another folder for the outputs"
    fi
  done
}

# Renders masks at the size of the photos, which is that of the ground truth.
stage_render() {
  local views=all
  if [ -n "$HOLD_OUT" ]; then views=held-out; fi
  step "rm -rf $(at masks) $(at .state/masks_rendered) $(at .state/masks)"
  flags "$RENDER_FLAGS"
  run ngs-render "$OUT/scene.json" "$OUT/labelled.ply" --views "$views" --layers mask --scale 0 --format png \
    "${words[@]}" -o "$OUT/.state/masks"
  # Write the list first: an interrupted run then leaves no unlisted masks.
  step "(cd $(at .state/masks) && find . ! -type d | LC_ALL=C sort) > $(at .state/masks_rendered)"
  step "mv $(at .state/masks) $(at masks)"
}

# eval_words DIR TRUTH: sets `words` to the options of ngs-eval for the masks in DIR. Several objects have one folder each;
# folders of a single object are part of the view names, such as cameras of a rig. Label maps used as ground truth, and those
# without ids in EVAL_FLAGS, get the object ids and void id of scene.json.
eval_words() {
  local labels layout=view ids id
  flags "$EVAL_FLAGS"
  if [ "$(mask_setting mode)" = label ]; then
    if [ "$2" = "$(masks_of_scene)" ] && [[ $EVAL_FLAGS != *--label-map* ]]; then words+=(--label-map); fi
    if [[ ${words[*]} == *--label-map* && $EVAL_FLAGS != *--object-id* ]]; then
      mapfile -t ids < <(sed -n 's/^ *{"name":"\(.*\)","id":\([0-9]*\)},\{0,1\}$/\1=\2/p' "$OUT/scene.json")
      for id in "${ids[@]}"; do words+=(--object-id "$id"); done
    fi
    id=$(mask_setting void_id)
    if [[ -n $id && ${words[*]} == *--label-map* && $EVAL_FLAGS != *--void-id* ]]; then words+=(--void-id "$id"); fi
  fi
  if [ -z "$(find -L "$1" -mindepth 2 -name '*.png' -print -quit 2> /dev/null)" ]; then return; fi
  labels=$(sed '/^end_header/q' "$OUT/labelled.ply" 2> /dev/null | LC_ALL=C grep -ac '^property float ngs_label' || true)
  if [ "$labels" -gt 1 ]; then layout=object/view; fi
  words+=(--layout "$layout")
}

stage_eval() {
  local truth masks unlike names=$OUT/.state/scored_views.txt
  truth=$(truth_of_scene) masks=$(masks_of_scene)
  step "rm -f $(at .state/check_failed) $(at metrics_input.json) $(at reports/ngs-eval-input.json)"
  step "(cd $(at masks) && find . -name '*.png' | sed 's|^\./||' | LC_ALL=C sort) > $(at .state/scored_views.txt)"
  if [ -z "$truth" ]; then
    say "no ground truth, and $(no_input_as_truth): nothing is scored"
    step "rm -f $(at metrics.json) $(at reports/ngs-eval.json)"
    return
  fi
  if [ "$truth" = "$masks" ]; then
    say "no ground truth given: scoring against the input masks of the held-out views"
  else  # score the input masks on the same views, for comparison
    unlike=$(unlike_truth)
    if [ "$(mask_setting mode)" = label ] && [[ $EVAL_FLAGS != *--label-map* ]]; then unlike="the input masks are label maps, the truth is not"; fi
  fi
  if [ -n "${unlike:-}" ]; then
    say "$unlike: no score of the input masks"
  elif [ "$truth" != "$masks" ]; then
    eval_words "$masks" "$truth"
    run ngs-eval --report-name ngs-eval-input "$masks" "$truth" --views "$names" "${words[@]}" -q -o "$OUT/metrics_input.json"
  fi
  eval_words "$OUT/masks" "$truth"
  run ngs-eval "$OUT/masks" "$truth" --views "$names" "${words[@]}" -o "$OUT/metrics.json"
}

stage_scored() {
  [ -f "$OUT/metrics.json" ] || fail 5 "no ground truth, and $(no_input_as_truth): nothing was scored" "give --gt or --hold-out"
}

stage_report() {
  flags "$REPORT_FLAGS"
  run ngs-report --report-name ngs-report "$OUT" -o "$OUT/report.html" "${words[@]}"
}

key() {
  local stage=$1 tool=ngs-$1 photos own
  stat -L -c '%n %s %Y' "$(tool_path "$tool")" 2>/dev/null || true
  printf '%s\n' "$COMMON_FLAGS" "$(device_of "$tool")"
  case $stage in
    scene)
      printf '%s\n' "$HOLD_OUT" "$IMAGE_SCALE" "$SCENE_FLAGS"
      mapfile -t photos < <(photo_folders)
      fingerprint "$(source_of_scene)" "$(model_of_scene)" "$(masks_of_scene)" "${photos[@]}"
      if [ -f "$HOLD_OUT" ]; then fingerprint "$HOLD_OUT"; fi ;;
    variance) printf '%s\n' "$VARIANCE_FLAGS" ;;
    sample) printf '%s\n' "$SAMPLE_FLAGS" ;;
    rbf) printf '%s\n' "$RBF_FLAGS" ;;
    joint) printf '%s\n' "$METHOD" "$QUALITY" "$JOINT_FLAGS" "$(field)" ;;
    extract) printf '%s\n' "$EXTRACT_FLAGS" ;;
    render) printf '%s\n' "$RENDER_FLAGS" ;;
    eval)
      printf '%s\n' "$EVAL_FLAGS"
      fingerprint "$(truth_of_scene)" ;;
    report) printf '%s\n' "$REPORT_FLAGS" ;;
  esac
  own=${stage^^}_FLAGS
  named_files "$COMMON_FLAGS ${!own:-}"
}

# named_files FLAGS: fingerprints of the input files named in these options.
named_files() {
  local words=() i file
  flags "$1"
  for i in "${!words[@]}"; do
    case ${words[i]} in
      --effects-from | --field | --options | --import | --scene | --world-transform | --hold-out | --views | --ply | --images | --masks)
        file=${words[i + 1]:-} ;;
      --effects-from=* | --field=* | --options=* | --import=* | --scene=* | --world-transform=* | --hold-out=* | --views=* | \
        --ply=* | --images=* | --masks=*)
        file=${words[i]#*=} ;;
      *) continue ;;
    esac
    if [ -e "$file" ]; then fingerprint "$file"; fi
  done
}

# Checks the options of all tools before the first one runs.
stage_options() {
  accepted "$SCENE_FLAGS" ngs-scene import
  accepted "$VARIANCE_FLAGS" ngs-variance
  accepted "$SAMPLE_FLAGS" ngs-sample
  accepted "$RBF_FLAGS" ngs-rbf
  accepted "$JOINT_FLAGS$(chosen --method "$METHOD")$(chosen --quality "$QUALITY")" ngs-joint
  accepted "$EXTRACT_FLAGS" ngs-extract
  accepted "$RENDER_FLAGS" ngs-render
  accepted "$EVAL_FLAGS" ngs-eval
  accepted "$REPORT_FLAGS" ngs-report
}
chosen() { if [ -n "$2" ]; then printf ' %q' "$1" "$2"; fi; }
# accepted FLAGS TOOL [COMMAND]: lets the tool parse the options without running.
accepted() {
  flags "$1 $COMMON_FLAGS $(device_of "$2") $UNKEYED_FLAGS"
  "$(tool_path "$2")" "${@:3}" "${words[@]}" --print-options > /dev/null || exit $?
}

# is_complete STAGE: whether artifacts that make does not track are complete.
is_complete() {
  case $1 in
    render) [ -d "$OUT/masks" ] && [ -z "$(listed_in "$OUT/masks" | LC_ALL=C comm -13 - "$OUT/.state/masks_rendered" 2> /dev/null)" ] ;;
    eval) [ -f "$OUT/metrics.json" ] || [ -z "$(truth_of_scene)" ] ;;
  esac
}

write_key() {  # a changed key makes the stage run
  local file=$OUT/.state/$1.key
  key "$1" > "$file.new"
  if cmp -s "$file.new" "$file" && is_complete "$1"; then rm "$file.new"; else mv "$file.new" "$file"; fi
}

if [ "$1" = field ]; then field; exit; fi
[ -n "$SCENE" ] || fail 2 "SCENE is not set, expected a folder with photos, poses and masks"
[ -d "$SCENE" ] || fail 3 "$SCENE: no such folder"
refuse_foreign_masks
refuse_own_model
if [ "$1" = check ]; then exit; fi
BIN=${BIN:-$(find_bin)}
if [ "$1" = options ]; then stage_options; exit; fi
# Serialises concurrent runs on one OUT.
if [ -z "${NGS_DRY_RUN:-}" ]; then
  exec 8> "$OUT/.state/stage.lock"
  flock 8
fi
# place_of STAGE: position in NGS_STAGES, such as "3/9"; empty if not in the list.
place_of() {
  local name names index=0
  read -ra names <<< "${NGS_STAGES:-}"
  for name in "${names[@]}"; do
    index=$((index + 1))
    if [ "$name" = "$1" ]; then printf "%d/%d" "$index" "${#names[@]}"; fi
  done
}

if [ "$1" = key ]; then write_key "$2"; exit; fi
NGS_STAGE_OF=$(place_of "$1")
if [ -n "$NGS_STAGE_OF" ]; then export NGS_STAGE_OF; else unset NGS_STAGE_OF; fi
"stage_$1"
