#!/usr/bin/env bash
# Mutation testing: applies one small change to the sources at a time and runs the tests that should fail.
#   tests/stability/mutants.sh [--applies] [WORD...]
#
#   WORD       only mutants whose line contains one of the words
#   --applies  only lists mutants whose pattern no longer changes its file
#
# Needs a finished build (pipelines/build.sh). A mutant is a changed copy of one header or source that shadows the real
# one. It is compiled with the given tests and linked with the libraries of build/. Prints killed or SURVIVED per mutant;
# exit 1 if a mutant survives, no longer applies or does not compile.
set -uo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$root/build
applies_only=
if [ "${1:-}" = --applies ]; then applies_only=1; shift; fi
words=("$@")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
jobs=${MUTANT_JOBS:-2}
count=0

# Without NGS_WITH_V4, so that a mutant of the compositing loops is not bypassed by the library's AVX-512 kernel.
flags=(-std=c++20 $(pkg-config --cflags eigen3) -O1 -march=x86-64-v3 -ffp-contract=off -fno-math-errno -fopenmp -DDOCTEST_CONFIG_SUPER_FAST_ASSERTS
  "-DNGS_SOURCE_DIR=\"$root\"" "-DNGS_TOOL_DIR=\"$build/bin\"")
libraries=("$build"/tests/libngs_test_support.a "$build"/libngs/libngs_{interactive,eval,edit,methods,passes,cut,field,make,capture,evidence,orbit,render,problem,ops,backend,options,scene,core,os}.a -llz4
  -lopencv_core -lopencv_imgproc
  -Wl,--allow-multiple-definition)  # the mutant's definition is first; the library's batch of files has the original

# run FILE TESTS SOURCES WHAT SED: FILE and SOURCES are below libngs/ngs, TESTS below tests. SOURCES instantiate FILE.
run() {
  local file=$1 tests=$2 sources=$3 what=$4 script=$5 place=$6 inputs=() verdict
  mkdir -p "$place/ngs/$(dirname "$file")"
  sed -E "$script" "$root/libngs/ngs/$file" >"$place/ngs/$file"
  for t in $tests; do inputs+=("$root/tests/$t"); done
  for s in $sources; do
    if [ "$s" = "$file" ]; then inputs+=("$place/ngs/$s"); else inputs+=("$root/libngs/ngs/$s"); fi
  done
  if ! g++ "${flags[@]}" -I"$place" -I"$root/tests" -I"$root/libngs" -I"$build/libngs" "${inputs[@]}" \
    "${libraries[@]}" -o "$place/test" >"$place/log" 2>&1; then
    verdict="NOT COMPILED"
    head -5 "$place/log" >&2
  else
    timeout 300 "$place/test" --minimal --abort-after=1 >"$place/log" 2>&1
    case $? in
      0) verdict=SURVIVED ;;
      124) verdict="TIMED OUT" ;;
      *) verdict=killed ;;  # a failed check, or a crash
    esac
  fi
  printf '%-12s %-26s %s\n' "$verdict" "$file" "$what"
  rm -rf "$place"
}

# applies FILE SED
applies() { ! sed -E "$2" "$root/libngs/ngs/$1" | cmp -s - "$root/libngs/ngs/$1"; }

# mutant FILE TESTS SOURCES WHAT SED
mutant() {
  local word wanted=$((${#words[@]} == 0))
  for word in "${words[@]}"; do [[ "$*" != *"$word"* ]] || wanted=1; done
  [ "$wanted" = 1 ] || return 0
  count=$((count + 1))
  if ! applies "$1" "$5"; then
    printf 'NOT APPLIED  %-26s %s\n' "$1" "$4" >>"$work/verdicts"
    return
  fi
  [ -z "$applies_only" ] || return 0
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n; done
  run "$@" "$work/$count" >>"$work/verdicts" &
}

suites="stability grad emulated"
if [ -n "$applies_only" ]; then suites=; fi
for suite in $suites; do
  "$build/bin/test_$suite" --minimal >"$work/log" 2>&1 || { echo "test_$suite fails without a mutant" >&2; exit 1; }
done
touch "$work/verdicts"
source "$root/tests/stability/mutants_list.sh"
wait
sort "$work/verdicts"
if [ -n "$applies_only" ]; then [ ! -s "$work/verdicts" ]; exit; fi
killed=$(grep -c '^killed' "$work/verdicts")
echo "mutants: $count, killed: $killed"
[ "$killed" -eq "$count" ]
