#!/usr/bin/env bash
# Checks changed source files with .clang-format and .clang-tidy:
#   tests/ci/lint.sh [--base COMMIT] [--most N] [--libcxx] [FILE...]
# Without FILE: files changed since COMMIT (default: merge base with origin/main, or HEAD~1), committed or not.
# clang-tidy needs build/ (made by pipelines/build.sh), configures build/lint, which compiles every file by itself, and takes
# some seconds per file; --most checks N files, evenly chosen, and prints that. --libcxx compiles them with clang and libc++
# instead, without code generation; warnings are findings. Exit code 1: findings; 77: no findings, but a part was skipped
# because a program, compile_commands.json or the commit is missing.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

base="" most=0 libcxx="" files=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    --base) base=${2:?--base: a commit is missing}; shift 2 ;;
    --most) most=${2:?--most: a number is missing}; shift 2 ;;
    --libcxx) libcxx=1; shift ;;
    -*) fail 2 "$1: no such option" "$0 --help" ;;
    *.h | *.cpp | *.cu | *.cuh) files+=("$(realpath "$1")"); shift ;;
    *) fail 2 "$1: not a C++ or CUDA source" "use shellcheck -x for shell scripts" ;;
  esac
done
[[ $most =~ ^[0-9]+$ ]] || fail 2 "--most $most: expected a number"
cd "$top"
if [ ${#files[@]} -eq 0 ]; then
  base=${base:-$(git merge-base origin/main HEAD 2> /dev/null || echo HEAD~1)}
  git rev-parse --quiet --verify "$base^{commit}" > /dev/null ||
    { say "skipped: $base is not a commit of this checkout"; exit 77; }
  mapfile -t files < <(
    git diff --name-only --diff-filter=d "$base" -- '*.h' '*.cpp' '*.cu' '*.cuh'
    git ls-files --others --exclude-standard -- '*.h' '*.cpp' '*.cu' '*.cuh'
  )
fi
[ ${#files[@]} -gt 0 ] || { say "no source file has changed"; exit 0; }

code=0 skipped=0
skip() { say "skipped: $1"; skipped=77; }

if command -v clang-format > /dev/null; then
  clang-format --dry-run -Werror "${files[@]}" || code=1
else
  skip "clang-format is not installed"
fi

compiled=()  # .cu needs nvcc
for file in "${files[@]}"; do
  case $file in
    *_neon.h | *_windows.cpp | *_web.cpp | */web/* | *tests/windows/*) ;;  # for another processor or system
    *.h | *.cpp) compiled+=("$file") ;;
  esac
done
if [ "$most" -gt 0 ] && [ ${#compiled[@]} -gt "$most" ]; then
  say "clang checks $most of ${#compiled[@]} files"
  for ((i = 0; i < most; ++i)); do compiled[i]=${compiled[i * ${#compiled[@]} / most]}; done
  compiled=("${compiled[@]:0:most}")
fi
program=clang-tidy
if [ -n "$libcxx" ]; then program=clang-check; fi
if ! command -v "$program" > /dev/null; then
  skip "$program is not installed"
elif [ ! -e build/compile_commands.json ]; then
  skip "build/compile_commands.json is missing"
elif ! cmake -S . -B build/lint -G Ninja -DNGS_UNITY=OFF -DNGS_WITH_CUDA=OFF > build/lint.log 2>&1; then
  fail 8 "a build without batches cannot be configured" "see build/lint.log"
elif [ -n "$libcxx" ]; then
  headers=$(find /usr/lib/llvm-*/include/c++ /usr/include/c++ -maxdepth 1 -name v1 2> /dev/null | sort -V | tail -n 1)
  [ -n "$headers" ] || fail 8 "libc++ is not installed" "Debian: apt-get install libc++-dev"
  # Flags of libngs/cmake/NgsFlags.cmake for clang; the database was written for g++.
  flags=(-nostdinc++ -isystem "$headers" -Werror -Wno-sign-conversion -Wno-bitwise-instead-of-logical
    -Wno-unknown-warning-option -Wno-unused-command-line-argument -Wno-ignored-optimization-argument)
  sources=()  # headers are compiled by including files
  for file in "${compiled[@]}"; do case $file in *.cpp) sources+=("$file") ;; esac; done
  printf '%s\0' "${sources[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-check -p build/lint "${flags[@]/#/--extra-arg=}" || code=1
elif [ ${#compiled[@]} -gt 0 ]; then
  # Check only the file itself, and only warnings that g++ has too.
  printf '%s\0' "${compiled[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/lint --quiet --header-filter='^$' \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-sign-conversion --extra-arg=-Wcomma \
    --extra-arg=-Wno-bitwise-instead-of-logical || code=1
fi
[ "$code" -ne 0 ] || code=$skipped
exit "$code"
