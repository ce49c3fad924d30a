#!/usr/bin/env bash
# Builds the tools and tests into build/, for the CPU. Arguments go to `cmake --build`:
#   pipelines/build.sh                       everything
#   pipelines/build.sh --target tools        the tools only; also --target ngs-joint and so on
#   NGS_PRESET=ci pipelines/build.sh         CUDA too if nvcc is found, for sm_80; newer devices compile from PTX at first
#                                            use; NGS_PRESET=cuda for all architectures, into build-cuda/
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
cd "$pipelines/.."
cmake --preset "${NGS_PRESET:-cpu}"
cmake --build --preset "${NGS_PRESET:-cpu}" "$@"
