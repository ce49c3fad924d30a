#!/usr/bin/env bash
# Tests the archive of pipelines/bundle/windows.sh under Wine, unpacked into a folder with a blank, an umlaut and Chinese in
# its name:
#
#   tests/ci/windows-archive.sh [DIR] [--contract REGEX]
#
#   DIR                where the archive is (default: build-bundle)
#   --contract REGEX   also runs the contract cases whose "FILE: NAME" matches, as build/bin/test_contract does; '' for all.
#                      Needs build/bin/test_contract, and build-windows-program/ that windows.sh leaves in this checkout
#
# A line per check: ok, FAIL or SKIP. Exit code 1 if a check failed, 77 without Wine. Files that differ from those of Linux are
# listed: the mathematical functions of the two C libraries differ (docs/decisions/platforms.md#087).
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/ci/shared/checks.sh
. "$top/tests/ci/shared/checks.sh"

folder=$top/build-bundle contract='' has_contract=''
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    --contract) need "$@"; contract=$2 has_contract=1; shift 2 ;;
    *) folder=$1; shift ;;
  esac
done
wine=''
for name in wine64 wine; do if command -v $name > /dev/null; then wine=$name; fi; done
if [ -z "$wine" ]; then say "skipped: no wine (Debian: wine64)"; exit 77; fi
archive=$(find "$folder" -maxdepth 1 -name 'ngs-*-windows-x86_64.zip')
[ -f "$archive" ] || fail 3 "$folder: '$archive', expected one archive" "make it with pipelines/bundle/windows.sh"
suite=$top/build/bin/test_contract probe=$top/build-windows-program
if [ -n "$has_contract" ]; then
  [ -x "$suite" ] || fail 8 "$suite: is absent, but runs the contract cases" "make it with pipelines/build.sh --target test_contract"
  [ -f "$probe/build.ninja" ] || fail 8 "$probe: is absent, but makes ngs-probe.exe" "make it with pipelines/bundle/windows.sh"
fi
work=$top/build-bundle/windows-test
rm -rf "$work"
mkdir -p "$work/programs ä 语" "$work/tools"
unzip -q "$archive" -d "$work/programs ä 语"
programs=$(echo "$work/programs ä 语"/*/bin)
export WINEPREFIX=$top/build-bundle/wine WINEARCH=win64 WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml=' LC_ALL=C.UTF-8
mkdir -p "$WINEPREFIX"
if [ -n "$has_contract" ]; then cmake --build "$probe" --target ngs-probe > "$work/probe.log"; fi
$wine wineboot -i > "$work/wineboot.log" 2>&1
# Wine's services inherit the streams of the program that starts them, and end with the last program: this one outlives all.
mkfifo "$work/empty"
exec 9<> "$work/empty"
$wine cmd /c 'set /p x=' < "$work/empty" > /dev/null 2>&1 9>&- &
trap '$wine wineboot --end-session --kill > "$work/wineboot.log" 2>&1 || true' EXIT
for program in "$programs"/*.exe "$probe"/tests/ngs-probe.exe; do
  [ -f "$program" ] || continue
  name=$(basename "$program" .exe)
  # shellcheck disable=SC2016  # $@ is the script's
  printf '#!/bin/bash\nexec %q %q "$@"\n' "$wine" "$program" > "$work/tools/$name"
  chmod +x "$work/tools/$name"
done
export PATH=$work/tools:$PATH NGS_THREADS=2
log=$work/log
cd "$work"

# ends CODE COMMAND...: whether the command ends with this exit code.
ends() {
  local code=0
  "${@:2}" || code=$?
  [ "$code" -eq "$1" ] || { echo "exit code $code, expected $1"; return 1; }
}

# --- programs ----------------------------------------------------------------------------------------------------------------

helps() { local tool; for tool in "$work"/tools/ngs*; do "$tool" --help > help.txt && grep -q '^exit codes' help.txt; done; }
check "every program prints its help" helps
small=(--view-count 6 --width-px 96 --height-px 72 --fit-steps 60)
check "ngs-synth" ngs-synth two-spheres -o scene "${small[@]}"
check "ngs cut" ngs cut scene --quality draft -o cut
check "ngs finds its other tools" ngs extract cut/labelled.ply --object-ply again.ply

x86_64-w64-mingw32-gcc-posix -static "$top/tests/windows/segmenter.c" -o segmenter.exe
printf '{"ngs_prompts":1,"view":"0000.png","width":96,"height":72,"boxes":[[24,18,72,54]]}\n' > prompts.json
masks=(ngs-mask cut/scene.json --prompts prompts.json --passes 1)
check "ngs-mask starts a segmenter for each view" "${masks[@]}" -o masks --segmenter './segmenter.exe scene/masks {image} {out} {prompts}'
check "ngs-mask sends all views to a running segmenter" "${masks[@]}" -o masks-kept --segmenter './segmenter.exe scene/masks'
check "and reads the same masks from it" diff -r masks masks-kept

# --- paths -------------------------------------------------------------------------------------------------------------------

odd='Größe 语 😀 (2)'
mkdir -p "$odd"
check "a path with blanks, an umlaut, Chinese and a character beyond 16 bits" \
  ngs cut scene --quality draft -o "$odd/cut" --report "$odd/report.json"
check "its outputs have the bytes of those elsewhere" cmp cut/object.ply "$odd/cut/object.ply"
check "backslashes and a drive" ngs-extract 'cut\labelled.ply' --object-ply 'Z:'"${work//\//\\}"'\by drive.ply'
check "the output is there" cmp cut/object.ply "by drive.ply"
long=$(printf 'a%.0s' {1..120})
mkdir -p "$long/$long"
check "a path longer than 260 characters" ngs-extract cut/labelled.ply --object-ply "$long/$long/object.ply"

# --- files that cannot be written ----------------------------------------------------------------------------------------------

cp cut/object.ply held.ply
x86_64-w64-mingw32-gcc-posix -static "$top/tests/windows/hold_open.c" -o hold_open.exe
$wine hold_open.exe held.ply > holder.txt &
holder=$!
until grep -q open holder.txt; do sleep 0.1; done
check "an output that another program holds open is an error" ends 8 ngs-extract cut/labelled.ply --object-ply held.ply -w
check "it stays as it was" cmp cut/object.ply held.ply
kill "$holder" && wait "$holder" 2> /dev/null || true
mkdir -p sealed
if mount -o bind,ro sealed sealed 2> /dev/null || { mount --bind sealed sealed && mount -o remount,bind,ro sealed; } 2> /dev/null; then
  check "a read-only folder is an error" ends 8 ngs-extract cut/labelled.ply --object-ply sealed/object.ply
  umount sealed
else
  say "SKIP a read-only folder: no right to mount"
fi

# --- ends ----------------------------------------------------------------------------------------------------------------------

# SIGINT to Wine is Ctrl-C in its console.
interrupted() {
  local code=0 pid
  (trap - INT; exec ngs-fit cut/scene.json --points scene/sparse/0/points3D.txt --steps 30000 -o fit.ply) > fit.txt 2>&1 &
  pid=$!
  sleep 4
  kill -INT "$pid"
  wait "$pid" || code=$?
  [ "$code" -eq 130 ] && ! ls fit.ply ./*.tmp* 2> /dev/null || { echo "exit code $code"; cat fit.txt; return 1; }
}
check "Ctrl-C ends a run with 130 and leaves no file" interrupted

answers() {
  local code=0 pid url
  (trap - INT; exec ngs-studio cut/object.ply --no-browser) > studio.txt 2>&1 &
  pid=$!
  for _ in {1..300}; do
    url=$(grep -oE 'http://[0-9.:]+[^ ]*' studio.txt | head -n 1) && break
    sleep 0.1
  done
  curl -sSfL -c cookies.txt -b cookies.txt "$url" -o page.html && grep -q '<title>ngs-studio' page.html || code=$?
  kill -INT "$pid"
  wait "$pid" || true
  return "$code"
}
check "ngs-studio answers an HTTP request" answers

# --- bytes ---------------------------------------------------------------------------------------------------------------------

differing=$("$top/tests/golden/bytes.sh" "$work/tools" "$work/golden" 2> golden.txt || true)
total=$(wc -l < "$top/tests/golden/golden.sha256")
say "files of tests/golden: $total, of which differ: $(grep -c FAILED <<< "$differing" || true)"
say "$differing"

if [ -n "$has_contract" ]; then
  NGS_WINDOWS_TOOLS=$work/tools NGS_CONTRACT_ONLY=$contract NGS_CONTRACT_TABLE=$work/contract.txt \
    "$suite" -tc='every tool satisfies*' > contract.log 2>&1 || failed=1
  tail -n 5 contract.log >&2
fi
exit "$failed"
