#!/usr/bin/env bash
# Tests that series of runs survive faults of a cluster. On a bare Debian machine, installs missing packages (Slurm, munge,
# GNU parallel), builds, and starts Slurm with four virtual nodes on the loopback device. Runs one sweep of 48 runs serially,
# with make -j, with GNU parallel and as array jobs; then again as array jobs while a node is killed, a task gets SIGKILL and
# the disk of another task is full. All final artifacts must have equal hashes. Prints one table at the end.
#
#   tests/ci/slurm-test.sh [TABLE_FILE] [--no-setup]
#
# Needs root (to install packages and mount small tmpfs). All files are in one temporary folder, which is removed at the end
# together with the daemons, also on failure. Exit code 1 if any hash differs.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/ci/slurm-cluster.sh
. "$top/tests/ci/slurm-cluster.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
table='' setup=1
for argument; do
  case $argument in
    --no-setup) setup= ;;
    *) table=$argument ;;
  esac
done
[ "$(id -u)" -eq 0 ] || fail 8 "needs root" "in a container or a virtual machine: sudo tests/ci/slurm-test.sh"
if [ -n "$setup" ]; then
  "$pipelines/setup.sh"
  "$pipelines/build.sh"
fi
cluster_install
bin=$(find_bin)
export NGS_BIN=$bin NGS_THREADS=1 SAMPLE_FLAGS='--rows 16 --cols 16'
cores=$(nproc)

scratch=$(mktemp -d "${TMPDIR:-/tmp}/ngs-slurm-XXXXXX")
shared=$scratch/shared
cleanup() {
  local code=$?
  trap - EXIT INT TERM HUP
  if [ -n "${watcher:-}" ]; then kill "$watcher" 2> /dev/null || true; fi
  cluster_stop
  umount "$shared/faults/$full_run" 2> /dev/null || true
  umount "$shared" 2> /dev/null || umount -l "$shared" 2> /dev/null || true
  rm -rf "$scratch"
  exit "$code"
}
full_run=cut-sa3d-0.6-0 killed_run=spheres-ngs-0.4-2 lost_node=n3  # targets of the three faults
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
mkdir "$shared"
mount -t tmpfs -o size=768m ngs-shared "$shared"  # the file system that the nodes share

rows=()
row() { rows+=("$(printf '| %s | %s | %s | %s | %s |' "$1" "$2" "$3" "$(cut -d' ' -f1 /proc/loadavg)" "$4")"); }

# hashes_of FOLDER: hashes of artifacts that must not depend on the schedule; other files contain times.
hashes_of() {
  (cd "$1" && find . -path ./.sweep -prune -o -type f \
    \( -name '*.ply' -o -name '*.png' -o -name scene.json -o -name 'metrics*.json' \) -print0 |
    LC_ALL=C sort -z | xargs -0 sha256sum)
}

# compare_with_serial NAME FOLDER SECONDS: compares with the serial runs, adds a row.
failures=0
compare_with_serial() {
  local same=equal
  hashes_of "$2" > "$scratch/hashes"
  if ! cmp -s "$scratch/hashes" "$scratch/serial"; then same=DIFFERENT failures=$((failures + 1)); fi
  if [ -n "$(find "$2" -name '.ngs-*')" ]; then same="$same, LEFTOVERS" failures=$((failures + 1)); fi
  row "$1" "$(awk -v s="$3" 'BEGIN { printf "%.0f s, %.2f runs/s", s, 48 / s }')" \
    "$(awk -v s="$3" -v t="$serial_s" 'BEGIN { printf "%.2f", t / s }')" "$same ($(wc -l < "$scratch/hashes") files)"
}

now() { date +%s.%N; }
since() { awk -v a="$1" -v b="$(now)" 'BEGIN { print b - a }'; }

# sweep FOLDER OPTIONS: executes the 48 runs; sets `seconds`.
sweep() {
  local begin
  begin=$(now)
  "$pipelines/sweep.sh" "$shared/runs" "$shared/$1" "${@:2}"
  seconds=$(since "$begin")
}

say "== two scenes, 48 runs"
for recipe in two-spheres torus-box; do
  "$bin/ngs-synth" "$recipe" -o "$shared/$recipe" --view-count 8 --width-px 96 --height-px 72 --fit-steps 150 --fit-max-gaussians 1500 \
    --mask-noise jitter:1 -q > /dev/null
done
for scene in spheres=two-spheres cut=torus-box; do
  for method in flash bce sa3d ngs; do
    for tau in 0.4 0.6 0.8; do
      for held in 0 2; do
        printf '%s-%s-%s-%s %q VARIANCE_FLAGS="--tau %s" --hold-out every:4:%s --method %s --quality draft\n' \
          "${scene%=*}" "$method" "$tau" "$held" "$shared/${scene#*=}" "$tau" "$held" "$method"
      done
    done
  done
done > "$shared/runs"
killed_task=$(($(grep -n "^$killed_run " "$shared/runs" | cut -d: -f1) - 1))

say "== serial"
sweep serial
serial_s=$seconds
hashes_of "$shared/serial" > "$scratch/serial"
row "serial" "$(awk -v s="$serial_s" 'BEGIN { printf "%.0f s, %.2f runs/s", s, 48 / s }')" 1 "the reference"

say "== make -j $cores"
sweep make --on make -j "$cores"
compare_with_serial "make -j $cores" "$shared/make" "$seconds"
say "== GNU parallel -j $cores"
sweep parallel --on parallel -j "$cores"
compare_with_serial "GNU parallel -j $cores" "$shared/parallel" "$seconds"

say "== two series at once on one folder"
begin=$(now)
"$pipelines/sweep.sh" "$shared/runs" "$shared/twice" --on make -j "$cores" 2> /dev/null &
"$pipelines/sweep.sh" "$shared/runs" "$shared/twice" --on parallel -j "$cores" 2> /dev/null || true
wait $!
compare_with_serial "make and parallel at once on one folder" "$shared/twice" "$(since "$begin")"

say "== Slurm, four nodes"
cluster_start "$scratch/cluster"
sweep slurm --on slurm
compare_with_serial "Slurm array, 4 nodes" "$shared/slurm" "$seconds"

say "== the same with a node killed, a task killed and a full disk"
mkdir -p "$shared/faults/$full_run"
mount -t tmpfs -o size=64k ngs-full "$shared/faults/$full_run"
events=$scratch/events
touch "$events"
faults() {
  local pids seen_node='' seen_task='' seen_disk=''
  while [ -z "$seen_node" ] || [ -z "$seen_task" ] || [ -z "$seen_disk" ]; do
    sleep 0.05
    if [ -z "$seen_task" ]; then
      mapfile -t pids < <(processes_with "SLURM_CONF=$cluster/slurm.conf" "SLURM_ARRAY_TASK_ID=$killed_task")
      if [ -f "$shared/faults/$killed_run/boundary.ply" ] && kill -KILL "${pids[@]}" 2> /dev/null; then
        seen_task=1
        echo "task $killed_task ($killed_run): its ${#pids[@]} processes got SIGKILL" >> "$events"
      fi
    fi
    if [ -z "$seen_node" ] && [ "$(wc -l < "$shared/faults/.sweep/tries" 2> /dev/null || echo 0)" -ge 14 ] &&
      [ "$(squeue -h -t R -w "$lost_node" | wc -l)" -gt 0 ]; then
      echo "node $lost_node: killed after $(wc -l < "$shared/faults/.sweep/tries") tries, with task $(squeue -h -t R -w "$lost_node" -o %K) on it" >> "$events"
      node_kill "$lost_node"
      seen_node=1
    fi
    if [ -z "$seen_disk" ] && grep -qs "^$full_run 8 " "$shared/faults/.sweep/tries"; then
      mount -o remount,size=32m "$shared/faults/$full_run"
      echo "disk of $full_run: full at 64 KiB, exit code 8; made larger" >> "$events"
      seen_disk=1
    fi
  done
  # Slurm delays requeued jobs of a lost node; start them now, as an administrator would.
  while sleep 1; do
    for job in $(squeue -h -t PD -o '%i %r' | awk '$2 == "BeginTime" { print $1 }'); do
      scontrol update jobid="$job" StartTime=now 2> /dev/null || true
    done
  done
}
faults &
watcher=$!
sweep faults --on slurm
kill "$watcher" && watcher=
compare_with_serial "Slurm array with the three faults" "$shared/faults" "$seconds"
tries=$(wc -l < "$shared/faults/.sweep/tries")
for event in '^node ' '^task ' '^disk '; do
  grep -q "$event" "$events" || { say "the fault '$event' did not happen"; failures=$((failures + 1)); }
done

say "== each stage a job step"
begin=$(now)
mkdir "$shared/steps"
while read -r name scene; do
  eval "$(sed -n "s/^$name .* \(VARIANCE_FLAGS=\"[^\"]*\"\) .*\(--hold-out [^ ]* --method [a-z0-9]*\) .*/export \1 options='\2'/p" "$shared/runs")"
  # shellcheck disable=SC2086,SC2154  # options is several words
  NGS_RUN='srun -Q -n1 -c1' "$pipelines/ngs-gs.sh" "$scene" "$shared/steps/$name" --quality draft -q $options &
done << RUNS
spheres-flash-0.6-2 $shared/two-spheres
cut-ngs-0.4-0 $shared/torus-box
RUNS
wait
seconds=$(since "$begin")
unset VARIANCE_FLAGS options
hashes_of "$shared/steps" > "$scratch/hashes"
same=equal
if [ "$(grep -cxFf "$scratch/serial" "$scratch/hashes")" -ne "$(wc -l < "$scratch/hashes")" ] || ! [ -s "$scratch/hashes" ]; then
  same=DIFFERENT failures=$((failures + 1))
fi
row "ngs-gs.sh with NGS_RUN='srun', 2 runs" "$(printf '%.0f s' "$seconds")" "" "$same ($(wc -l < "$scratch/hashes") files)"

say "== evidence of one scene in 5 shards"
begin=$(now)
make -s -f "$pipelines/sharded.mk" submit SCENE_JSON="$shared/serial/cut-flash-0.6-0/scene.json" OUT="$shared/sharded.ply" SHARDS=5 > /dev/null
same=equal
if ! cmp -s "$shared/sharded.ply" "$shared/serial/cut-flash-0.6-0/boundary.ply"; then same=DIFFERENT failures=$((failures + 1)); fi
row "ngs-variance in 5 array tasks, merged" "$(printf '%.0f s' "$(since "$begin")")" "" "$same (boundary.ply)"

{
  echo "| 48 runs of the whole chain, $cores cores | time | times serial | load at its end | artifacts against serial |"
  echo "|---|---|---|---|---|"
  printf '%s\n' "${rows[@]}"
  echo
  cat "$events"
  awk '$4 > 0 { print "task " $1 ": requeued by Slurm, done on " $3 }' "$shared/faults/.sweep/tries"
  echo "$tries tries ended, $(awk '$2 == 0' "$shared/faults/.sweep/tries" | wc -l) of them successfully"
} | tee ${table:+"$table"}
[ "$failures" -eq 0 ]
