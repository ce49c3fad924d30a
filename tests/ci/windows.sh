#!/usr/bin/env bash
# Compiles the operating-system code for Windows with Debian's g++-mingw-w64-x86-64-posix and runs its tests under Wine:
#
#   tests/ci/windows.sh [OUT]     OUT: folder for the program and Wine's files (default: build-windows)
#
# Exit code 77: skipped, as the compiler or Wine is absent. windows-archive.sh tests the tools.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
compiler=x86_64-w64-mingw32-g++-posix wine=''
if ! command -v $compiler > /dev/null; then
  say "skipped: no $compiler (Debian: g++-mingw-w64-x86-64-posix)"
  exit 77
fi
for name in wine64 wine; do if command -v $name > /dev/null; then wine=$name; fi; done
if [ -z "$wine" ]; then say "skipped: no wine (Debian: wine64)"; exit 77; fi

cd "$top"
out=${1:-build-windows}
mkdir -p "$out/include"
ln -sfn /usr/include/doctest "$out/include/doctest"
flags=(-std=c++20 -O1 -march=x86-64-v3 -Wall -Wextra -Wconversion -Werror "-Wa,-muse-unaligned-vector-move"
  -D_WIN32_WINNT=0x0A00 -D__USE_MINGW_ANSI_STDIO=1 -DNOMINMAX -Ilibngs -Itools -Itests -isystem "$out/include")
objects=() jobs=()
for source in libngs/ngs/os/*_windows.cpp tools/shared/os/*_windows.cpp tools/shared/os/start/utf8_windows.cpp \
  libngs/ngs/core/monitor.cpp libngs/ngs/io/files/{atomic_file,mapped_file,unfinished_files}.cpp \
  tools/shared/run/{child_process,line_program,signals}.cpp tests/windows/windows_test.cpp; do
  objects+=("$out/$(basename "$source").o")
  $compiler "${flags[@]}" -c "$source" -o "${objects[-1]}" &
  jobs+=($!)
  if [ $((${#jobs[@]} % $(nproc))) = 0 ]; then wait "${jobs[-1]}"; fi
done
for job in "${jobs[@]}"; do wait "$job"; done
x86_64-w64-mingw32-windres tools/shared/os/start/manifest.rc "$out/manifest.o"
$compiler -static "${objects[@]}" "$out/manifest.o" -lws2_32 -o "$out/windows_test.exe"
WINEPREFIX=$(cd "$out" && pwd)/wine WINEARCH=win64 WINEDEBUG=-all $wine "$out/windows_test.exe"
