#!/usr/bin/env bash
# Builds the studio as one page, which needs no server: studio.html, to be opened in a browser.
#
#   pipelines/web.sh [OUT_DIR]      default: build-web
#
# Needs Debian's emscripten (3.1.6), nodejs and ninja-build. Exit code 77 if a program is missing.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
for program in emcmake node ninja; do
  command -v "$program" > /dev/null || { say "SKIP $program is missing, Debian packages emscripten, nodejs, ninja-build"; exit 77; }
done
out=${1:-$top/build-web}
cd "$top"
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}  # of Emscripten, for a node that is not Debian's
emcmake cmake -S . -B "$out" -G Ninja -DCMAKE_BUILD_TYPE=Release > /dev/null
cmake --build "$out" --target studio ${NGS_JOBS:+-j "$NGS_JOBS"}
web=tools/ngs-studio/web
node "$web/pack.mjs" tools/ngs-studio/page "$out/bin/studio" "$out/studio.html"
