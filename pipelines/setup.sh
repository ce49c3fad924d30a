#!/usr/bin/env bash
# Installs missing Debian packages of packages.txt, or of LIST (Debian 12).
# A line is: PACKAGE [COMMAND]. If COMMAND exists, PACKAGE is not installed: npm of another Node.js conflicts with Debian's
# npm.
#   pipelines/setup.sh [LIST]
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
list=${1:-$pipelines/packages.txt}
[ -f "$list" ] || fail 2 "$list: no such list of packages" "see $0 --help"
installed() { dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null | grep -qx installed; }

missing=()
if command -v dpkg-query >/dev/null; then
  while read -r package command; do
    installed "$package" || { [ -n "$command" ] && command -v "$command" >/dev/null; } || missing+=("$package")
  done < <(grep -v '^#' "$list")
else
  fail 8 "not a Debian or Ubuntu system" "install the equivalents of pipelines/packages.txt, then run pipelines/build.sh"
fi
if [ ${#missing[@]} -eq 0 ]; then
  say "setup: all $(grep -vc '^#' "$list") packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    fail 8 "neither root nor sudo" "ask an administrator to run: apt-get install --no-install-recommends ${missing[*]}"
  fi
  as_root=(sudo)
fi
say "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -q -y --no-install-recommends "${missing[@]}"
