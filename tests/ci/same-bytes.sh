#!/usr/bin/env bash
# Checks that two builds write the same bytes for the same inputs: scenes of ngs-synth, and the chain with every method on them.
#
#   tests/ci/same-bytes.sh OLD_BIN NEW_BIN OUT [--quick] [CAPTURE...]
#
#   OLD_BIN, NEW_BIN  folders of the tools of both builds
#   OUT               folder of the results; those of OLD_BIN are kept for the next call
#   --quick           one scene of ngs-synth: less than a minute
#   CAPTURE           captures to cut as well, as for pipelines/ngs-gs.sh
#
# Reports, which have times and paths, are not compared. stdout: the files that differ or that one build lacks. Exit code 1
# if there are any, or if a tool failed.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ $# -ge 3 ] || fail 2 "expected OLD_BIN NEW_BIN OUT" "see $0 --help"
# shellcheck disable=SC2034  # read by name: ${!side}
old=$(NGS_BIN=$1 find_bin) new=$(NGS_BIN=$2 find_bin)
mkdir -p "$3"
out=$(cd "$3" && pwd)
shift 3
recipes='torus-box two-spheres leaves bones table'
if [ "${1:-}" = --quick ]; then recipes=torus-box; shift; fi

# cut SIDE NAME CAPTURE: the results of every method, and what else the tools write.
cut() {
  local side=$1 to=$out/$1/$2 method words
  for method in ngs draft ng-gs flash sa3d cob bce saga released; do
    words=(--method "$method")
    case $method in draft) words=(--quality draft) ;; saga) words+=(--saga-steps 100) ;; esac
    NGS_BIN=${!side} "$pipelines/ngs-gs.sh" "$3" "$to/$method" --hold-out every:4:2 --artifacts all "${words[@]}" -q > /dev/null
  done
  bin=${!side}
  cd "$to"
  tool ngs-render ngs/scene.json ngs/labelled.ply --layers color,mask,alpha,depth,labels,overlay -o pictures -w -q > /dev/null
  tool ngs-extract ngs/labelled.ply --scene ngs/scene.json --inpaint inpaint --supersplat supersplat.ply -w -q > /dev/null
  tool ngs-variance ngs/scene.json --shard 1/2 --partial shard.evidence -w -q > /dev/null
}

rm -rf "$out/new"
for side in old new; do
  for recipe in $recipes; do
    bin=${!side}
    [ -f "$out/$side/synth/$recipe/point_cloud.ply" ] ||
      tool ngs-synth "$recipe" -o "$out/$side/synth/$recipe" --view-count 8 --width-px 128 --height-px 96 --fit-steps 200 \
        --mask-noise jitter:1.5 -w -q > /dev/null
    cut "$side" "$recipe" "$out/old/synth/$recipe"
  done
  for capture in "$@"; do cut "$side" "$(basename "$capture")" "$(realpath "$capture")"; done
done
diff -rq --exclude=reports --exclude=.state --exclude=report.html --exclude=trace.jsonl "$out/old" "$out/new" || fail 1 "the builds differ"
