# Functions that the scripts of this folder share; sourced, never run.
# shellcheck shell=bash

unset CDPATH  # otherwise `cd NAME` may change to another folder and prints its path
pipelines=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck disable=SC2034  # for scripts elsewhere in the tree
top=$(cd "$pipelines/.." && pwd)

# say TEXT: prints to stderr, wrapped at words on a terminal.
say() {
  local columns=0
  if [ -t 2 ]; then columns=$(stty size <&2 2> /dev/null | cut -d ' ' -f 2) || true; fi
  if [ "${columns:-0}" -gt 20 ]; then printf '%s\n' "$*" | fold -s -w "$columns" >&2; else printf '%s\n' "$*" >&2; fi
}

# fail CODE MESSAGE [HINT]
fail() {
  say "error: $2"
  if [ -n "${3:-}" ]; then say "hint: $3"; fi
  exit "$1"
}

# The absolute folder of the tools: $NGS_BIN, then the build folder, else empty (PATH).
find_bin() {
  local folder hint="build them with $pipelines/build.sh, or set NGS_BIN to their folder"
  if [ -n "${NGS_BIN:-}" ]; then
    [ -x "$NGS_BIN/ngs-scene" ] || fail 8 "NGS_BIN=$NGS_BIN: does not contain the tools" "$hint"
    (cd -- "$NGS_BIN" && pwd)
    return
  fi
  for folder in "$pipelines"/../build/bin "$pipelines"/../build/*/bin; do
    if [ -x "$folder/ngs-scene" ]; then (cd "$folder" && pwd); return; fi
  done
  command -v ngs-scene > /dev/null || fail 8 "ngs-scene: not in the build folder, not in PATH" "$hint"
}

# tool NAME ARGUMENTS...: runs a tool of folder `bin` (the output of find_bin).
tool() { "${bin:+$bin/}$1" "${@:2}"; }

# need OPTION VALUE...: fails if an option ends the command line.
need() { [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help"; }

# run COMMAND...: checks only the options of a tool (pass=check), prints the command (pass=print) or runs it (pass=run). The last
# word of a tool's command is its report file; the command is stored next to it for the report page. After exit code 7 (budget
# reached) the chain continues with the partial result; code 1 (bound not met) sets `failed`; other failures end the script.
pass='' stages=0 stage=0 failed=0 last_code=0 child=''
# shellcheck disable=SC2034  # `failed` is for the script
run() {
  local code=0 report=${!#}
  case $pass:$1 in
    check:ngs-*) stages=$((stages + 1)); "$@" --print-options > /dev/null || exit ;;
    print:*) printf '%q ' "$@"; printf '\n' ;;
    run:ngs-*)
      stage=$((stage + 1))
      { printf '%q ' "$@"; printf '\n'; } > "${report%.json}.sh"
      # shellcheck disable=SC2086  # NGS_RUN may be several words
      NGS_STAGE_OF=$stage/$stages ${NGS_RUN:-} "$@" &
      child=$!
      trap 'stop 143' TERM HUP
      trap 'stop 130' INT
      wait "$child" || code=$?
      case $code in
        0) ;;
        1) failed=1 ;;
        7) say "$1: time budget used up; continuing with the partial result" ;;
        *) exit "$code" ;;
      esac
      last_code=$code ;;
    run:*) "$@" || exit 8; last_code=0 ;;
  esac
}

# stop CODE: ends the running tool, then the script.
stop() {
  kill -TERM "$child" 2> /dev/null || true
  wait "$child" 2> /dev/null || true
  exit "$1"
}

# refuse_out OUT INPUT...: exit code 2 if the chain would overwrite an input, or a file that no run of the chain has written.
# A folder written by the chain contains .state/, with a copy of the rendered masks.
refuse_out() {
  local out=$1 path name hint="choose another folder for the outputs"
  local chain_files=({scene,metrics,metrics_input}.json {boundary,queries,field,labelled,object,background,background-filled}.ply objects masks reports trace.jsonl report.html)
  shift
  for path in "$@"; do
    if [ ! -e "$path" ]; then continue; fi
    for name in . "${chain_files[@]}"; do
      if [ "$out/$name" -ef "$path" ]; then
        fail 2 "$(realpath "$out/$name"): is the input $path, but a result is written there" "$hint"
      fi
    done
    case $(realpath "$path") in
      "$(realpath -m "$out/masks")"/*) fail 2 "$out/masks: contains the input $path, but result masks are written there" "$hint" ;;
    esac
  done
  if [ -d "$out/.state" ]; then
    name=$(LC_ALL=C comm -23 <(files_in "$out/masks") <(files_in "$out/.state/masks") | head -n 1)
    name=${name:+masks/$name}
  else
    for name in "${chain_files[@]}" ''; do if [ -e "$out/$name" ]; then break; fi; done
  fi
  if [ -n "$name" ]; then
    fail 2 "$out/$name: no run of this chain has written it, but a result is written there" "$hint, or move it"
  fi
}
files_in() { (cd "$1" 2> /dev/null && find . ! -type d -printf '%P\n' | LC_ALL=C sort) || true; }

# is_unchanged FILE WORD...: whether the command WORD... was recorded in FILE, and nothing that it reads or writes has changed since.
is_unchanged() {
  local code
  [ -e "$1" ] && { read -r code && [ "$(cat)" = "$(key_of "$2" '' "${@:2}")" ]; } < "$1" || return 1
  # shellcheck disable=SC2034  # for the script
  if [ "$code" = 1 ]; then failed=1; fi
}
# record FILE WORD...: records the command that has just run, and its exit code.
record() { { printf '%s\n' "$last_code"; key_of "$2" '' "${@:2}"; } > "$1"; }

# lock_out OUT STEP...: waits for another run in the folder, then removes unfinished files, and what other steps have written.
lock_out() {
  local out=$1 file name
  shift
  mkdir -p -- "$out/.state" "$out/reports" || fail 8 "$out: cannot be created"
  exec 9> "$out/.state/run.lock" || fail 8 "$out: cannot be written"
  flock -n 9 || { say "another run is at work in $out, waiting for it"; flock 9; }
  for file in "$out"/reports/ngs-*.json; do
    name=${file##*/} name=${name%.json}
    if [[ " $* " != *" $name "* ]]; then rm -f -- "${file%.json}".{json,sh} "$out/.state/$name.step"; fi
  done
  if [[ " $* " != *" ngs-rbf "* ]]; then rm -f -- "$out"/{queries,field}.ply; fi
  rm -f -- "$out/.state/done"
  find "$out" -maxdepth 1 -name '.ngs-*.tmp*' -delete
}

# score_masks SCENE_JSON LABELLED TRUTH METRICS: scores the masks of the held-out views against TRUTH, at photo size.
score_masks() {
  rm -rf "$4.masks"
  tool ngs-render "$1" "$2" --views held-out --layers mask --scale 0 -o "$4.masks" -w -q > /dev/null &&
    tool ngs-eval "$4.masks" "$3" -o "$4" -w -q > /dev/null && rm -r "$4.masks"
}

# key_of TOOL SKIPPED WORD...: prints what the result of a command depends on: the binary of TOOL, the words, and the files that
# they name, also as --option=FILE, but for SKIPPED, the folder of the result.
key_of() {
  local tool=$1 skipped=$2 word paths=()
  shift 2
  if [ -z "${bin:-}" ]; then local bin; bin=$(find_bin) || return; fi
  tool=$(PATH=${bin:+$bin:}$PATH command -v "$tool") || true
  printf '%s\n' "$@"
  for word in "$tool" "$@"; do
    word=${word#--*=}
    if [ "$word" != "$skipped" ] && [[ $word != -* ]] && [ -e "$word" ]; then paths+=("$word"); fi
  done
  fingerprint "${paths[@]}"
}
exported_flags() { env | grep '^[A-Z]*_FLAGS=' | sort || true; }

# once FOLDER COMMAND...: runs the command, which fills FOLDER, unless it has already succeeded there with the same key.
once() {
  local folder=$1 key code=0
  shift
  key=$(key_of ngs-joint "$folder" "$@" "$(exported_flags)") || return
  if [ "$(cat "$folder/.state/done" 2> /dev/null)" = "$key" ]; then return; fi
  "$@" || code=$?
  if [ "$code" -eq 0 ]; then mkdir -p "$folder/.state" && printf '%s\n' "$key" > "$folder/.state/done"; fi
  return "$code"
}

# evidence_of SCENE_DIR OUT_DIR [options of ngs-scene import]: writes OUT_DIR/scene.json and OUT_DIR/boundary.ply.
evidence_of() {
  local scene=$1 out=$2 flags
  shift 2
  eval "flags=(${SCENE_FLAGS:-})"
  mkdir -p "$out"
  tool ngs-scene import "$scene" "$@" "${flags[@]}" -o "$out/scene.json" -w -q > /dev/null &&
    tool ngs-variance "$out/scene.json" -o "$out/boundary.ply" -w -q > /dev/null
}

# run_scene NAME SCENE_DIR OUT_DIR [options of ngs-gs.sh]: one scene of a loop. Prints a failure, counts it in
# `failed_scenes` and returns, so that the loop continues. `finished_runs` collects finished folders, including those below
# --fail-below: a mean without them would be biased.
finished_runs=() failed_scenes=0
run_scene() {
  local name=$1 scene=$2 out=$3 code=0
  shift 3
  say "== $name"
  once "$out" "$pipelines/ngs-gs.sh" "$scene" "$out" "$@" || code=$?
  if [ "$code" -le 1 ]; then finished_runs+=("$out"); fi
  if [ "$code" -eq 1 ]; then say "$name: a bound of --fail-below was not met"; fi
  if [ "$code" -gt 1 ]; then say "$name failed with exit code $code"; fi
  if [ "$code" -ne 0 ]; then failed_scenes=$((failed_scenes + 1)); fi
}

fingerprint() {  # names, sizes and times of the files under the given paths, but for folders that the chain has made
  [ $# -gt 0 ] || return 0
  { find -L "$@" -type d -exec test -d '{}/.state' \; -prune -o -type f -printf '%p %s %T@\n' 2>/dev/null || true; } | LC_ALL=C sort
}

# degraded_masks MASKS TO FLAGS...: `ngs-scene degrade FLAGS` of MASKS to folder TO; repeated only if the input changed.
degraded_masks() {
  local masks=$1 to=$2 bin key
  shift 2
  bin=$(find_bin) || return
  key=$(printf '%s\n' "$*" && fingerprint "$masks")
  if [ -d "$to" ] && [ "$(cat "$to.key" 2> /dev/null)" = "$key" ]; then return; fi
  rm -rf "$to" "$to.part" "$to.key"
  mkdir -p "$(dirname "$to")"
  "${bin:+$bin/}ngs-scene" degrade "$masks" "$@" -o "$to.part" -q > /dev/null && mv "$to.part" "$to" &&
    printf '%s\n' "$key" > "$to.key"
}

# compare_runs OUT_DIR RUN...: writes report.html and summary.json of several runs; prints their table to stderr.
compare_runs() {
  local out=$1 bin
  shift
  [ $# -gt 0 ] || fail 5 "no scene finished"
  bin=$(find_bin) || return
  "${bin:+$bin/}ngs-report" "$@" -o "$out/report.html" -w --report "$out/summary.json" || return
  say "summary: $out/summary.json, page: $out/report.html"
}

# mean_of_summaries SUMMARY...: means over the summaries of compare_runs; each score over the scenes that have it.
mean_of_summaries() {
  awk '
    FNR == 1 { inside = 0 }
    /"mean_over_runs": \{/ { inside = 1; next }
    inside && /\}/ { inside = 0 }
    inside { gsub(/[",:]/, " "); if ($2 == "null") next; if (!($1 in sum)) order[++names] = $1; sum[$1] += $2; ++scenes[$1] }
    END { for (i = 1; i <= names; ++i) { n = order[i]; printf "mean over %d scenes: %-16s %.4f\n", scenes[n], n, sum[n] / scenes[n] } }
  ' "$@" >&2
}

# usage_of SCRIPT: prints its leading comment.
usage_of() { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$1"; }

# held_out SCENE_DIR every:N:K: prints the names of the held-out photos.
held_out() {
  local rule=${2#every:}
  find -L "$1/images" -type f -printf '%f\n' | LC_ALL=C sort |
    awk -v n="${rule%:*}" -v k="${rule#*:}" '(NR - 1) % n == k'
}

# without_views SCENE_DIR MASKS SPLIT TO: a copy of the capture without the views of SPLIT (COLMAP text).
without_views() {
  local kept
  rm -rf "$4"
  mkdir -p "$4/images" "$4/masks" "$4/sparse/0"
  ln -s "$(realpath "$1/point_cloud.ply")" "$4/point_cloud.ply"
  held_out "$1" "$3" > "$4/taken"
  find -L "$1/images" -type f -printf '%f\n' | grep -vxFf "$4/taken" | while read -r kept; do
    ln -s "$(realpath "$1/images/$kept")" "$4/images/"
    ln -s "$(realpath "$2/${kept%.*}.png")" "$4/masks/"
  done
  cp "$1/sparse/0/cameras.txt" "$1/sparse/0/points3D.txt" "$4/sparse/0/"
  # An image has two lines; the first ends with its name, the second may be empty.
  awk '
    FNR == NR { taken[$1]; next }
    /^#/ { print; next }
    !second { drop = $NF in taken }
    !drop { print }
    { second = !second }' "$4/taken" "$1/sparse/0/images.txt" > "$4/sparse/0/images.txt"
}
