#!/usr/bin/env bash
# Part of work-precision.mk: one scene (once NAME), one run of one point (run KNOB@VALUE/REPEAT BOUNDARY FLAGS...), the page
# (page), the check that OUT has the same settings (settings). SCENE OUT MASKS GT HOLD_OUT IMAGE_SCALE STEPS are environment
# variables.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"
bin=$(find_bin)

settings() {
  local file=$OUT/settings now
  now=$(printf 'SCENE=%s\nMASKS=%s\nGT=%s\n' "$(realpath -m "$SCENE")" "$(realpath -m "$MASKS")" "$(realpath -m "$GT")"
    printf 'HOLD_OUT=%s\nIMAGE_SCALE=%s\nSTEPS=%s\n' "$HOLD_OUT" "$IMAGE_SCALE" "$STEPS")
  mkdir -p "$OUT"
  [ -f "$file" ] || printf '%s\n' "$now" > "$file"
  [ "$now" = "$(cat "$file")" ] || fail 2 "$OUT: contains points with other settings: $(diff "$file" - <<< "$now" | sed -n 's/^< //p' | tr '\n' ' ')" \
    "choose another OUT, or remove this one"
}

# once NAME: scene.json and boundary.ply, for views@N (1, 2, 4, 8) with one mask in N, in a pattern that does not
# coincide with every-nth hold-outs.
once() {
  local folder=$OUT/once/$1 masks=$MASKS scale=$IMAGE_SCALE knob=${1%%@*} value=${1#*@}
  mkdir -p "$folder/reports"
  case $knob in
    image-scale) scale=$value ;;
    views)
      masks=$folder/masks
      rm -rf "$masks" && mkdir "$masks"
      local i=0 file
      for file in "$MASKS"/*; do
        if (( i++ * 5 % 8 < 8 / value )); then ln -s "$(realpath "$file")" "$masks/"; fi
      done ;;
  esac
  { tool ngs-scene import "$SCENE" --masks "$masks" --hold-out "$HOLD_OUT" ${scale:+--image-scale "$scale"} \
    -o "$folder/scene.json" -w -q --report "$folder/reports/ngs-scene.json" &&
    tool ngs-variance "$folder/scene.json" -o "$folder/boundary.ply" -w -q --report "$folder/reports/ngs-variance.json"
  } || echo $? > "$folder/failed"  # exit code for all points of this scene
}

# run KNOB@VALUE/REPEAT BOUNDARY FLAGS...: stores the exit code, also of a failure.
run() {
  local folder=$OUT/points/$1 scene trace=() rc=0
  scene=$(dirname "$2")/scene.json
  mkdir -p "$folder"
  if [[ ! -f $2 ]]; then
    cp "$(dirname "$2")/failed" "$folder/done"
    return
  fi
  case $1 in method@*) ;; *) trace=(--trace "$folder/trace.jsonl") ;; esac
  echo "$1: ${*:3}" >&2
  tool ngs-joint "$scene" "$2" -o "$folder/labelled.ply" -w -q "${trace[@]}" --report "$folder/joint.json" "${@:3}" || rc=$?
  if (( rc == 0 || rc == 7 )); then
    score_masks "$scene" "$folder/labelled.ply" "$GT" "$folder/metrics.json"
    rm "$folder/labelled.ply"
  fi
  echo "$rc" >"$folder/done"
}

# If ngs_numerical was built (with the tests): numerical errors, for a separate plot.
numerical() {
  local once=$OUT/once/scene
  [[ -x ${bin:+$bin/}ngs_numerical && -f $once/boundary.ply ]] || return 0
  "$bin/ngs_numerical" "$once/scene.json" "$once/boundary.ply" >"$OUT/numerical.json.part"
  mv "$OUT/numerical.json.part" "$OUT/numerical.json"
}

page() {
  [[ -f $OUT/numerical.json ]] || numerical
  tool ngs-report work-precision "$OUT" -o "$OUT/report.html" --points-json "$OUT/points.json" --points-csv "$OUT/points.csv" -w -q \
    --report "$OUT/report.json"
  echo "$OUT/report.html"
}

"$@"
