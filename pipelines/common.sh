# Functions that the scripts of this folder share; sourced, never run.
# shellcheck shell=bash

pipelines=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

say() { printf '%s\n' "$*" >&2; }

# fail CODE MESSAGE [HINT]
fail() {
  say "error: $2"
  if [ -n "${3:-}" ]; then say "hint: $3"; fi
  exit "$1"
}

# The folder of the tools: $NGS_BIN, else the build folder's, else nothing (PATH).
find_bin() {
  local folder
  if [ -n "${NGS_BIN:-}" ]; then printf '%s' "$NGS_BIN"; return; fi
  for folder in "$pipelines"/../build/bin "$pipelines"/../build/*/bin; do
    if [ -x "$folder/ngs-scene" ]; then (cd "$folder" && pwd); return; fi
  done
}
