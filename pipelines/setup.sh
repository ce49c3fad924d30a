#!/usr/bin/env bash
# Installs the Debian packages of packages.txt, or of the list given, that are missing (Debian 12, Ubuntu 22.04 and later).
# A line is a package, and behind it the command, if any, that makes it unnecessary where somebody else has installed it: the
# npm of a foreign Node.js cannot stand beside Debian's.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
list=${1:-$here/packages.txt}

say() { echo "setup: $*" >&2; }
installed() { dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null | grep -qx installed; }

missing=()
if command -v dpkg-query >/dev/null; then
  while read -r package command; do
    installed "$package" || { [ -n "$command" ] && command -v "$command" >/dev/null; } || missing+=("$package")
  done < <(grep -v '^#' "$list")
else
  say "error: this is no Debian or Ubuntu; install the equivalents of pipelines/packages.txt, then run pipelines/build.sh"
  exit 8
fi
if [ ${#missing[@]} -eq 0 ]; then
  say "all $(grep -vc '^#' "$list") packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    say "error: neither root nor sudo; ask an administrator to run: apt-get install --no-install-recommends ${missing[*]}"
    exit 8
  fi
  as_root=(sudo)
fi
say "installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -q -y --no-install-recommends "${missing[@]}"
