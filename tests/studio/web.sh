#!/usr/bin/env bash
# Tests studio.html, the studio without a server (pipelines/web.sh): opens it from the disk, gives it splats that the tool
# refuses and one that it reads, draws a stroke, grows the selection, exports; the native engine repeats the requests and
# must write the same bytes. Then the visit of run.sh, without what needs the tools. One line per check: ok or FAIL.
#
#   tests/studio/web.sh [OUT_DIR]
#
# OUT_DIR (default: build/studio) has the scene and the packages of run.sh, which runs first if they are missing. Exit code
# 1 if a check failed, 77 if a required program is missing.
set -uo pipefail
unset CDPATH
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=${NGS_BIN:-$root/build/bin}
out=${1:-$root/build/studio}
page=${NGS_WEB:-$root/build-web}/studio.html
chromium=${NGS_CHROMIUM:-/usr/bin/chromium}

command -v "$chromium" > /dev/null || { echo "SKIP $chromium is missing, Debian package chromium"; exit 77; }
"$root/pipelines/web.sh" "$(dirname "$page")" || exit
if [ ! -d "$out/node_modules/playwright-core" ] || [ ! -f "$out/capture/point_cloud.ply" ]; then
  "$here/run.sh" "$out" || exit
fi
rm -rf "$out/web" "$out/visit"
mkdir -p "$out/web" "$out/visit" "$out/pictures"
cp "$out/capture/point_cloud.ply" "$out/web/ring.ply"
failed=0
for script in web visit; do
  PATH=$bin:$PATH node "$here/$script.mjs" --modules "$out/node_modules" --chromium "$chromium" --folder "$out" --page "$page" ||
    failed=1
done
exit "$failed"
