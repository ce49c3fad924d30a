#!/bin/sh
# Counts the instructions of ngs-joint on a tiny scene under valgrind, for a draft and for the default, and compares them
# with instructions.txt: unlike a clock, they do not depend on what else the machine does. One thread, the portable
# kernels, and the compiler of the record; elsewhere it is skipped (exit code 77).
#
#   tests/golden/instructions.sh BIN_DIR OUT_DIR COMPILER            exit code 1 if a count differs by more than 15 %
#   tests/golden/instructions.sh BIN_DIR OUT_DIR COMPILER --write    after a change that is meant to cost more or less
set -eu
record=$(cd "$(dirname "$0")" && pwd)/instructions.txt
bin=$(cd "$1" && pwd)
compiler=$3
skip() { echo "skipped: $1"; exit 77; }
command -v valgrind > /dev/null || skip "valgrind is not installed"
[ "${4:-}" = --write ] || grep -qx "compiler $compiler" "$record" || skip "the counts are not those of $compiler"
rm -rf "$2"
mkdir -p "$2"
cd "$2"
export OMP_NUM_THREADS=1 NGS_ISA=portable

"$bin/ngs-synth" two-spheres -o scene --view-count 4 --width-px 48 --height-px 36 --fit-steps 150 \
  --fit-max-gaussians 200 -q > /dev/null
"$bin/ngs-scene" import scene --masks scene/masks --hold-out every:4:1 -o scene.json -q > /dev/null
"$bin/ngs-variance" scene.json -o boundary.ply -q > /dev/null

# count NAME OPTIONS: the instructions of one run
count() {
  name=$1
  shift
  valgrind --tool=cachegrind --cache-sim=no --branch-sim=no --cachegrind-out-file=/dev/null "$bin/ngs-joint" \
    scene.json boundary.ply "$@" -o "$name.ply" -q -w > "$name.out" 2> "$name.log" ||
    skip "ngs-joint does not run under valgrind: $(tail -n 1 "$name.log")"
  sed -n 's/^==.*I *refs: *//p' "$name.log" | tr -d ,
}
# off COUNT RECORDED: more than 15 % apart
off() { [ $(($1 * 100)) -gt $(($2 * 115)) ] || [ $(($1 * 115)) -lt $(($2 * 100)) ]; }

draft=$(count draft --quality draft --contour-epochs 8)
default=$(count default --contour-epochs 3)
if [ "${4:-}" = --write ]; then
  printf 'compiler %s\ndraft %s\ndefault %s\n' "$compiler" "$draft" "$default" > "$record"
  exit
fi
failed=0
for name in draft default; do
  got=$draft
  [ $name = draft ] || got=$default
  want=$(sed -n "s/^$name //p" "$record")
  echo "$name: $got instructions, recorded $want"
  if off "$got" "$want"; then
    echo "  more than 15 % apart: find out why, or record it: $0 BIN_DIR OUT_DIR COMPILER --write"
    failed=1
  fi
done
# The check catches a loop that runs twice.
doubled=$(count doubled --quality draft --contour-epochs 16)
off "$doubled" "$draft" || { echo "twice the epochs: $doubled instructions, expected 15 % more than $draft"; failed=1; }
exit $failed
