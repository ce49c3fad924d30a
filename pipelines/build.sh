#!/usr/bin/env bash
# Builds the tools and tests into build/ (preset ci: CUDA where nvcc is found, for sm_80, from which newer devices compile at
# first use; preset cuda has all architectures). Arguments go to `cmake --build`:
#   pipelines/build.sh                       everything
#   pipelines/build.sh --target tools        the tools only; also --target ngs-joint and so on
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cmake --preset ci
cmake --build --preset ci "$@"
