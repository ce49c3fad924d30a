# Functions that the scripts of this folder share; sourced, never run.
# shellcheck shell=bash

unset CDPATH  # otherwise `cd NAME` may change to another folder and prints its path
pipelines=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

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

# score_masks SCENE_JSON LABELLED TRUTH METRICS: scores the masks of the held-out views against TRUTH, at photo size.
score_masks() {
  rm -rf "$4.masks"
  tool ngs-render "$1" "$2" --views held-out --layers mask --scale 0 -o "$4.masks" -w -q > /dev/null &&
    tool ngs-eval "$4.masks" "$3" -o "$4" -w -q > /dev/null && rm -r "$4.masks"
}

# run_scene NAME SCENE_DIR OUT_DIR [options of ngs-gs.sh]: one scene of a loop. Prints a failure, counts it in
# `failed_scenes` and returns, so that the loop continues. `finished_runs` collects finished folders, including those below
# --fail-below: a mean without them would be biased.
finished_runs=() failed_scenes=0
run_scene() {
  local name=$1 scene=$2 out=$3 code=0
  shift 3
  say "== $name"
  "$pipelines/ngs-gs.sh" "$scene" "$out" "$@" || code=$?
  if [ "$code" -le 1 ]; then finished_runs+=("$out"); fi
  if [ "$code" -eq 1 ]; then say "$name: a bound of --fail-below was not met"; fi
  if [ "$code" -gt 1 ]; then say "$name failed with exit code $code"; fi
  if [ "$code" -ne 0 ]; then failed_scenes=$((failed_scenes + 1)); fi
}

fingerprint() {  # names, sizes and times of the files under the given paths
  local path
  for path in "$@"; do
    [ -n "$path" ] || continue
    printf '%s\n' "$path"
    { find -L "$path" -type f -printf '%p %s %T@\n' 2>/dev/null || true; } | LC_ALL=C sort  # path may be absent
  done
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
