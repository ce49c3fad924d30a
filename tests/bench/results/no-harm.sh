# no-harm: does the default ever score below the closed form? captures, recipes, seven kinds of degraded masks
# shellcheck shell=bash disable=SC2154
#
# Two halves: the labels in the scene, and object.ply rendered alone (not of museum's nine objects). A cell is the default's
# score minus that of --method flash, from the same splat and masks, in held-out views: the minimum over splits and objects.
# "alone" is the same of object.ply, in recipes without parts that other things hide; "finish" is object.ply minus that of
# --no-finish, the lesser of both methods. The gate fails if a cell is below -0.003. FULL=1 adds three more splits of the
# captures.
# Flower has no ground truth: its row is the agreement with the input masks of the held-out views, which the closed form
# reproduces by construction (decision 078). It is not part of the gate.
mask_kinds='given exact displaced snapped eroded dilated missing swapped'

question_no-harm() {
  title 'B-IoU 0.005 of the default less that of flash, the least over splits and objects'
  label scene scene
  label views views
  local kind
  for kind in $mask_kinds; do column "$kind" '' gain least 4 masks="$kind"; done
  column 'least of B-IoU 0.02' '' gain_wide least 4
  column 'least alone' '' alone least 4
  column 'least finish' '' finish least 4
  column 'agreement' '' agreement least 4
  no_harm_captures
  no_harm_museum
  no_harm_recipes
}

check_no-harm() {
  local key least
  for key in gain gain_wide alone finish; do
    least=$(tables value "$results/no-harm.json" "$key" least) || return
    awk -v a="$least" 'BEGIN { exit !(a >= -0.003) }' ||
      fail 1 "$key: the default or the finished object scores below its reference by $least, expected at most 0.003" \
        "see the cells: tests/bench/results.sh --table no-harm"
  done
}

# The captures, with their masks from a network.
no_harm_captures() {
  local set split truth views full_splits='every:4:2'
  if [ -n "${FULL:-}" ]; then full_splits='every:4:0 every:4:1 every:4:2 every:4:3'; fi
  for set in bird skull lego flower; do
    truth=$(capture $set)/masks_gt
    [ -d "$truth" ] || truth=$(capture $set)/masks_sam
    views=$(find -L "$(capture $set)/images" -type f | wc -l)
    for split in ${SPLITS:-$full_splits}; do
      prepare "$set-$split" "$(capture $set)" --masks "$(capture $set)/masks_sam" --hold-out "$split"
      no_harm_cell "$set-$split" "$truth" scene="$set" views="$views" masks=given run="$split"
    done
  done
}

no_harm_recipes() {
  local recipe views kind scene
  for recipe in $recipes; do
    for views in 12 40; do
      scene=$work/$recipe-$views-scene
      if [ ! -f "$scene/done" ]; then
        tool ngs-synth "$recipe" -o "$scene" --view-count "$views" --fit-steps 1500 --truth halves -w -q > /dev/null
        touch "$scene/done"
      fi
      for kind in ${mask_kinds#given}; do
        # shellcheck disable=SC2046
        degraded_masks "$scene/masks_gt" "$scene/masks-$kind" --seed 1 --photos "$scene/images" $(flags_of_kind "$kind")
        prepare "$recipe-$views-$kind" "$scene" --masks "$scene/masks-$kind" --hold-out every:4:2
        no_harm_cell "$recipe-$views-$kind" "$scene/masks_gt" scene="$recipe" views="$views" masks="$kind" run=seed-0
      done
    done
  done
}

# Options of ngs-scene degrade. "snapped" models networks, which displace contours to wrong image edges.
flags_of_kind() {
  case $1 in
    exact) echo '--missing 0' ;;
    displaced) echo '--mask-noise jitter:2' ;;
    snapped) echo '--mask-noise snap:4' ;;
    eroded) echo '--mask-noise erode:3' ;;
    dilated) echo '--mask-noise dilate:3' ;;
    missing) echo '--mask-noise jitter:1 --missing 0.2' ;;
    swapped) echo '--mask-noise jitter:1 --wrong 0.1' ;;
  esac
}

# no_harm_cell PREPARED TRUTH KEY=VALUE...: runs both methods and prints the row of their difference.
no_harm_cell() {
  scores_alone=1 cut_out "$1-flash" "$1" "$2" --method flash
  scores_alone=1 cut_out "$1-ngs" "$1" "$2"
  local alone=()
  if [ "$3" != scene=flower ]; then
    alone=(alone="$(gain_of biou_005 "$work/$1-flash/alone.json" "$work/$1-ngs/alone.json")"
      finish="$(for method in flash ngs; do
        gain_of biou_005 "$work/$1-$method/unfinished.json" "$work/$1-$method/alone.json"
        echo
      done | sort -g | head -1)")
  fi
  gain_row "$work/$1-flash/metrics.json" "$work/$1-ngs/metrics.json" "${@:3}" "${alone[@]}"
}

# gain_row FLASH_METRICS DEFAULT_METRICS KEY=VALUE...
gain_row() {
  case $3 in
    scene=flower) row "${@:3}" agreement="$(gain_of biou_005 "$1" "$2")" ;;
    *) row "${@:3}" gain="$(gain_of biou_005 "$1" "$2")" gain_wide="$(gain_of biou "$1" "$2")" ;;
  esac
}

# gain_of KEY FLASH_METRICS DEFAULT_METRICS: the difference of the means over the views.
gain_of() {
  awk -v flash="$(tables score "$2" "$1")" -v ours="$(tables score "$3" "$1")" \
    'BEGIN { printf "%.6f", ours - flash }'
}

# All nine objects in one run, each scored separately.
no_harm_museum() {
  local museum dir=$work/museum id method
  museum=$(capture museum)
  mkdir -p "$dir"
  if [ ! -f "$dir/boundary.ply" ]; then
    tool ngs-scene import "$museum" --model "$museum/point_cloud.compressed.ply" --masks "$museum/masks_label" \
      --mask-mode label --hold-out every:4:2 -o "$dir/scene.json" -w -q > /dev/null
    tool ngs-variance "$dir/scene.json" -o "$dir/boundary.ply" -w -q > /dev/null
  fi
  for method in flash auto; do no_harm_museum_method "$dir" "$method"; done
  for id in 1 2 3 4 5 6 7 8 9; do
    gain_row "$dir/flash-$id.json" "$dir/auto-$id.json" scene=museum views=120 masks=displaced run="object-$id"
  done
}

# no_harm_museum_method DIR METHOD: writes DIR/METHOD-ID.json, the scores of each object.
no_harm_museum_method() {
  local dir=$1 id
  if [ -f "$dir/$2-9.json" ]; then return; fi
  say "$question: museum, $2"
  # shellcheck disable=SC2046
  tool ngs-joint "$dir/scene.json" "$dir/boundary.ply" -o "$dir/$2.ply" -w -q $(flags_of "$2") > /dev/null
  tool ngs-render "$dir/scene.json" "$dir/$2.ply" --views held-out --layers labels --scale 0 -o "$dir/$2" -w -q > /dev/null
  for id in 1 2 3 4 5 6 7 8 9; do
    tool ngs-eval "$dir/$2" "$museum/labels_gt" --label-map --object-id "$id" -o "$dir/$2-$id.json" -w -q > /dev/null
  done
  rm -r "$dir/$2.ply" "$dir/${2:?}"
}
