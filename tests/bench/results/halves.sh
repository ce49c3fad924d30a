# halves: both halves of a cut against the truth of synthetic scenes: the object from all sides, the room behind it
# shellcheck shell=bash disable=SC2154
#
# Masks are exact and every photo is used: what differs from the truth is what no photo shows, or what the cut left. The
# splat is fitted to the photos with the object alone. RECIPE-shadow: the objects cast shadows in the photos; the room of the
# truth has none of the object. About 80 CPU seconds a recipe.
hole_recipes='two-spheres ground corner torus-box'
halves_recipes=${RECIPES:-leaves bones table $hole_recipes ${hole_recipes// /-shadow }-shadow}

question_halves() {
  title 'Both halves of a cut against the truth, means over the recipes without cast shadows; hole: PSNR at new cameras, dB'
  label method method
  label 'options of ngs-extract' variant
  local group recipe method
  for group in seen unseen; do
    column "$group: B-IoU" '' "${group}_biou" mean 4 shadows=none
    column "$group: spikes" px "${group}_spikes_px" mean 1 shadows=none
    column "$group: longest" px "${group}_longest_spike_px" mean 1 shadows=none
    column "$group: holes" px "${group}_holes_px" mean 1 shadows=none
  done
  column 'flicker' '' flicker mean 4 shadows=none
  column 'change outside' '' outside_mean mean 5 shadows=none
  for recipe in $hole_recipes; do
    column "hole: $recipe" '' new_psnr_db mean 1 scene="$recipe"
    column 'with cast shadows' '' new_psnr_db mean 1 scene="$recipe-shadow"
  done
  for recipe in $halves_recipes; do
    halves_scene "$recipe"
    for method in flash cob ngs; do
      wanted "$method" || continue
      halves_labels "$recipe" "$method"
      halves_row "$recipe" "$method"
      halves_variants "$recipe" "$method"
    done
  done
}

# halves_scene RECIPE: photos, truth, splat, scene.json and boundary.ply in $work/RECIPE-scene and $work/RECIPE.
halves_scene() {
  local scene=$work/$1-scene shadows=()
  if [ "$1" != "${1%-shadow}" ]; then shadows=(--cast-shadows); fi
  if [ ! -f "$scene/done" ]; then
    say "$question: $1"
    tool ngs-synth "${1%-shadow}" -o "$scene" --truth halves --view-count 16 --fit-steps 1500 "${shadows[@]}" -w -q > /dev/null
    touch "$scene/done"
  fi
  prepare "$1" "$scene" --masks "$scene/masks_gt"
}

# halves_labels RECIPE METHOD: writes $work/RECIPE-METHOD/labelled.ply.
halves_labels() {
  local run=$work/$1-$2
  if [ -f "$run/done" ]; then return; fi
  say "$question: $1, $2"
  mkdir -p "$run"
  # shellcheck disable=SC2046
  tool ngs-joint "$work/$1/scene.json" "$work/$1/boundary.ply" -o "$run/labelled.ply" -w -q $(flags_of "$2") > /dev/null
  touch "$run/done"
}

# halves_row RECIPE METHOD [options of ngs-extract]: cuts, scores, prints the row.
halves_row() {
  local labelled=$work/$1-$2/labelled.ply cut
  cut="$work/$1-$2/$(printf '%s' "cut ${*:3}" | tr -c 'A-Za-z0-9\n' _)"
  if [ ! -f "$cut/halves.json" ]; then
    mkdir -p "$cut"
    # shellcheck disable=SC2086
    tool ngs-extract "$labelled" --scene "$work/$1/scene.json" ${*:3} --object-ply "$cut/object.ply" \
      --background-ply "$cut/background.ply" --background-filled "$cut/filled.ply" -w -q > /dev/null
    if [ -e "$cut/filled.ply" ]; then mv "$cut/filled.ply" "$cut/background.ply"; fi
    tool ngs-eval "$cut" "$work/$1-scene/halves" --halves --model "$work/$1-scene/point_cloud.ply" \
      -o "$cut/halves.json" -w -q > /dev/null
  fi
  local shadows=none
  if [ "$1" != "${1%-shadow}" ]; then shadows=cast; fi
  row scene="$1" shadows="$shadows" method="$2" variant="${*:3}" halves="$cut/halves.json"
}

# halves_variants RECIPE METHOD: a row for each list of options in VARIANTS, separated by |. Default: without finish and fill.
halves_variants() {
  local lists=${VARIANTS:---no-finish --fill off} options
  while IFS= read -r options; do
    # shellcheck disable=SC2086
    if [ -n "$options" ]; then halves_row "$1" "$2" $options; fi
  done <<< "${lists//|/$'\n'}"
}
