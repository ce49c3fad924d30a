#!/usr/bin/env bash
# Builds and runs the stability suite; prints its table and writes stability.json (data-schema/stability.schema.json)
# and stability.html, one page without network or scripts:
#   pipelines/stability.sh [--long] [OUT_DIR]      default: build/stability; --long: 20 times the random inputs
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
seeds=1000
if [ "${1:-}" = "--long" ]; then
  seeds=20000
  shift
fi
out=${1:-$here/../build/stability}

"$here/build.sh" --target test_stability >&2
mkdir -p "$out"
NGS_STABILITY_SEEDS=$seeds NGS_STABILITY_DIR=$out "$here/../build/bin/test_stability" --minimal --no-intro=true
echo "$out/stability.html"
