#!/usr/bin/env bash
# All objects of label maps in one run per method: score of each object, and Gaussians of other objects that a run changes.
#
#   pipelines/objects.sh CAPTURE OUT [METHOD...]
#
#   CAPTURE   a folder like the scene museum: sparse/, images/, masks_label/ and their truth labels_gt/,
#             point_cloud.compressed.ply and ids.u8, one byte per Gaussian: the id of its object, 0 for background
#   OUT       output folder; an interrupted call resumes there
#   METHOD    draft, standard or a --method of ngs-joint   (default: draft standard flash sa3d cob bce)
#
# Every fourth view is held out and scored at the photos' size. OUT/objects.md: IoU, B-IoU 0.02 and 0.005 of each object
# and method, and objects for which flash is better. OUT/ids.md: for draft and standard, Gaussians of other objects that were
# labelled, removed or changed (tests/bench/touched). Exit code 1 if a Gaussian of another object was removed, or a Gaussian
# outside the region was changed.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ $# -ge 2 ] || fail 2 "expected CAPTURE OUT" "see $0 --help"
bin=$(find_bin)
capture=$1 out=$2
shift 2
if [ $# -eq 0 ]; then set -- draft standard flash sa3d cob bce; fi
[ -f "$capture/ids.u8" ] || fail 3 "$capture/ids.u8: no such file" "see $0 --help"
mkdir -p "$out" || fail 8 "$out: cannot be created"

quiet() { tool "$@" -w -q > /dev/null; }

if [ ! -f "$out/boundary.ply" ]; then
  quiet ngs-scene import "$capture" --model "$capture/point_cloud.compressed.ply" --masks "$capture/masks_label" \
    --mask-mode label --hold-out every:4:2 -o "$out/scene.json"
  quiet ngs-variance "$out/scene.json" -o "$out/boundary.ply"
fi
ids=$(grep -o '"id": *[0-9]*' "$out/scene.json" | grep -o '[0-9]*$' | tr '\n' ' ' || true)
[ -n "$ids" ] || fail 4 "$out/scene.json: no object has an id" "the masks are not label maps"

# Writes to OUT/METHOD the metrics of each object, and for draft and standard the counts of ngs_touched.
run_method() {
  local to=$out/$1 id flags=(--method "$1")
  case $1 in draft | standard | high) flags=(--quality "$1") ;; esac
  if [ -f "$to/done" ]; then return; fi
  say "objects: $1"
  mkdir -p "$to"
  tool ngs-joint "$out/scene.json" "$out/boundary.ply" -o "$to/labelled.ply" -w -q --report "$to/joint.json" "${flags[@]}" > /dev/null
  quiet ngs-render "$out/scene.json" "$to/labelled.ply" --views held-out --layers labels --scale 0 -o "$to/labels"
  for id in $ids; do
    quiet ngs-eval "$to/labels" "$capture/labels_gt" --label-map --object-id "object-$id=$id" -o "$to/$id.json"
  done
  if [ "${flags[0]}" = --quality ]; then
    # shellcheck disable=SC2086
    tool ngs_touched "$capture/ids.u8" "$out/boundary.ply" "$to/labelled.ply" $ids > "$to/touched"
  fi
  rm -r "$to/labels" "$to/labelled.ply"
  touch "$to/done"
}

score() { sed -n '/"mean"/,/}/s/.*"'"$2"'": \([0-9.]*\).*/\1/p' "$1" | head -1; }

scores() {
  local method id
  for method in "$@"; do
    for id in $ids; do
      printf '%s %s %s %s %s\n' "$method" "$id" "$(score "$out/$method/$id.json" iou)" \
        "$(score "$out/$method/$id.json" biou)" "$(score "$out/$method/$id.json" biou_005)"
    done
  done
}

objects_table() {
  scores "$@" | awk '
    { at = $1 SUBSEP $2; for (s = 3; s <= 5; ++s) value[at, s] = $s
      if (!($1 in seen)) { seen[$1]; method[++methods] = $1 }
      if (!($2 in known)) { known[$2]; id[++objects] = $2 } }
    END {
      printf "| method |"; for (k = 1; k <= objects; ++k) printf " %s |", id[k]
      printf " mean IoU | mean B-IoU 0.02 | mean B-IoU 0.005 | least IoU |\n|---|"
      for (k = 1; k <= objects + 4; ++k) printf "---:|"; print ""
      for (m = 1; m <= methods; ++m) {
        printf "| %s |", method[m]; least = 2; sum[3] = sum[4] = sum[5] = 0
        for (k = 1; k <= objects; ++k) {
          at = method[m] SUBSEP id[k]
          printf " %.4f / %.4f / %.4f |", value[at, 3], value[at, 4], value[at, 5]
          for (s = 3; s <= 5; ++s) sum[s] += value[at, s]
          if (value[at, 3] < least) least = value[at, 3]
        }
        printf " %.4f | %.4f | %.4f | %.4f |\n", sum[3] / objects, sum[4] / objects, sum[5] / objects, least
      }
      if (!(("standard" in seen) && ("flash" in seen))) exit
      print "\nB-IoU 0.005 of standard less that of the best other method:"
      for (k = 1; k <= objects; ++k) {
        best = -1
        for (m = 1; m <= methods; ++m)
          if (method[m] != "standard" && method[m] != "draft" && value[method[m], id[k], 5] > best) {
            best = value[method[m], id[k], 5]; who = method[m]
          }
        printf "- %s: %+.4f (%s)\n", id[k], value["standard", id[k], 5] - best, who
      }
    }'
}

ids_table() {
  local method
  echo '| method | object | own | of others | background | of others, removed | of others, changed | outside the input region | outside both regions |'
  echo '|---|---|---:|---:|---:|---:|---:|---:|---:|'
  for method in "$@"; do
    if [ ! -f "$out/$method/touched" ]; then continue; fi
    sed "s/\t/ | /g;s/^/| $method | /;s/\$/ |/" "$out/$method/touched"
  done
}

for method in "$@"; do run_method "$method"; done
objects_table "$@" | tee "$out/objects.md"
ids_table "$@" | tee "$out/ids.md"
for method in "$@"; do
  if [ -f "$out/$method/touched" ]; then cat "$out/$method/touched"; fi
done | awk -F '\t' '{ bad += $5 + $8 } END { exit bad > 0 }'
