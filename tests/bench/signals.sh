#!/usr/bin/env bash
# How long every tool goes on after SIGTERM and SIGINT, in every phase of its work:
#   tests/bench/signals.sh SCENE_DIR MASKS_DIR OUT_DIR [CASE...]
# SCENE_DIR: a capture as pipelines/ngs-gs.sh takes it; SCENE_FLAGS: as for that script. CASE: a name of the list below;
# default: all. Held out is every:4:2.
# Each case first runs as a whole, into OUT_DIR/CASE, where later cases find it and the next call too; its report says
# which phases there are. Then it runs once for each phase that is a thirtieth of its work or more, and for the first and
# the last tenth of the whole, and is sent a signal in the middle of it: at the CPU time at which the whole run was there,
# so that other load on the machine does not matter. SIGTERM goes to the process, as a scheduler sends it, and SIGINT to
# its group, as a terminal does.
# A line each, divided by tabs, on stdout and in OUT_DIR/samples: case, phase, signal, CPU s before it, ms until every
# process of the run has ended, exit code, MiB, unfinished files that it left. Then a table on stderr.
# Exit code 1 where one took more than a second, ended with another code than the signal's or left a file.
#   NGS_SIGNALS_MOST=N     at most N signals a case: first and last tenth, then the phases that take longest; default: all
#   NGS_SIGNALS_CAP_S=12   CPU s after which the cases orbit, mask and fit, more of the same, are not followed further
# The tools come from $NGS_BIN, else from the build folder.
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
# Whatever its name; of several the trainers' own.
model=$(find "$scene" -maxdepth 1 -regextype egrep -regex '.*\.(ply|spz|sog|splat|ksplat)' |
  awk '{ print ($0 ~ /\/point_cloud[^\/]*$/ ? 0 : 1) "\t" $0 }' | LC_ALL=C sort | head -n 1 | cut -f 2)
[ -n "$model" ] || fail 3 "$scene: no model" "a splat that ngs-scene import reads"
scene_flags=()
eval "scene_flags=(${SCENE_FLAGS:-})"
ticks=$(getconf CLK_TCK)
[ -f samples ] || : > samples

# CPU time of process $1, of its children and of those that they have waited for is added to `used`, in ticks.
add_ticks() {
  local rest fields child children=''
  { read -r rest < "/proc/$1/stat"; } 2> /dev/null || return 0
  read -ra fields <<< "${rest##*) }"  # from the state on
  used=$((used + fields[11] + fields[12] + fields[13] + fields[14]))
  { read -r children < "/proc/$1/task/$1/children"; } 2> /dev/null || true
  for child in $children; do add_ticks "$child"; done
}

# Whether a process of session $1 is left.
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

# start FOLDER COMMAND...: in a session of its own, with the folder for {}; its process is `pid`.
start() {
  local folder=$1 word words=()
  shift
  for word in "$@"; do words+=("${word//\{\}/$folder}"); done
  case ${words[0]} in */*) ;; *) words[0]=${bin:+$bin/}${words[0]} ;; esac
  rm -rf "$folder" && mkdir "$folder"
  setsid env --default-signal=INT,QUIT "${words[@]}" > "$folder.out" 2> "$folder.err" &
  pid=$!
}

# phases REPORT: a line for each part of the work: CPU s at its middle, its share of the whole, its name.
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
      # A part is a child of the whole, or of such a child; what lies between counts as before it.
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

# sample NAME PHASE AT_S COMMAND...: one run, ended at that CPU time.
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
  if [ "$code" -eq 0 ]; then return; fi  # it had ended
  while any_left "$pid"; do took=$(($(now_ms) - began)); done
  left=$(find work -name '.ngs-*.tmp*' | wc -l)
  printf '%s\t%s\t%s\t%s\t%d\t%d\t%s\t%d\n' \
    "$name" "$phase" "$signal" "$3" "$took" "$code" "${memory:-0}" "$left" | tee -a samples
  case $signal$code in TERM143 | INT130) ;; *) failed=1 ;; esac
  if [ "$took" -gt 1000 ] || [ "$left" -gt 0 ]; then failed=1; fi
}

# measure NAME COMMAND...: {} is the folder of its outputs.
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

# follow NAME COMMAND...: as measure, for what takes long and is more of the same; from the cap on nothing is asked.
follow() {
  local name=$1 share
  shift
  if [ -n "$only" ] && [[ " $only " != *" $name "* ]]; then return; fi
  sed -i "/^$name\t/d" samples
  for share in 0.02 0.1 0.3 0.6 1; do
    sample "$name" "" "$(awk -v c="$cap" -v s="$share" 'BEGIN { print c * s }')" "$@"
  done
}

# chain_report FOLDER: its tools, as a report of one tool has its stages.
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
measure extract ngs-extract flash/labelled.ply --object '{}/o.ply' --background '{}/b.ply' --min-component 50
measure extract-sog ngs-extract flash/labelled.ply --object '{}/o.sog' --background '{}/b.sog'
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
