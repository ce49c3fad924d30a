# kernels: cost of the inner loops, and gain by vector instructions
# shellcheck shell=bash disable=SC2154
question_kernels() {
  title 'CPU time, one thread, medians of nine, first view of bird; pairs of a pixel and a Gaussian that contributes to it'
  without_options
  label kernel kernel
  column 'one lane of double' ms cpu_ms mean 3g isa=double
  column x86-64-v3 ms cpu_ms mean 3g isa=v3
  column x86-64-v4 ms cpu_ms mean 3g isa=v4
  column 'v3' '10⁶ pairs/s' mega_pairs_s mean 0 isa=v3
  column 'v4' '10⁶ pairs/s' mega_pairs_s mean 0 isa=v4
  local bird
  bird=$(capture bird)
  if [ ! -f "$work/benchmark.json" ]; then
    prepare scene "$bird" --masks "$bird/masks_sam" --hold-out every:4:2
    NGS_BENCH_SCENE=$work/scene/scene.json tool ngs_bench \
      --benchmark_filter='(forward|backward)/|_view' --benchmark_repetitions=9 \
      --benchmark_min_time=0.1 --benchmark_enable_random_interleaving=true --benchmark_report_aggregates_only=true \
      --benchmark_out="$work/benchmark.part" --benchmark_out_format=json >&2
    mv "$work/benchmark.part" "$work/benchmark.json"
  fi
  line rows benchmark "$work/benchmark.json"
}
