#!/usr/bin/env bash
# Time until every tool ends after SIGTERM and SIGINT, in every phase of its work:
#   tests/bench/signals.sh SCENE_DIR MASKS_DIR OUT_DIR [CASE...]
# SCENE_DIR: a capture as for pipelines/ngs-gs.sh; SCENE_FLAGS: as for that script. CASE: a name in the list below;
# default: all. Views every:4:2 are held out.
# Each case first runs completely, into OUT_DIR/CASE, which later cases and calls reuse; its report lists the phases. Then it
# runs once for each phase with at least a thirtieth of the work, and for the first and last tenth of the whole run. Each of
# these runs gets a signal in the middle of its phase, at the CPU time known from the complete run, so that other load does
# not matter. SIGTERM goes to the process, as from a scheduler, and SIGINT to its group, as from a terminal.
# Output: tab-separated lines on stdout and in OUT_DIR/samples: case, phase, signal, CPU s before the signal, ms until every
# process of the run has ended, exit code, MiB, number of unfinished files left. Then a table on stderr.
# Exit code 1 if a run took more than a second, ended with another code than that of the signal, or left a file.
#   NGS_SIGNALS_MOST=N     at most N signals per case: first and last tenth, then the longest phases; default: all
#   NGS_SIGNALS_CAP_S=12   last CPU s for signals in the cases orbit, mask and fit, which repeat the same work
# Tools are searched in $NGS_BIN, then in the build folder.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=pipelines/common.sh
. "$here/../../pipelines/common.sh"
case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
if [ $# -lt 3 ]; then usage_of "$0"; exit 2; fi
scene=$(cd "$1" && pwd)
masks=$(cd "$2" && pwd)
mkdir -p "$3"
cd "$3"
shift 3
only=$* bin=$(find_bin) cap=${NGS_SIGNALS_CAP_S:-12} most=${NGS_SIGNALS_MOST:-1000} failed=0 turn=0
# The splat of any name; prefer point_cloud*, the name used by trainers.
model=$(find "$scene" -maxdepth 1 -regextype egrep -regex '.*\.(ply|spz|sog|splat|ksplat)' |
  awk '{ print ($0 ~ /\/point_cloud[^\/]*$/ ? 0 : 1) "\t" $0 }' | LC_ALL=C sort | head -n 1 | cut -f 2)
[ -n "$model" ] || fail 3 "$scene: no model" "expected a splat for ngs-scene import"
scene_flags=()
eval "scene_flags=(${SCENE_FLAGS:-})"
ticks=$(getconf CLK_TCK)
[ -f samples ] || : > samples

# Adds to `used` the CPU time in ticks of process $1, its children and their reaped children.
add_ticks() {
  local rest fields child children=''
  { read -r rest < "/proc/$1/stat"; } 2> /dev/null || return 0
  read -ra fields <<< "${rest##*) }"  # from field "state" on
  used=$((used + fields[11] + fields[12] + fields[13] + fields[14]))
  { read -r children < "/proc/$1/task/$1/children"; } 2> /dev/null || true
  for child in $children; do add_ticks "$child"; done
}

# True while a process of session $1 exists.
any_left() {
  local stat rest fields
  for stat in /proc/[0-9]*/stat; do
    { read -r rest < "$stat"; } 2> /dev/null || continue
    read -ra fields <<< "${rest##*) }"
    if [ "${fields[3]}" = "$1" ] && [ "${fields[0]}" != Z ]; then return 0; fi
  done
  return 1
}

now_ms() { printf '%s' $((${EPOCHREALTIME/./} / 1000)); }

# start FOLDER COMMAND...: starts the command in a new session, with {} replaced by FOLDER; sets `pid`.
start() {
  local folder=$1 word words=()
  shift
  for word in "$@"; do words+=("${word//\{\}/$folder}"); done
  case ${words[0]} in */*) ;; *) words[0]=${bin:+$bin/}${words[0]} ;; esac
  rm -rf "$folder" && mkdir "$folder"
  setsid env --default-signal=INT,QUIT "${words[@]}" > "$folder.out" 2> "$folder.err" &
  pid=$!
}

# phases REPORT: prints a line per phase: CPU s at its middle, share of the run, name.
phases() {
  awk '
    /^  "stages": / { inside = 1 }
    /^  },?$/ { inside = 0 }
    inside && match($0, /^ *"name": "/) { depth = RLENGTH; name[depth] = $0; gsub(/^[^:]*: "|",$/, "", name[depth]) }
    inside && /"cpu_s":/ {
      gsub(/[^0-9.e-]*/, "", $2)
      ++n; at[n] = depth; called[n] = name[depth]; cpu[n] = $2
    }
    END {
      # A phase is a child of the run, or a child of such a child; time between phases is placed before them.
      top = at[1]; begin[1] = 0
      for (i = 2; i <= n; ++i) {
        step = at[2] - top
        label = called[i]; leaf = 1
        if (at[i] == top + step) {
          start = inner = next_top; next_top += cpu[i]; parent = called[i]
          leaf = !(i < n && at[i + 1] > at[i])
        } else if (at[i] == top + 2 * step) {
          start = inner; inner += cpu[i]; label = parent ": " called[i]
        } else continue
        if (leaf) printf "%.3f\t%.4f\t%s\n", start + cpu[i] / 2, cpu[i] / cpu[1], label
      }
      printf "%.3f\t1\tfirst tenth\n%.3f\t1\tlast tenth\n", cpu[1] * 0.05, cpu[1] * 0.95
    }' "$1"
}

# sample NAME PHASE AT_S COMMAND...: runs the command and sends a signal at that CPU time.
sample() {
  local name=$1 phase=$2 target signal=TERM to code=0 used=0 began took memory left
  target=$(awk -v s="$3" -v t="$ticks" 'BEGIN { print int(s * t) }')
  if [ $((turn++ % 2)) -eq 1 ]; then signal=INT; fi
  start work "${@:4}"
  while [ "$used" -lt "$target" ] && [ -d "/proc/$pid" ]; do
    sleep 0.02
    used=0
    add_ticks "$pid"
    if [ "$used" -eq 0 ] && ! kill -0 "$pid" 2> /dev/null; then break; fi
  done
  memory=$(awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$pid/status" 2> /dev/null || true)
  if [ $signal = INT ]; then to=-$pid; else to=$pid; fi
  began=$(now_ms)
  kill "-$signal" -- "$to" 2> /dev/null || true
  wait "$pid" || code=$?
  took=$(($(now_ms) - began))
  if [ "$code" -eq 0 ]; then return; fi  # finished before the signal
  while any_left "$pid"; do took=$(($(now_ms) - began)); done
  left=$(find work -name '.ngs-*.tmp*' | wc -l)
  printf '%s\t%s\t%s\t%s\t%d\t%d\t%s\t%d\n' \
    "$name" "$phase" "$signal" "$3" "$took" "$code" "${memory:-0}" "$left" | tee -a samples
  case $signal$code in TERM143 | INT130) ;; *) failed=1 ;; esac
  if [ "$took" -gt 1000 ] || [ "$left" -gt 0 ]; then failed=1; fi
}

# measure NAME COMMAND...: samples all phases of a command; {} is its output folder.
measure() {
  local name=$1 middle share phase
  shift
  if [ ! -f "$name.json" ]; then
    start "$name" "$@"
    wait "$pid" || fail 1 "$name: failed" "see $PWD/$name.err"
    if [ -d "$name/out/reports" ]; then chain_report "$name/out/reports"; else cat "$name.out"; fi > "$name.json"
  fi
  if [ -n "$only" ] && [[ " $only " != *" $name "* ]]; then return; fi
  sed -i "/^$name\t/d" samples
  while IFS=$'\t' read -r middle share phase <&3; do
    if awk -v s="$share" 'BEGIN { exit !(s >= 1 / 30) }'; then sample "$name" "$phase" "$middle" "$@"; fi
  done 3< <(phases "$name.json" | sort -s -t "$(printf '\t')" -k 2,2gr | sed -n "1,${most}p")
}

# follow NAME COMMAND...: samples a long, repetitive command at five times up to the cap.
follow() {
  local name=$1 share
  shift
  if [ -n "$only" ] && [[ " $only " != *" $name "* ]]; then return; fi
  sed -i "/^$name\t/d" samples
  for share in 0.02 0.1 0.3 0.6 1; do
    sample "$name" "" "$(awk -v c="$cap" -v s="$share" 'BEGIN { print c * s }')" "$@"
  done
}

# chain_report FOLDER: a report with one stage per tool of the chain.
chain_report() {
  local report cpu
  cpu_of() { sed -n 's/^    "cpu_s": \(.*\),$/\1/p' "$@"; }
  cpu=$(cpu_of "$1"/*.json | awk '{ s += $1 } END { print s }')
  printf '  "stages": {\n    "name": "chain",\n    "cpu_s": %s,\n' "$cpu"
  find "$1" -name '*.json' -printf '%T@ %p\n' | sort -n | while read -r _ report; do
    printf '        "name": "%s",\n        "cpu_s": %s,\n' "$(basename "$report" .json)" "$(cpu_of "$report")"
  done
}

measure import ngs-scene import "$scene" --model "$model" --masks "$masks" --hold-out every:4:2 \
  "${scene_flags[@]}" -o '{}/scene.json'
measure check ngs-scene check import/scene.json
measure variance ngs-variance import/scene.json -o '{}/boundary.ply'
measure sample ngs-sample import/scene.json variance/boundary.ply -o '{}/queries.ply'
measure rbf ngs-rbf variance/boundary.ply sample/queries.ply -o '{}/field.ply'
measure flash ngs-joint import/scene.json variance/boundary.ply --method flash -o '{}/labelled.ply'
measure draft ngs-joint import/scene.json variance/boundary.ply --quality draft -o '{}/labelled.ply'
measure standard ngs-joint import/scene.json variance/boundary.ply -o '{}/labelled.ply'
measure render ngs-render import/scene.json flash/labelled.ply --views all --layers mask --scale 0 -o '{}/masks'
measure eval ngs-eval render/masks render/masks -o '{}/metrics.json'
measure extract ngs-extract flash/labelled.ply --object-ply '{}/o.ply' --background-ply '{}/b.ply' --min-component 50
measure extract-sog ngs-extract flash/labelled.ply --object-ply '{}/o.sog' --background-ply '{}/b.sog'
measure clean ngs-clean "$model" -o '{}/cleaned'
measure chain "$pipelines/ngs-gs.sh" "$scene" '{}/out' --model "$model" --masks "$masks" --hold-out every:4:2 --quality draft
measure report ngs-report chain/out -o '{}/report.html'
measure cut ngs cut import/scene.json --quality draft -o '{}/out'
follow orbit ngs-scene orbit "$model" -o '{}/scene.json'
# A box in the middle of the first view.
sed -n '/"views"/{n;s/.*"name":\("[^"]*"\),"width":\([0-9]*\),"height":\([0-9]*\).*/\1 \2 \3/p;q}' \
  import/scene.json > view
read -r name width height < view
printf '{"ngs_prompts": 1, "view": %s, "width": %d, "height": %d, "boxes": [[%d, %d, %d, %d]]}\n' \
  "$name" "$width" "$height" $((width / 3)) $((height / 3)) $((width * 2 / 3)) $((height * 2 / 3)) > box.json
follow mask ngs-mask import/scene.json --prompts box.json -o '{}/masks'
follow fit ngs-fit import/scene.json -o '{}/m.ply' --steps 1000

{
  printf '%-12s %7s %7s %10s %9s %7s %5s\n' case phases signals 'median ms' 'worst ms' MiB left
  sort -t "$(printf '\t')" -k 1,1 -k 5,5n samples | awk -F '\t' '
    function end_case() {
      if (n) printf "%-12s %7d %7d %10d %9d %7d %5d\n", name, phases, n, ms[int((n + 1) / 2)], ms[n], mib, left
      n = phases = mib = left = 0
    }
    $1 != name { end_case(); name = $1 }
    { ms[++n] = $5; left += $8; if ($7 > mib) mib = $7; if (!(($1, $2) in seen)) { seen[$1, $2]; ++phases } }
    END { end_case() }'
} >&2
exit "$failed"
