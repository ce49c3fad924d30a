#!/usr/bin/env bash
# Builds the tools and tests into build/ (preset ci: CUDA where nvcc is found, for sm_80, from which newer devices compile at
# first use; preset cuda has all architectures). Arguments go to `cmake --build`:
#   pipelines/build.sh                       everything
#   pipelines/build.sh --target tools        the tools only; also --target ngs-joint and so on
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
cd "$pipelines/.."
cmake --preset ci
cmake --build --preset ci "$@"
