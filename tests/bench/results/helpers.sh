# What the questions share; sourced by results.sh. Question NAME is the function question_NAME of NAME.sh: it runs what
# it needs in the folder $work and prints the title, the columns and the rows of its table, in the lines of
# tests/bench/results_table/collect.h.
# shellcheck shell=bash disable=SC2034,SC2154

scenes=${NGS_SCENES:-$top/../shared/scenes}
splits=${SPLITS:-every:4:0 every:4:1 every:4:2 every:4:3}
recipes=${RECIPES:-torus-box leaves table bones two-spheres}
repeats=${REPEATS:-3}
export NGS_THREADS=2

# ---- lines

line() { local IFS=$'\t'; printf '%s\n' "$*"; }
title() { line meta title "$1"; }
label() { line column "$1" '' "$2" label; }  # NAME KEY
column() { line column "$@"; }               # NAME UNIT KEY SHOW DIGITS [KEY=VALUE]
row() { line row "$@"; }                     # KEY=VALUE...
without_options() { line meta defaults ''; }  # no option of a tool has a part in this question
score_columns() {
  column IoU '' iou mean 4
  column 'B-IoU 0.02' '' biou mean 4
  column 'B-IoU 0.005' '' biou_005 mean 4
}

# ---- where and what is measured

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

# What restricts this question, in words of the shell; nothing where it is whole.
restrictions() {
  local name
  for name in SPLITS RECIPES METHODS REPEATS; do
    if [ -n "${!name:-}" ] && grep -q "${name,,}" "$top/tests/bench/results/$question.sh"; then
      printf "%s='%s' " "$name" "${!name}"
    fi
  done
}

# The splits, for a title.
splits_text() {
  if [ -z "${SPLITS:-}" ]; then echo 'every:4:0 to every:4:3'; else printf '%s\n' "${splits// /, }"; fi
}

# Options of ngs-joint that are younger than the results and, as they are by default, leave every byte of a run as it was.
# A measurement of all questions empties this list.
younger_options='hash_smoothstep|field_depth|smooth_form'

# A hash of the default options of the tools that a scene goes through.
hash_of_defaults() {
  { for command in import variance joint render eval; do
      case $command in
        import) tool ngs-scene import --print-options ;;
        *) tool "ngs-$command" --print-options ;;
      esac
    done; } | sed -E "/^ *\"($younger_options)\":/d" | sha256sum | cut -c1-16
}

# ---- runs

# Whether METHODS, where it is set, names method $1.
wanted() { case " ${METHODS:-$1} " in *" $1 "*) ;; *) return 1 ;; esac; }

# The folder of a capture, which this repository does not contain.
capture() {
  [ -d "$scenes/$1" ] || fail 3 "$scenes/$1: no such folder" "NGS_SCENES names the folder of the captures"
  printf '%s\n' "$scenes/$1"
}

# prepare NAME SCENE_DIR [options of ngs-scene import]: $work/NAME/ holds scene.json and boundary.ply.
prepare() { once "$work/$1" evidence_of "$2" "$work/$1" "${@:3}" >&2; }

# The flags of ngs-joint behind a name of the tables.
flags_of() {
  case $1 in
    draft | standard | high | reference) printf '%s\n' "--quality $1" ;;
    auto) ;;
    'everything on') printf '%s\n' '--effect all=on' ;;
    *) printf '%s\n' "--method $1" ;;
  esac
}

# cut_out NAME PREPARED TRUTH FLAGS...: ngs-joint on the scene of $work/PREPARED, its masks of the held-out views
# scored, in the cameras of another prepared scene where `seen_in` names one: $work/NAME/joint.json and metrics.json.
cut_out() {
  local run=$work/$1 scene=$work/$2 truth=$3
  if [ "$(cat "$run/done" 2> /dev/null)" = "${*:4}." ]; then return; fi
  say "$question: $1"
  mkdir -p "$run"
  tool ngs-joint "$scene/scene.json" "$scene/boundary.ply" -o "$run/labelled.ply" -w -q \
    --report "$run/joint.json" "${@:4}"
  score_masks "$work/${seen_in:-$2}/scene.json" "$run/labelled.ply" "$truth" "$run/metrics.json"
  rm "$run/labelled.ply"
  printf '%s.' "${*:4}" > "$run/done"
}

# row_of NAME KEY=VALUE...: the row of a run of cut_out.
row_of() { row "${@:2}" scores="$work/$1/metrics.json" times="$work/$1/joint.json"; }

# methods NAMES PREPARED TRUTH KEY=VALUE...: runs and rows of every name in the words NAMES.
methods() {
  local method
  for method in $1; do
    wanted "$method" || continue
    # shellcheck disable=SC2046
    cut_out "$2-$method" "$2" "$3" $(flags_of "$method")
    row_of "$2-$method" method="$method" "${@:4}"
  done
}
