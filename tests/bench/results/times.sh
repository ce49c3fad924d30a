# times: time and memory of each tool on bird
# shellcheck shell=bash disable=SC2154
question_times() {
  title "Bird, every:4:2 held out, two threads, medians of $repeats runs"
  label tool tool
  column wall s wall_s median 2
  column CPU s cpu_s median 2
  column 'peak memory' MiB peak_mib most 0
  local bird dir=$work/files
  bird=$(capture bird)
  mkdir -p "$dir"
  timed 'ngs-scene import' ngs-scene import "$bird" --masks "$bird/masks_sam" --hold-out every:4:2 -o "$dir/scene.json"
  timed ngs-variance ngs-variance "$dir/scene.json" -o "$dir/boundary.ply"
  timed ngs-sample ngs-sample "$dir/scene.json" "$dir/boundary.ply" -o "$dir/queries.ply"
  timed ngs-rbf ngs-rbf "$dir/boundary.ply" "$dir/queries.ply" -o "$dir/field.ply"
  timed 'ngs-joint --method flash' ngs-joint "$dir/scene.json" "$dir/boundary.ply" --method flash -o "$dir/flash.ply"
  timed 'ngs-joint --method bce' ngs-joint "$dir/scene.json" "$dir/boundary.ply" --method bce -o "$dir/bce.ply"
  timed 'ngs-joint --quality draft' ngs-joint "$dir/scene.json" "$dir/boundary.ply" --quality draft -o "$dir/draft.ply"
  timed ngs-joint ngs-joint "$dir/scene.json" "$dir/boundary.ply" -o "$dir/labelled.ply"
  timed ngs-extract ngs-extract "$dir/labelled.ply" --object-ply "$dir/object.ply" --background-ply "$dir/background.ply"
  timed 'ngs-render, 5 masks' ngs-render "$dir/scene.json" "$dir/labelled.ply" --views held-out --scale 0 -o "$dir/masks"
  timed 'ngs-eval, 5 masks' ngs-eval "$dir/masks" "$bird/masks_gt" -o "$dir/metrics.json"
}

# timed NAME TOOL ARGUMENTS...: runs the tool $repeats times and prints a row per run.
timed() {
  local run report
  for run in $(seq "$repeats"); do
    report="$work/$1-$run.json"
    if [ ! -f "$report" ]; then
      tool "${@:2}" -w -q --report "$report.part" > /dev/null
      mv "$report.part" "$report"
    fi
    row tool="$1" run="$run" times="$report"
  done
}
