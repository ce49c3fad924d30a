# studio: response times of ngs-studio in scripted sessions of a hundred strokes
# shellcheck shell=bash disable=SC2154
question_studio() {
  title 'A hundred strokes in ngs-studio on 21 or 25 views, with frames between them; two threads'
  without_options
  label scene scene
  label answer answer
  column answers '' n mean 0
  column median ms median_ms mean 0
  column '95 % within' ms p95_ms mean 0
  column 'CPU, median' ms cpu_ms mean 0
  column 'peak memory' MiB peak_mib most 0
  studio_visit bird point_cloud.ply
  studio_visit museum point_cloud.compressed.ply
}

# studio_visit SCENE MODEL: a row for every kind of response. The sessions are generated: per view three moving frames, then
# five strokes with a still frame before each. The first stroke is a line through the object, the others go through the
# longest wrong run of pixels.
studio_visit() {
  local log=$work/$1.log report=$work/$1.json kind
  if [ ! -f "$report" ]; then
    say "studio: $1"
    rm -rf "$work/$1"
    tool ngs-studio "$(capture "$1")/$2" --replay "$top/tests/bench/visits/$1.jsonl" -o "$work/$1" \
      --report "$report.part" > /dev/null 2> "$log"
    mv "$report.part" "$report"
  fi
  for kind in 'on a new view' corrections 'frames, moving' 'frames, still'; do
    sed -nE "s/^ *$kind +([0-9]+) responses, median ([0-9.]+) ms, 95th percentile ([0-9.]+) ms; CPU time ([0-9.]+) .*/\
\1 \2 \3 \4/p" "$log" |
      while read -r n median p95 cpu; do
        row scene="$1" answer="$kind" n="$n" median_ms="$median" p95_ms="$p95" cpu_ms="$cpu" times="$report"
      done
  done
}
