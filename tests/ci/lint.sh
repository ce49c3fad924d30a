#!/usr/bin/env bash
# Holds changed source files against .clang-format and .clang-tidy:
#   tests/ci/lint.sh [--base COMMIT] [--most N] [--libcxx] [FILE...]
# Without FILE: what has changed since COMMIT (default: where this branch left origin/main, else HEAD~1), committed or not.
# clang-tidy needs compile_commands.json in build/ (pipelines/build.sh makes it), and takes some seconds a file: --most
# looks at N of them, evenly chosen, and says so. --libcxx has clang compile them with libc++ instead, code generation left
# out: a warning is a finding. Exit code 1: something was found; 77: nothing was, but a part was
# skipped because a program, that file or the commit is absent.
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
    *) fail 2 "$1: no C++ or CUDA source" "shellcheck -x reads shell scripts" ;;
  esac
done
[[ $most =~ ^[0-9]+$ ]] || fail 2 "--most $most: expected a number"
cd "$top"
if [ ${#files[@]} -eq 0 ]; then
  base=${base:-$(git merge-base origin/main HEAD 2> /dev/null || echo HEAD~1)}
  git rev-parse --quiet --verify "$base^{commit}" > /dev/null ||
    { say "skipped: $base is not a commit of this checkout, there is nothing to compare with"; exit 77; }
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

compiled=()  # device code needs nvcc
for file in "${files[@]}"; do
  case $file in *.h | *.cpp) compiled+=("$file") ;; esac
done
if [ "$most" -gt 0 ] && [ ${#compiled[@]} -gt "$most" ]; then
  say "clang looks at $most of ${#compiled[@]} files"
  for ((i = 0; i < most; ++i)); do compiled[i]=${compiled[i * ${#compiled[@]} / most]}; done
  compiled=("${compiled[@]:0:most}")
fi
program=clang-tidy
if [ -n "$libcxx" ]; then program=clang-check; fi
if ! command -v "$program" > /dev/null; then
  skip "$program is not installed"
elif [ ! -e build/compile_commands.json ]; then
  skip "build/compile_commands.json is absent"
elif [ -n "$libcxx" ]; then
  headers=$(find /usr/lib/llvm-*/include/c++ /usr/include/c++ -maxdepth 1 -name v1 2> /dev/null | sort -V | tail -n 1)
  [ -n "$headers" ] || fail 8 "libc++ is not installed" "Debian: apt-get install libc++-dev"
  # As libngs/cmake/NgsFlags.cmake has it for clang; the database was written for g++.
  flags=(-nostdinc++ -isystem "$headers" -Werror -Wno-sign-conversion -Wno-bitwise-instead-of-logical
    -Wno-unknown-warning-option -Wno-unused-command-line-argument -Wno-ignored-optimization-argument)
  sources=()  # a header is compiled by what includes it
  for file in "${compiled[@]}"; do case $file in *.cpp) sources+=("$file") ;; esac; done
  printf '%s\0' "${sources[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-check -p build "${flags[@]/#/--extra-arg=}" || code=1
elif [ ${#compiled[@]} -gt 0 ]; then
  # A file's own lines alone are checked, and what g++ does not warn of is no finding.
  printf '%s\0' "${compiled[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build --quiet --header-filter='^$' \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-sign-conversion \
    --extra-arg=-Wno-bitwise-instead-of-logical || code=1
fi
[ "$code" -ne 0 ] || code=$skipped
exit "$code"
