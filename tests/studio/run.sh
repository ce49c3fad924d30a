#!/usr/bin/env bash
# Tests the page of ngs-studio in a real browser: open, turn, paint, correct, undo, a second object, export; with mouse,
# touch and keyboard, from 390 to 1600 px wide, light and dark. One line per check: ok or FAIL.
#
#   tests/studio/run.sh [OUT_DIR]
#
# Installs playwright-core of package-lock.json into OUT_DIR (default: build/studio) and writes pictures of the page to
# OUT_DIR/pictures. Tools: $NGS_BIN, or build/bin. Exit code 1 if a check failed, 77 if a required program is missing.
set -uo pipefail
unset CDPATH
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=${NGS_BIN:-$root/build/bin}
out=${1:-$root/build/studio}
chromium=${NGS_CHROMIUM:-/usr/bin/chromium}

skip() { printf 'SKIP %s\n' "$*"; exit 77; }
# require PROGRAM PACKAGE
require() { command -v "$1" > /dev/null || skip "$1 is missing, Debian package $2"; }

require node nodejs
require npm npm
require "$chromium" chromium
for tool in ngs ngs-studio ngs-synth ngs-scene ngs-variance ngs-joint ngs-extract; do
  [ -x "$bin/$tool" ] || skip "$bin/$tool is not built"
done
mkdir -p "$out"
out=$(cd "$out" && pwd)

if ! cmp -s "$here/package-lock.json" "$out/package-lock.json" || [ ! -d "$out/node_modules/playwright-core" ]; then
  cp "$here/package.json" "$here/package-lock.json" "$out/"
  (cd "$out" && timeout 300 npm ci --no-audit --no-fund > npm.log 2>&1) ||
    { rm -f "$out/package-lock.json"; skip "npm ci failed, see $out/npm.log"; }
fi

# A ring through a box in front of a plain wall, with the poses of twelve photos.
capture=$out/capture
if [ ! -f "$out/scene.json" ]; then
  rm -rf "$capture"
  "$bin/ngs-synth" torus-box -o "$capture" --view-count 12 --width-px 320 --height-px 240 --fit-steps 800 -q > /dev/null &&
    "$bin/ngs-scene" import "$capture" -o "$out/scene.json" -q > /dev/null ||
    { echo "FAIL the test scene was not made"; exit 1; }
fi

rm -rf "$out/pictures" "$out/visit"
mkdir -p "$out/pictures" "$out/visit"
PATH=$bin:$PATH node "$here/visit.mjs" --modules "$out/node_modules" --chromium "$chromium" --folder "$out"
