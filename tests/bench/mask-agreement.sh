#!/usr/bin/env bash
# Does ngs-variance pass right masks and name what is wrong with others? (decision 089)
#
#   tests/bench/mask-agreement.sh [-o OUT] [--kinds KINDS] [--mistakes MISTAKES] SCENE...
#
#   SCENE     the name of a recipe of ngs-synth (12 views, exact masks), or a folder with cameras, photos, a splat and
#             masks_sam/, masks_label/ (ids), masks_gt/ or masks/
#   -o OUT    folder of scenes and masks; a second call makes only missing ones           (default: mask-agreement)
#   --kinds, --mistakes   some of those below, separated by blanks
#
# Right masks: as given, and of the seven kinds of `results.sh no-harm`. Each line of stdout: scene, kind, exit code, mean
# IoU of the labels made from the masks with these masks, and the mistake that is named. Exit code 1: a right kind is
# refused, or a mistake is not. Needs python3 with Pillow.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/bench/results/no-harm.sh
. "$top/tests/bench/results/no-harm.sh"

out=mask-agreement scenes=() kinds="$mask_kinds"
mistakes='shift:1 shift:-1 shift:2 reversed mirrored upside-down half-turn left right transposed inverted'
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --kinds | --mistakes)
      [ $# -ge 2 ] || fail 2 "$1: no value given" "see $0 --help"
      case $1 in -o) out=$2 ;; --kinds) kinds=$2 ;; --mistakes) mistakes=$2 ;; esac
      shift 2 ;;
    *) scenes+=("$1"); shift ;;
  esac
done
[ "${#scenes[@]}" -gt 0 ] || fail 2 "no scene given" "see $0 --help"
python=${PYTHON:-python3}
bin=$(find_bin)

# mistaken MISTAKE MASKS TO: copies of masks with a mistake, of the same sizes and names.
mistaken() {
  "$python" - "$@" << 'END'
import pathlib, sys
from PIL import Image, ImageChops
mistake, source, to = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
turn = {"mirrored": 0, "upside-down": 1, "left": 2, "half-turn": 3, "right": 4, "transposed": 5}
files = sorted(f for f in source.rglob("*.png"))
for folder in sorted({f.parent for f in files}):
    names = [f for f in files if f.parent == folder]
    for i, name in enumerate(names):
        if mistake.startswith("shift:"):
            i -= int(mistake[6:])
            if not 0 <= i < len(names):
                continue
        image = Image.open(names[len(names) - 1 - i if mistake == "reversed" else i])
        size = image.size
        if mistake in turn:
            image = image.transpose(turn[mistake]).resize(size, 0)
        if mistake == "inverted":
            image = ImageChops.invert(image.convert("L"))
        if image.mode.startswith("I"):
            image = image.convert("I").convert("L")
        if mistake == "ids" and i % 2:
            image = image.point([0] + [1 + k % 2 * -2 + k for k in range(1, 256)])  # 1 and 2, 3 and 4, ...
        path = to / name.relative_to(source)
        path.parent.mkdir(parents=True, exist_ok=True)
        image.save(path)
END
}

# Import then needs a second of bird's seven; the masks compared here are too small to show what it corrects.
cameras_as_given='--no-align-views --filter-px2 0.3 --background black'

# judged SCENE KIND MASKS IS_RIGHT: imports the scene with these masks and prints its line.
judged() {
  local run=$out/runs/$(basename "$1")-$2 code=0 named=- given mode=binary
  if [ "${masks##*/}" = masks_label ]; then mode=label; fi
  mkdir -p "$run"
  # shellcheck disable=SC2086
  tool ngs-scene import "$1" --masks "$3" --mask-mode "$mode" --check-views 2 $cameras_as_given -o "$run/scene.json" \
    -w -q > /dev/null 2> "$run/log" &&
    tool ngs-variance "$run/scene.json" -o "$run/boundary.ply" --report "$run/report.json" -w -q > /dev/null \
      2> "$run/log" || code=$?
  given=$(grep -o 'IoU -\?[0-9.]*' "$run/log" | head -1 | cut -c5-) || true
  if [ "$code" = 0 ]; then
    given=$("$python" -c 'import json, sys; print("%.2f" % json.load(open(sys.argv[1]))["result"]["mask_agreement"]["given"])' \
      "$run/report.json")
  else
    named=$(grep -o 'the masks look [^,]*\|their masks contradict\|masks: labels made from them\|look inverted' "$run/log" | head -1)
  fi
  printf '%s\t%s\t%s\t%s\t%s\n' "$(basename "$1")" "$2" "$code" "$given" "$named"
  if [ "$code" -ne 0 ] && [ "$code" -ne 4 ]; then fail "$code" "$1, $2: $(head -1 "$run/log")"; fi
  if [ "$4" = yes ] && [ "$code" -ne 0 ]; then wrong=$((wrong + 1)); fi
  if [ "$4" = no ] && [ "$code" -eq 0 ]; then wrong=$((wrong + 1)); fi
  rm -f "$run/boundary.ply"
}

wrong=0
printf 'scene\tmasks\texit\tIoU\tnamed\n'
for scene in "${scenes[@]}"; do
  if [ ! -d "$scene" ]; then
    name=$scene scene=$out/scenes/$scene
    [ -f "$scene/done" ] || tool ngs-synth "$name" -o "$scene" --view-count 12 -w -q > /dev/null
    touch "$scene/done"
  fi
  for masks in "$scene"/masks_sam "$scene"/masks_label "$scene"/masks_gt "$scene"/masks; do
    if [ -d "$masks" ]; then break; fi
  done
  work=$out/masks/$(basename "$scene")
  for kind in $kinds; do
    given=$masks
    if [ "$kind" != given ] && [ "${masks##*/}" = masks_label ]; then continue; fi
    if [ "$kind" != given ]; then
      given=$work/$kind
      # shellcheck disable=SC2046
      [ -d "$given" ] || tool ngs-scene degrade "$masks" -o "$given" --seed 1 --photos "$scene/images" -w -q \
        $(flags_of_kind "$kind") > /dev/null
    fi
    judged "$scene" "$kind" "$given" yes
  done
  for mistake in $mistakes ids; do
    if [ "$mistake" = ids ] && [ "${masks##*/}" != masks_label ]; then continue; fi
    if [ "$mistake" = inverted ] && [ "${masks##*/}" = masks_label ]; then continue; fi
    [ -d "$work/$mistake" ] || mistaken "$mistake" "$masks" "$work/$mistake"
    judged "$scene" "$mistake" "$work/$mistake" no
  done
done
[ "$wrong" -eq 0 ] || fail 1 "$wrong lines are not as expected: right masks refused, or wrong ones not"
