# museum: two million Gaussians, 120 photos: time, memory and scores of one object and of nine
# shellcheck shell=bash disable=SC2154
question_museum() {
  title "Museum, 2,059,404 Gaussians, 120 photos of 1296x840, every:4:2 held out; two threads, medians of $repeats runs"
  label objects objects
  label tool tool
  column wall s wall_s median 1
  column CPU s cpu_s median 1
  column 'peak memory' MiB peak_mib most 0
  column 'angel: IoU' '' iou mean 4
  column 'angel: B-IoU 0.02' '' biou mean 4
  column 'angel: B-IoU 0.005' '' biou_005 mean 4
  local museum run
  museum=$(capture museum)
  for run in $(seq "$repeats"); do
    museum_objects 1 --object-id angel=2
    museum_method 1 'ngs-joint --method flash' --method flash
    museum_method 1 'ngs-joint --quality draft' --quality draft
    museum_method 1 ngs-joint
    museum_objects 9
    museum_method 9 'ngs-joint --quality draft' --quality draft
    museum_method 9 ngs-joint
  done
}

# museum_objects COUNT [flags of import]: scene and boundary of one object, or of all objects in the label maps.
museum_objects() {
  local dir=$work/files-$1
  mkdir -p "$dir"
  museum_tool "$1" 'ngs-scene import' ngs-scene import "$museum" --model "$museum/point_cloud.compressed.ply" \
    --masks "$museum/masks_label" --mask-mode label --hold-out every:4:2 -o "$dir/scene.json" "${@:2}"
  museum_tool "$1" ngs-variance ngs-variance "$dir/scene.json" -o "$dir/boundary.ply"
}

# museum_method COUNT NAME FLAGS...: time, and the score of the angel in the held-out views.
museum_method() {
  local dir=$work/files-$1 result
  result="$dir/$(printf '%s' "$2" | tr ' ' _)"
  scored=$result.json museum_tool "$1" "$2" ngs-joint "$dir/scene.json" "$dir/boundary.ply" -o "$result.ply" "${@:3}"
}

# museum_tool COUNT NAME TOOL ARGUMENTS...: the row of a run; `scored`: file for the scores of the result, or empty.
museum_tool() {
  local report="$work/$1-$2-$run.json"
  if [ ! -f "$report" ]; then
    say "museum: $1, $2, run $run"
    tool "${@:3}" -w -q --report "$report.part" > /dev/null
    if [ -n "${scored:-}" ]; then score_angel "$work/files-$1/scene.json" "$scored"; fi
    mv "$report.part" "$report"
  fi
  row objects="$1" tool="$2" run="$run" times="$report" ${scored:+scores="$scored"}
}

# score_angel SCENE_JSON METRICS: scores the result (METRICS with .ply for .json) in the held-out views.
score_angel() {
  tool ngs-render "$1" "${2%.json}.ply" --views held-out --layers labels --scale 0 -o "${2%.json}" -w -q > /dev/null
  tool ngs-eval "${2%.json}" "$museum/labels_gt" --label-map --object-id angel=2 -o "$2" -w -q > /dev/null
  rm -r "${2%.json}" "${2%.json}.ply"
}
