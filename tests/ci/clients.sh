#!/usr/bin/env bash
# Installs programs that read our files (COLMAP, Chromium, npm's splat-transform and viewers, EXR tools), builds, and runs
# all checks of tests/clients; writes screenshots of the viewers to build/clients/screenshots.
#
#   tests/ci/clients.sh [--no-setup] [--only REGEX]
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
if [ "${1:-}" = --no-setup ]; then
  shift
else
  "$pipelines/setup.sh"
  "$pipelines/setup.sh" "$top/tests/ci/packages-clients.txt"
  "$pipelines/build.sh"
fi
"$top/tests/clients/run.sh" "$@"
