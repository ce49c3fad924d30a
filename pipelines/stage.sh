#!/usr/bin/env bash
# One stage of experiment.mk: `stage.sh STAGE` runs its tool, `stage.sh key STAGE` writes what the stage depends on beside
# the artifacts before it to OUT/.state/STAGE.key where that differs; with NGS_DRY_RUN set the commands are printed only.
# `stage.sh check` only refuses an OUT where a stage would replace what is not its own, as every other call does first;
# `stage.sh options` refuses options that a tool would refuse when its turn comes;
# `stage.sh scored` fails where nothing was scored; `stage.sh field` says field.ply where a stage reads it or it is asked for.
# NGS_STAGES, where set, names the stages of the whole run: the tools then say which of them they are (NGS_STAGE_OF).
# All values come through the environment, so that paths may hold any character. Not called by hand.
set -euo pipefail
if [ -n "${NGS_STDERR:-}" ]; then exec 2>&"$NGS_STDERR"; fi
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

# The tool is sent the same signal, and has files to take away.
trap 'exit 143' TERM HUP
trap 'exit 130' INT

for name in ARTIFACTS SCENE MODEL MASKS GT HOLD_OUT METHOD QUALITY DEVICE {SCENE,VARIANCE,SAMPLE,RBF,JOINT,EXTRACT,RENDER,EVAL,REPORT,COMMON,UNKEYED}_FLAGS; do
  declare "$name=${!name:-}"
done

# Make turns every failure into its own code; ngs-gs.sh finds the tool's here.
# It is 1 only where --fail-below was not met; a 1 from here is a mkdir, rm or mv that could not.
trap 'code=$?; if [ $code -eq 1 ]; then code=8; fi; if [ $code -ne 0 ] && [ -d "$OUT/.state" ]; then printf %s $code > "$OUT/.state/exit_code"; fi' EXIT

first_existing() {  # the first path that exists, else nothing
  local path
  for path in "$@"; do
    if [ -e "$path" ]; then printf '%s' "$path"; return; fi
  done
}

source_of_scene() {  # in the order in which ngs-scene looks
  first_existing "$SCENE/cameras.bin" "$SCENE/cameras.txt" "$SCENE/sparse" "$SCENE/colmap/sparse/0" \
    "$SCENE/transforms.json" "$SCENE/transforms_train.json" "$SCENE/cameras.json" "$SCENE/poses_bounds.npy" \
    "$SCENE/scene.json"
}

photo_folders() {  # a line each: images/, and those that the frames of a transforms file name
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
  # A folder of the Inria trainer: the last iteration, as ngs-scene takes it; what else lies there is somebody's copy.
  if [ -z "$trained" ] && [ -d "$SCENE/point_cloud" ]; then
    trained=$(find -L "$SCENE/point_cloud" -mindepth 2 -maxdepth 2 -regex '.*/iteration_[0-9]+/point_cloud\.ply' | sort -V | tail -n 1)
  fi
  if [ -z "$trained" ] && [ "$(source_of_scene)" = "$SCENE/scene.json" ]; then  # of ngs-scene orbit, which names it
    trained=$(sed -n 's/^ *"model": "\(.*\)",$/\1/p' "$SCENE/scene.json")
    case $trained in '' | /*) ;; *) trained=$SCENE/$trained ;; esac
  fi
  printf '%s' "$trained"
}

masks_of_scene() {
  if [ -n "$MASKS" ]; then printf '%s' "$MASKS"; else first_existing "$SCENE/masks" "$SCENE/masks_sam"; fi
}

# The truth: GT, else the scene's own, else the input masks of the held-out views, which no stage has seen.
truth_of_scene() {
  if [ -n "$GT" ]; then printf '%s' "$GT"; return; fi
  local truth
  truth=$(first_existing "$SCENE/masks_gt" "$SCENE/gt")
  if [ -z "$truth" ] && [ -z "$(no_stand_in)" ]; then truth=$(masks_of_scene); fi
  printf '%s' "$truth"
}

# mask_setting NAME: how ngs-scene reads the input masks; nothing before it has run.
mask_setting() { sed -n "/^ *\"masks\":/{s/.*\"$1\":\"\{0,1\}\([a-z0-9]*\).*/\1/p;q}" "$OUT/scene.json" 2> /dev/null || true; }

# Why the input masks cannot stand in for the truth; nothing where they can.
no_stand_in() {
  if [ -z "$HOLD_OUT" ] || [ -z "$(masks_of_scene)" ]; then
    echo "no held-out views"
  elif [ -f "$OUT/scene.json" ] && ! grep -q '"mask":.*"split":"held-out"' "$OUT/scene.json"; then
    echo "no held-out view has an input mask"
  else
    unlike_truth
  fi
}

# What about the input masks ngs-eval cannot read as ngs-scene does; nothing where it can.
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

# device_of TOOL: its --device. A tool, or a method, without a CUDA path refuses one that it cannot have.
device_of() {
  case $1:${METHOD:-ngs} in
    ngs-variance:* | ngs-rbf:* | ngs-render:* | ngs-joint:ngs | ngs-joint:ng-gs) if [ -n "$DEVICE" ]; then printf -- '--device %q' "$DEVICE"; fi ;;
  esac
}

# at NAME: a path of OUT as a word of `step`; absolute, or a printed rm would do harm in another folder.
at() { printf %q "$(realpath -m "$OUT")/$1"; }
# step COMMAND: what a stage does beside its tool; a dry run prints it.
step() { if [ -n "${NGS_DRY_RUN:-}" ]; then printf '%s\n' "$1"; else eval "$1"; fi; }

# run TOOL ARGUMENTS...: the report goes to reports/. A budget that was hit leaves a usable result: code 7 goes on.
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
  { printf '%q ' "$tool" "$@"; printf '\n'; } > "$OUT/reports/$name.sh"  # for the page: how to repeat it
  "$(tool_path "$tool")" "$@" || code=$?
  if [ "$code" -eq 7 ]; then
    say "$tool stopped at its budget; going on with its partial result"
  elif [ "$code" -eq 1 ]; then  # done; --fail-below was not met
    if [ "$name" = ngs-eval ]; then printf 1 > "$OUT/.state/check_failed"; fi
  elif [ "$code" -ne 0 ]; then
    exit "$code"
  fi
}

flags() {  # words of a *_FLAGS variable, which is quoted for the shell, into the array `words`
  eval "words=(${1:-})"
}

stage_scene() {
  local source model masks optional=()
  source=$(source_of_scene) model=$(model_of_scene) masks=$(masks_of_scene)
  [ -n "$source" ] || fail 3 "$SCENE: no poses found (sparse/, colmap/sparse/0, transforms.json, cameras.json, poses_bounds.npy, or the scene.json of ngs-scene orbit)" \
    "colmap automatic_reconstructor makes poses of photos; a splat alone needs none: ngs cut MODEL.ply"
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

# Elsewhere ngs-joint has the field off, or samples and interpolates by itself, with the same result.
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
  if [ -z "$field" ]; then say_unless_quiet "queries.ply and field.ply are not needed (--artifacts all makes them)"; fi
  case " ${words[*]/#--method=/--method } " in
    *" --method ngs "* | *" --method ng-gs "*) ;;
    *" --method "*)  # a baseline, which has no steps to trace
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

# The render stage replaces OUT/masks as a whole. Masks that came from elsewhere would be lost, and as the truth they
# would be compared with themselves.
refuse_foreign_masks() {
  local path out
  out=$(realpath -m "$OUT")
  for path in "$SCENE" "$SCENE"/{images,masks,masks_sam,masks_gt,gt} "$MASKS" "$GT"; do
    if [ -z "$path" ] || [ ! -e "$path" ]; then continue; fi
    if [ "$OUT" -ef "$path" ]; then fail 2 "$out: is the input $path too" "choose another folder for the outputs"; fi
    case $(realpath "$path")/ in
      "$(realpath -m "$OUT/masks")"/*)
        fail 2 "$out/masks: holds the input $path, the masks of the result go there" \
          "choose another folder for the outputs" ;;
    esac
  done
  path=$(foreign_masks)
  if [ -n "$path" ]; then
    fail 2 "$out/masks: holds $path, which no run has rendered; the masks of the result go there" \
      "move it elsewhere, and name it with --masks or --gt if it is an input"
  fi
}

# The first file of OUT/masks that is not in the list of the last render; an empty list is of a version that wrote none.
foreign_masks() {
  local rendered=$OUT/.state/masks_rendered
  if [ ! -d "$OUT/masks" ] || { [ -e "$rendered" ] && [ ! -s "$rendered" ]; }; then return; fi
  listed_in "$OUT/masks" | LC_ALL=C comm -23 - "$([ -e "$rendered" ] && echo "$rendered" || echo /dev/null)" |
    sed -n '1{s|^\./||;p}'
}
listed_in() { (cd "$1" && find . ! -type d | LC_ALL=C sort); }

# The model is read at every call; where a stage replaced it, the next call would cut the object out of its own result.
refuse_own_model() {
  local model path
  model=$(model_of_scene)
  for path in "$OUT"/{boundary,queries,field,labelled,object,background}.ply; do
    if [ -n "$model" ] && [ "$path" -ef "$model" ]; then
      fail 2 "$(realpath -m "$path"): is the input model, the result goes there" "choose another folder for the outputs"
    fi
  done
}

# Masks at the size of the photos, not at the working size: the truth is compared there.
stage_render() {
  local views=all
  if [ -n "$HOLD_OUT" ]; then views=held-out; fi
  step "rm -rf $(at masks) $(at .state/masks_rendered) $(at .state/masks)"
  flags "$RENDER_FLAGS"
  run ngs-render "$OUT/scene.json" "$OUT/labelled.ply" --views "$views" --layers mask --scale 0 --format png \
    "${words[@]}" -o "$OUT/.state/masks"
  # The list first: a run that ends between the two leaves no masks that nobody owns.
  step "(cd $(at .state/masks) && find . ! -type d | LC_ALL=C sort) > $(at .state/masks_rendered)"
  step "mv $(at .state/masks) $(at masks)"
}

# eval_words DIR TRUTH: the options of ngs-eval for the masks in DIR, into `words`. Masks of several objects lie in a folder
# each; folders of a single object belong to the views' names, as the cameras of a rig. Label maps that stand in for the truth
# have the ids that ngs-scene found in them and its void id, and so do those that EVAL_FLAGS says nothing else of.
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
    say "no ground truth, and $(no_stand_in): nothing is scored"
    step "rm -f $(at metrics.json) $(at reports/ngs-eval.json)"
    return
  fi
  if [ "$truth" = "$masks" ]; then
    say "no ground truth given: the input masks of the held-out views stand in for it"
  else  # the input masks' own score on the same views, for comparison
    unlike=$(unlike_truth)
    if [ "$(mask_setting mode)" = label ] && [[ $EVAL_FLAGS != *--label-map* ]]; then unlike="the input masks are label maps, the truth is not"; fi
  fi
  if [ -n "${unlike:-}" ]; then
    say "$unlike: they are not scored themselves"
  elif [ "$truth" != "$masks" ]; then
    eval_words "$masks" "$truth"
    run ngs-eval --report-name ngs-eval-input "$masks" "$truth" --views "$names" "${words[@]}" -q -o "$OUT/metrics_input.json"
  fi
  eval_words "$OUT/masks" "$truth"
  run ngs-eval "$OUT/masks" "$truth" --views "$names" "${words[@]}" -o "$OUT/metrics.json"
}

stage_scored() {
  [ -f "$OUT/metrics.json" ] || fail 5 "no ground truth, and $(no_stand_in): nothing was scored" "give --gt or --hold-out"
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

# named_files FLAGS: what is in the files that these options name, as far as they are inputs.
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

# A misspelt option of the last tool is found before the first has worked for an hour.
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
# accepted FLAGS TOOL [COMMAND]: the tool reads the options and does nothing with them.
accepted() {
  flags "$1 $COMMON_FLAGS $(device_of "$2") $UNKEYED_FLAGS"
  "$(tool_path "$2")" "${@:3}" "${words[@]}" --print-options > /dev/null || exit $?
}

# is_whole STAGE: whether the stage's artifacts that make does not see are all there.
is_whole() {
  case $1 in
    render) [ -d "$OUT/masks" ] && [ -z "$(listed_in "$OUT/masks" | LC_ALL=C comm -13 - "$OUT/.state/masks_rendered" 2> /dev/null)" ] ;;
    eval) [ -f "$OUT/metrics.json" ] || [ -z "$(truth_of_scene)" ] ;;
  esac
}

write_key() {  # a key that is new makes the stage run
  local file=$OUT/.state/$1.key
  key "$1" > "$file.new"
  if cmp -s "$file.new" "$file" && is_whole "$1"; then rm "$file.new"; else mv "$file.new" "$file"; fi
}

if [ "$1" = field ]; then field; exit; fi
[ -n "$SCENE" ] || fail 2 "SCENE is not set, expected a folder with photos, poses and masks"
[ -d "$SCENE" ] || fail 3 "$SCENE: no such folder"
refuse_foreign_masks
refuse_own_model
if [ "$1" = check ]; then exit; fi
BIN=${BIN:-$(find_bin)}
if [ "$1" = options ]; then stage_options; exit; fi
# Two makes at once on one OUT take turns.
if [ -z "${NGS_DRY_RUN:-}" ]; then
  exec 8> "$OUT/.state/stage.lock"
  flock 8
fi
# place_of STAGE: "3/9" among NGS_STAGES; nothing where it is none of them.
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
