#!/usr/bin/env bash
# Builds and runs the stability suite; prints its table and writes stability.json (data-schema/stability.schema.json):
#   tests/bench/stability.sh [--long] [OUT_DIR]      default: build/stability; --long: 20 times the random inputs
# If NGS_BIN is set, runs the suite in this folder and builds nothing.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
seeds=1000
if [ "${1:-}" = "--long" ]; then
  seeds=20000
  shift
fi
out=${1:-$top/build/stability}

if [ -z "${NGS_BIN:-}" ]; then "$pipelines/build.sh" --target test_stability >&2; fi
mkdir -p "$out"
NGS_STABILITY_SEEDS=$seeds NGS_STABILITY_DIR=$out "${NGS_BIN:-$top/build/bin}/test_stability" --minimal --no-intro=true
echo "$out/stability.json"
