# Functions shared by the questions; sourced by results.sh. Question NAME is the function question_NAME of NAME.sh: it runs
# tools in the folder $work and prints title, columns and rows of its table, in the line format of
# tests/bench/results_table.py.
# shellcheck shell=bash disable=SC2034,SC2154

scenes=${NGS_SCENES:-$top/../shared/scenes}
splits=${SPLITS:-every:4:0 every:4:1 every:4:2 every:4:3}
recipes=${RECIPES:-torus-box leaves table bones two-spheres}
repeats=${REPEATS:-3}
export NGS_THREADS=2

# ---- lines

tables() { python3 "$top/tests/bench/results_table.py" "$@"; }
line() { local IFS=$'\t'; printf '%s\n' "$*"; }
title() { line meta title "$1"; }
label() { line column "$1" '' "$2" label; }  # NAME KEY
column() { line column "$@"; }               # NAME UNIT KEY SHOW DIGITS [KEY=VALUE]
row() { line row "$@"; }                     # KEY=VALUE...
without_options() { line meta defaults ''; }  # the question does not depend on options of tools
score_columns() {
  column IoU '' iou mean 4
  column 'B-IoU 0.02' '' biou mean 4
  column 'B-IoU 0.005' '' biou_005 mean 4
}

# ---- machine and inputs

machine_name() {
  if [ -n "${NGS_MACHINE:-}" ]; then printf '%s\n' "$NGS_MACHINE"; return; fi
  awk -F '\t*: ' '
    !($1 in value) { value[$1] = $2 }
    function has(flag) { return (" " value["flags"] " ") ~ (" " flag " ") }
    END {
      who = value["vendor_id"] ":" value["cpu family"]
      if (who == "AuthenticAMD:26") name = "AMD Zen 5"
      else if (who == "AuthenticAMD:25") name = has("avx512f") ? "AMD Zen 4" : "AMD Zen 3"
      else if (who ~ /^GenuineIntel/ && has("amx_tile")) name = "Intel Xeon with AMX"
      else name = value["model name"]
      print "two cores of " name
    }' /proc/cpuinfo
}

# Shell assignments that restrict this question; empty for the full question.
restrictions() {
  local name
  for name in SPLITS CAPTURES RECIPES ROOMS METHODS REPEATS; do
    if [ -n "${!name:-}" ] && grep -q "${name,,}" "$top/tests/bench/results/$question.sh"; then
      printf "%s='%s' " "$name" "${!name}"
    fi
  done
}

# The splits as text for a title.
splits_text() {
  if [ -z "${SPLITS:-}" ]; then echo 'every:4:0 to every:4:3'; else printf '%s\n' "${splits// /, }"; fi
}

# Options of ngs-joint that are newer than the results and whose defaults do not change any output byte. Empty this list
# after measuring all questions.
younger_options=''

# Hash of the default options of the tools in the chain, in any order.
hash_of_defaults() {
  { for command in import variance joint render eval; do
      case $command in
        import) tool ngs-scene import --print-options ;;
        *) tool "ngs-$command" --print-options ;;
      esac
    done; } | sed -E "/^ *\"($younger_options)\":/d; s/,\$//" | LC_ALL=C sort | sha256sum | cut -c1-16
}

# ---- runs

# True if METHODS is unset or contains method $1.
wanted() { case " ${METHODS:-$1} " in *" $1 "*) ;; *) return 1 ;; esac; }

# The folder of a capture (not part of this repository).
capture() {
  [ -d "$scenes/$1" ] || fail 3 "$scenes/$1: no such folder" "set NGS_SCENES to the folder of the captures"
  printf '%s\n' "$scenes/$1"
}

# prepare NAME SCENE_DIR [options of ngs-scene import]: writes scene.json and boundary.ply to $work/NAME/.
prepare() { once "$work/$1" evidence_of "$2" "$work/$1" "${@:3}" >&2; }

# prepare_recipe RECIPE [options of ngs-synth]: a scene of 16 views in $work/RECIPE-scene, prepared with masks that are wrong
# by 2 px.
prepare_recipe() {
  local scene=$work/$1-scene
  if [ ! -f "$scene/done" ]; then
    tool ngs-synth "$1" -o "$scene" --view-count 16 --fit-steps 1500 "${@:2}" -w -q > /dev/null
    touch "$scene/done"
  fi
  degraded_masks "$scene/masks_gt" "$scene/masks_2px" --mask-noise jitter:2 --seed 1
  prepare "$1" "$scene" --masks "$scene/masks_2px" --hold-out every:4:2
}

# The flags of ngs-joint for a name in the tables.
flags_of() {
  case $1 in
    draft | standard | high | reference) printf '%s\n' "--quality $1" ;;
    auto) ;;
    'everything on') printf '%s\n' '--effect all=on' ;;
    *) printf '%s\n' "--method $1" ;;
  esac
}

# cut_out NAME PREPARED TRUTH FLAGS...: runs ngs-joint on the scene of $work/PREPARED and scores the masks of the held-out
# views, with the cameras of the prepared scene `seen_in` if set. Writes $work/NAME/joint.json and metrics.json; with
# scores_alone also alone.json, of object.ply rendered alone, and unfinished.json, the same of --no-finish.
cut_out() {
  local run=$work/$1 scene=$work/$2 truth=$3
  if [ "$(cat "$run/done" 2> /dev/null)" = "${*:4}." ]; then return; fi
  say "$question: $1"
  mkdir -p "$run"
  tool ngs-joint "$scene/scene.json" "$scene/boundary.ply" -o "$run/labelled.ply" -w -q \
    --report "$run/joint.json" "${@:4}"
  score_masks "$work/${seen_in:-$2}/scene.json" "$run/labelled.ply" "$truth" "$run/metrics.json"
  if [ -n "${scores_alone:-}" ]; then
    score_alone "$scene/scene.json" "$run/labelled.ply" "$truth" "$run/alone.json"
    score_alone "$scene/scene.json" "$run/labelled.ply" "$truth" "$run/unfinished.json" --no-finish
  fi
  rm "$run/labelled.ply"
  printf '%s.' "${*:4}" > "$run/done"
}

# score_alone SCENE_JSON LABELLED TRUTH METRICS [options of ngs-extract]: scores of the object rendered alone at the held-out
# cameras.
score_alone() {
  tool ngs-extract "$2" --scene "$1" "${@:5}" --object-ply "$4.ply" -w -q > /dev/null
  alone_masks "$1" "$4.ply" "$3" "$4"
  rm "$4.ply"
}

# alone_masks SCENE_JSON OBJECT TRUTH METRICS: parts that other things hide in the photo are not scored if the scene of TRUTH
# has the truth of both halves.
alone_masks() {
  local masks=$4.alone/alpha truth=$3 flags=() of_halves=${3%/masks_gt}/halves/object/masks
  tool ngs-render "$1" "$2" --views held-out --layers alpha --scale 0 --format png -o "$masks" -w -q > /dev/null
  if [ -d "$of_halves" ]; then
    tool ngs-scene degrade "$masks" --missing 0 -o "$4.alone/01" -w -q > /dev/null  # alpha to 0/255: a label map
    masks=$4.alone/01 truth=$of_halves flags=(--label-map --void-id 128)
  fi
  tool ngs-eval "$masks" "$truth" "${flags[@]}" -o "$4" -w -q > /dev/null
  rm -r "$4.alone"
}

# row_of NAME KEY=VALUE...: prints the row of a run of cut_out.
row_of() { row "${@:2}" scores="$work/$1/metrics.json" times="$work/$1/joint.json"; }

# methods NAMES PREPARED TRUTH KEY=VALUE...: runs and rows of all names in NAMES.
methods() {
  local method
  for method in $1; do
    wanted "$method" || continue
    # shellcheck disable=SC2046
    cut_out "$2-$method" "$2" "$3" $(flags_of "$method")
    row_of "$2-$method" method="$method" "${@:4}"
  done
}
