#!/usr/bin/env bash
# Counts the instructions of the compositing kernels with and without vector code: NEON on aarch64 with qemu-user, AVX2 on
# x86-64 with callgrind:
#   tests/bench/instructions.sh [OUT_DIR]      OUT_DIR: build/instructions
# Times under emulation do not predict those of a processor; instruction counts are exact and reproducible. Tools of this
# machine ($NGS_BIN, or the build folder) make a small scene. Then each set of kernels gathers the evidence and runs eight
# joint steps: same work, same bytes (compared, also between both processors). One thread, since counters are not shared.
# Prints a table to stdout. Exit code 1 if bytes differ, 77 if neither processor could be counted. aarch64 needs the tools of
# tests/ci/aarch64.sh; NGS_AARCH64_ROOT as there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=pipelines/common.sh
. "$here/../../pipelines/common.sh"
case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
bin=$(find_bin) top=$(cd "$here/../.." && pwd)
emulated=$top/build-aarch64/bin
mkdir -p "${1:-$top/build/instructions}"
cd "${1:-$top/build/instructions}"
export QEMU_LD_PREFIX=${NGS_AARCH64_ROOT:-$top/build-aarch64.root} NGS_THREADS=1 GOMP_SPINCOUNT=0

# counted_on PROCESSOR TO TOOL ARGUMENTS...: writes to TO a line per function: instructions, name.
counted_on() {
  local processor=$1 to=$2 name=$3
  shift 3
  case $processor in
    aarch64)
      QEMU_PLUGIN="file=$PWD/count.so,out=$PWD/$to.mangled" qemu-aarch64 "$emulated/$name" "$@" -w -q > /dev/null
      c++filt < "$to.mangled" > "$to" ;;
    x86-64)
      valgrind -q --tool=callgrind --callgrind-out-file="$to.callgrind" "${bin:+$bin/}$name" "$@" -w -q > /dev/null
      callgrind_annotate --threshold=100 "$to.callgrind" | sed -n 's/^ *\([0-9,]*\) ([^)]*) *[^:]*:\(.*\)$/\1 \2/p' |
        awk '{ gsub(",", "", $1); print }' > "$to" ;;
  esac
}

# count PROCESSOR ISA
count() {
  export NGS_ISA=$2
  counted_on "$1" "variance-$1-$2" ngs-variance scene.json -o "boundary-$1-$2.ply"
  counted_on "$1" "draft-$1-$2" ngs-joint scene.json "boundary-$1-$2.ply" --quality draft --steps 8 -o "labelled-$1-$2.ply"
  unset NGS_ISA
}

# table PROCESSOR ISA: ratio to portable. The row of exp is nonzero only if the compiler did not inline it.
table() {
  local kernel vectors portable
  for kernel in 'forward forward_tile|forward_any' 'backward TileBackward|backward_tile|backward_any' \
    'evidence evidence_tile|evidence_any' 'exp exp2_reduced' \
    'all forward_tile|forward_any|TileBackward|backward_tile|backward_any|evidence_tile|evidence_any|exp2_reduced'; do
    of() { awk -v k="::(${kernel#* })<" '$0 ~ k { s += $1 } END { printf "%d", s }' "variance-$1" "draft-$1"; }
    vectors=$(of "$1-$2") portable=$(of "$1-portable")
    awk -v p="$1" -v i="$2" -v k="${kernel%% *}" -v n="$vectors" -v m="$portable" \
      'BEGIN { printf "%-10s %-10s %-5s %14d %14d %6s\n", p, k, i, n, m, n ? sprintf("%.2f", m / n) : "-" }'
  done
}

counted=()
if ! command -v valgrind > /dev/null; then say "skipped: x86-64, no valgrind"; else counted+=("x86-64 v3"); fi
if ! command -v qemu-aarch64 > /dev/null || ! command -v c++ > /dev/null; then
  say "skipped: aarch64, no qemu-aarch64 or no c++"
elif [ ! -x "$emulated/ngs-joint" ]; then
  say "skipped: aarch64, no tools in build-aarch64; build them with tests/ci/aarch64.sh"
else
  c++ -std=c++20 -O2 -shared -fPIC -o count.so "$here/instructions/count.cpp"
  counted+=("aarch64 neon")
fi
[ ${#counted[@]} -gt 0 ] || exit 77
"${bin:+$bin/}ngs-synth" torus-box -o scene --view-count 4 --width-px 96 --height-px 72 --fit-steps 60 -w -q > /dev/null
"${bin:+$bin/}ngs-scene" import scene --masks scene/masks_gt --check-views 0 -o scene.json -w -q > /dev/null
code=0 first=''
printf '%-10s %-10s %-5s %14s %14s %6s\n' processor kernel by instructions portable ratio
for one in "${counted[@]}"; do
  for isa in "${one#* }" portable; do
    count "${one% *}" "$isa"
    first=${first:-${one% *}-$isa}
    for file in boundary labelled; do cmp "$file-$first.ply" "$file-${one% *}-$isa.ply" || code=1; done
  done
  table "${one% *}" "${one#* }"
done
exit "$code"
