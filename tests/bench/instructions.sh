#!/usr/bin/env bash
# How many instructions the compositing kernels take on aarch64, with NEON and without, counted by qemu-user:
#   tests/bench/instructions.sh [OUT_DIR]      OUT_DIR: build-aarch64/instructions
# Times under emulation say nothing of a processor; numbers of instructions are exact and the same for every run. Of a small
# scene, made by this machine's tools ($NGS_BIN, else those of the build folder), the evidence is gathered and eight joint
# steps are run, once by each set of kernels: same work, same bytes (compared). One thread, since counters are not shared.
# A table on stdout. Exit code 1 where bytes differ, 77 where a program is missing.
# Needs the tools of pipelines/aarch64.sh; NGS_AARCH64_ROOT as there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=pipelines/common.sh
. "$here/../../pipelines/common.sh"
case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
tools=$(find_bin) bin=$(cd "$here/../.." && pwd)/build-aarch64/bin
for program in qemu-aarch64 c++ c++filt; do
  command -v "$program" > /dev/null || { say "skipped: no $program"; exit 77; }
done
[ -x "$bin/ngs-joint" ] || { say "skipped: no tools in build-aarch64, pipelines/aarch64.sh builds them"; exit 77; }
mkdir -p "${1:-$bin/../instructions}"
cd "${1:-$bin/../instructions}"
export QEMU_LD_PREFIX=${NGS_AARCH64_ROOT:-$bin/../../build-aarch64.root} NGS_THREADS=1 GOMP_SPINCOUNT=0

c++ -std=c++20 -O2 -shared -fPIC -o count.so "$here/instructions/count.cpp"
run() { qemu-aarch64 "$bin/$@" -w -q > /dev/null; }
"${tools:+$tools/}ngs-synth" torus-box -o scene --views 4 --width-px 96 --height-px 72 --fit-steps 60 -w -q > /dev/null
"${tools:+$tools/}ngs-scene" import scene --masks scene/masks_gt --check-views 0 -o scene.json -w -q > /dev/null
for isa in neon portable; do
  export NGS_ISA=$isa
  QEMU_PLUGIN="file=$PWD/count.so,out=$PWD/variance-$isa" run ngs-variance scene.json -o "boundary-$isa.ply"
  QEMU_PLUGIN="file=$PWD/count.so,out=$PWD/draft-$isa" run ngs-joint scene.json boundary-neon.ply --quality draft --steps 8 \
    -o "labelled-$isa.ply"
done
unset NGS_ISA

printf '%-10s %14s %14s %6s\n' kernel neon portable ratio
for kernel in 'forward forward_tile|forward_any' 'backward TileBackward|backward_tile|backward_any' \
  'tape record_tile' 'evidence evidence_tile|evidence_any'; do
  of() { cat "variance-$1" "draft-$1" | c++filt | grep -E "::(${kernel#* })<" | awk '{ s += $1 } END { printf "%d", s }'; }
  neon=$(of neon) portable=$(of portable)
  awk -v k="${kernel%% *}" -v n="$neon" -v p="$portable" \
    'BEGIN { printf "%-10s %14d %14d %6s\n", k, n, p, n ? sprintf("%.2f", p / n) : "-" }'
done
code=0
for file in boundary labelled; do cmp "$file-neon.ply" "$file-portable.ply" || code=1; done
exit "$code"
