#!/usr/bin/env bash
# Writes options/ and report/ from the built tools: data-schema/regenerate.sh [BIN_DIR]
set -euo pipefail
unset CDPATH
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=${1:-$here/../build/bin}

rm -rf "$here/options" "$here/report"
mkdir -p "$here/options" "$here/report"
for folder in "$here"/../tools/ngs/ "$here"/../tools/ngs-*/; do
  tool=$(basename "$folder")
  [ "$tool" != ngs-studio ] || [ -x "$bin/$tool" ] || continue  # left out where cpp-httplib is not installed
  "$bin/$tool" --print-commands | while read -r command; do
    file=$tool${command:+-$command}.schema.json
    "$bin/$tool" ${command:+"$command"} --print-schema >"$here/options/$file"
    "$bin/$tool" ${command:+"$command"} --print-schema report >"$here/report/$file"
  done
done
