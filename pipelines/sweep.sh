#!/usr/bin/env bash
# Series of runs of ngs-gs.sh, on one machine or on a cluster. A second call starts only unfinished runs.
#
#   pipelines/sweep.sh RUNS OUT [--on here|make|parallel|slurm] [-j N] [--retries R] [--sbatch FLAGS] [--no-wait] [-n]
#
#   RUNS             one run per line: NAME SCENE_DIR [..._FLAGS=...] [options of ngs-gs.sh], quoted as for the shell
#   OUT              OUT/NAME/ per run; report.html and summary.json compare runs with scores; .sweep/ is the state of the series
#   --on here        one run after the other                              (default)
#        make        make -j N
#        parallel    GNU parallel -j N
#        slurm       array jobs with at most N tasks at a time, then a job that restarts lost runs and finally
#                    compares all
#   -j N             runs at once                                         (default: 1; slurm: no bound)
#   --retries R      restarts of a run that was killed or lacked disk or memory                    (default: 3)
#   --sbatch FLAGS   further flags of sbatch: '--partition long --mem 4G --cpus-per-task 8'
#   --no-wait        slurm: return after submitting; OUT/.sweep/ended is written at the end with the exit code
#   -n, --dry-run    print the runs that would start
#
# Exit code 1 if a run failed; runs with exit codes 2 to 7 or 70 are not repeated until their line changes. The exit code of
# ngs-report if only the comparison failed.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "${NGS_PIPELINES:-$(dirname "$0")}/common.sh"
script=$pipelines/sweep.sh

# Parses line $1 of RUNS into run_name, run_scene, run_flags (NAME_FLAGS=...) and run_options.
read_run() {
  local words word line
  line=$(sed -n "${1}p" "$runs")
  eval "words=($line)"
  run_name=${words[0]:-} run_scene=${words[1]:-} run_flags=() run_options=()
  for word in "${words[@]:2}"; do
    if [[ $word =~ ^[A-Z]+_FLAGS= ]]; then run_flags+=("$word"); else run_options+=("$word"); fi
  done
  [[ $run_name =~ ^[A-Za-z0-9_][A-Za-z0-9._@+=-]*$ ]] || fail 2 "$runs:$1: '$run_name' is not a valid run name"
  [ -n "$run_scene" ] || fail 2 "$runs:$1: expected NAME SCENE_DIR"
}

# Checks RUNS before the first start: invalid lines, duplicate names, unknown variables.
check_runs() {
  local line flag names=' '
  for line in $(lines_of_runs); do
    read_run "$line"
    case $names in *" $run_name "*) fail 2 "$runs:$line: duplicate run name '$run_name'" "give every line a unique name" ;; esac
    names+="$run_name "
    for flag in "${run_flags[@]}"; do
      [[ ${flag%%=*} =~ ^(SCENE|VARIANCE|SAMPLE|RBF|JOINT|EXTRACT|RENDER|EVAL)_FLAGS$ ]] ||
        fail 2 "$runs:$line: ${flag%%=*} is not used by any run" "see the variables in $pipelines/ngs-gs.sh --help"
    done
  done
}

lines_of_runs() { grep -nEv '^[[:space:]]*(#|$)' "$runs" | cut -d: -f1; }
checksum_of() { sed -n "${1}p" "$runs" | cksum; }

# Final exit code of the run of line $1; empty if it must (still) run.
code_of() {
  local code key
  read_run "$1"
  if [ -f "$state/$run_name.code" ] && read -r code key < "$state/$run_name.code" && [ "$key" = "$(checksum_of "$1")" ]; then
    printf '%s' "$code"
  fi
}

pending_lines() {
  local line
  for line in $(lines_of_runs); do
    if [ -z "$(code_of "$line")" ]; then printf '%s\n' "$line"; fi
  done
}

# Runs line $1. Stores final exit codes; after 8 (disk, memory) and after signals the run is tried again.
task() {
  local code=0
  read_run "$1"
  env "${run_flags[@]}" "$pipelines/ngs-gs.sh" "$run_scene" "$out/$run_name" -q "${run_options[@]}" || code=$?
  printf '%s %s %s %s\n' "$run_name" "$code" "${SLURMD_NODENAME:-$HOSTNAME}" "${SLURM_RESTART_COUNT:-0}" >> "$state/tries"
  if [ "$code" -ne 8 ] && [ "$code" -lt 128 ]; then
    printf '%s %s\n' "$code" "$(checksum_of "$1")" > "$state/$run_name.new-$$-$HOSTNAME"
    mv "$state/$run_name.new-$$-$HOSTNAME" "$state/$run_name.code"
  fi
  return "$code"
}

# Compares finished runs, prints failed ones; returns the exit code of the series.
finish() {
  local line code finished=() failed=0 compared=0 output
  for line in $(lines_of_runs); do
    code=$(code_of "$line")
    read_run "$line"
    case $code in
      0 | 1) if [ -f "$out/$run_name/metrics.json" ]; then finished+=("$out/$run_name"); fi ;;
      *) failed=$((failed + 1)); say "$run_name failed${code:+ with exit code $code}" ;;
    esac
  done
  if [ ${#finished[@]} -gt 0 ]; then  # print output only on failure: the table is long
    output=$(compare_runs "$out" "${finished[@]}" 2>&1) || { compared=$?; say "$output"; }
  fi
  say "$(($(lines_of_runs | wc -l) - failed)) of $(lines_of_runs | wc -l) runs are finished, $(wc -l < "$state/tries") tries"
  [ "$failed" -eq 0 ] || return 1
  return "$compared"
}

# One round over the lines on stdin, on this machine.
round_here() { while read -r line; do "$script" --task "$line" "$runs" "$out" || true; done; }
round_parallel() { parallel -j "$jobs" -q "$script" --task {} "$runs" "$out" || true; }
round_make() {
  local makefile=$state/Makefile.$$
  {
    printf 'SHELL := bash\n.PHONY: all\nall:'
    sed 's/^/ line-/' | tr -d '\n'
    printf '\nline-%%:\n\t@'
    printf '%q --task LINE %q %q\n' "$script" "$runs" "$out" | sed 's/\$/$$/g; s/ --task LINE / --task $* /'
  } > "$makefile"
  env -u MAKEFLAGS make -k -j "$jobs" --no-print-directory -f "$makefile" || true
  rm "$makefile"
}

# Submits the lines on stdin as arrays of at most MaxArraySize tasks, and a dependent gather job.
submit() {
  local round=$1 most list first=0 count size ids=''
  most=$(scontrol show config | awk '$1 == "MaxArraySize" { print $3 }')
  list=$(mktemp "$state/pending-$round-XXXXXX")
  cat > "$list"
  count=$(wc -l < "$list")
  while [ "$first" -lt "$count" ]; do
    size=$((count - first < most ? count - first : most))
    ids+=:$(sbatch_job --array="0-$((size - 1))${limit:+%$limit}" --output="$state/log/%A_%a" <<< \
      "$(printf 'exec %q --array-task "$((SLURM_ARRAY_TASK_ID + %d))" %q %q %q' "$script" "$first" "$list" "$runs" "$out")")
    first=$((first + size))
  done
  sbatch_job --dependency="afterany$ids" --output="$state/log/gather-$round" > /dev/null <<< \
    "$(printf 'exec %q --gather %d %q %q --retries %d -j %q --sbatch %q' "$script" "$round" "$runs" "$out" "$retries" "${limit:-0}" "$flags")"
}

# Submits the script on stdin; prints the job id. Slurm requeues the job if its node is lost.
sbatch_job() {
  # shellcheck disable=SC2086  # flags are words
  { printf '#!/bin/bash\nexport NGS_PIPELINES=%q\n' "$pipelines"; cat; } |
    sbatch --parsable --requeue --open-mode=append --job-name=ngs-sweep $flags "$@"
}

mode=series line='' list='' round=0
case ${1:-} in
  -h | --help) usage_of "$0"; exit 0 ;;
  --task) mode=task line=$2; shift 2 ;;
  --array-task) mode=task line=$(sed -n "$(($2 + 1))p" "$3"); shift 3 ;;
  --gather) mode=gather round=$2; shift 2 ;;
esac
[ $# -ge 2 ] || fail 2 "expected RUNS OUT" "see $0 --help"
[ -f "$1" ] || fail 3 "$1: no such file"
runs=$(realpath "$1") out=$2
shift 2
on=here jobs='' retries=3 flags='' wait=1 dry_run=''
while [ $# -gt 0 ]; do
  case $1 in
    --no-wait) wait=; shift; continue ;;
    -n | --dry-run) dry_run=1; shift; continue ;;
  esac
  [ $# -ge 2 ] || fail 2 "$1: unknown, or no value given" "see $0 --help"
  case $1 in
    --on) on=$2 ;;
    -j) jobs=$2 ;;
    --retries) retries=$2 ;;
    --sbatch) flags=$2 ;;
    *) fail 2 "unknown option $1" "see $0 --help" ;;
  esac
  shift 2
done
limit=${jobs#0} jobs=${jobs:-1}
case $on in
  here) ;;
  make | parallel) command -v "$on" > /dev/null || fail 8 "--on $on: not found" "install it, or run --on here" ;;
  slurm) command -v sbatch > /dev/null || fail 8 "--on slurm: sbatch: not found" "run this on a node that can submit jobs" ;;
  *) fail 2 "--on $on: expected here, make, parallel or slurm" ;;
esac
mkdir -p "$out/.sweep/log" || fail 8 "$out: cannot be created"
out=$(cd "$out" && pwd) state=$out/.sweep
touch "$state/tries"

case $mode in
  task) task "$line"; exit ;;
  gather)
    if [ "$round" -lt "$retries" ] && [ -n "$(pending_lines)" ]; then
      pending_lines | submit $((round + 1))
      exit 0
    fi
    code=0
    finish || code=$?
    printf '%s\n' "$code" > "$state/ended.new"
    mv "$state/ended.new" "$state/ended"
    exit 0 ;;
esac

check_runs
if [ -n "$dry_run" ]; then
  for line in $(pending_lines); do read_run "$line"; printf '%s\n' "$run_name"; done
  exit 0
fi
if [ "$on" = slurm ]; then
  rm -f "$state/ended"
  pending_lines | submit 0
  if [ -z "$wait" ]; then exit 0; fi
  while [ ! -f "$state/ended" ]; do sleep 1; done
  cat "$(find "$state/log" -name 'gather-*' -printf '%T@ %p\n' | sort -n | tail -n 1 | cut -d' ' -f2-)" >&2
  exit "$(cat "$state/ended")"
fi
while [ "$round" -le "$retries" ] && [ -n "$(pending_lines)" ]; do
  pending_lines | "round_$on"
  round=$((round + 1))
done
finish
