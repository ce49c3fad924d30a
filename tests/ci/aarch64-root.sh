#!/usr/bin/env bash
# Unpacks the arm64 packages of Debian 12 that ngs depends on into a folder: sysroot of the preset aarch64, and root of
# qemu-aarch64 for running the tools. Installs nothing on this machine. Keeps a complete folder.
#   tests/ci/aarch64-root.sh ROOT
#   NGS_DEBIAN_MIRROR=http://... uses this mirror instead of deb.debian.org
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; '') fail 2 "no folder" "see $0 --help" ;; esac
mkdir -p "$1"
root=$(cd "$1" && pwd)
mapfile -t packages < <({ grep -E '^lib.*-dev$' "$pipelines/packages.txt" && printf '%s\n' \
  doctest-dev nlohmann-json3-dev zlib1g-dev libc6-dev libstdc++-12-dev bash coreutils; } | LC_ALL=C sort)
wanted=$(printf '%s\n' "${packages[@]}")
if [ "$(cat "$root/.ngs-packages" 2> /dev/null)" = "$wanted" ]; then say "aarch64: $root is complete"; exit 0; fi
if ! command -v apt-get > /dev/null; then
  fail 8 "not a Debian or Ubuntu system" "unpack the equivalents of pipelines/packages.txt for arm64 into $root"
fi

apt="$root.apt"
mkdir -p "$apt"/{lists/partial,cache/archives/partial,empty,parts}
: > "$apt/status"
printf 'deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] %s bookworm main\n' \
  "${NGS_DEBIAN_MIRROR:-http://deb.debian.org/debian}" > "$apt/sources.list"
of_arm64=(-q -o APT::Architecture=arm64 -o APT::Architectures::=arm64 -o Dir::State="$apt" -o Dir::State::lists="$apt/lists"
  -o Dir::State::status="$apt/status" -o Dir::Cache="$apt/cache" -o Dir::Etc::SourceList="$apt/sources.list"
  -o Dir::Etc::SourceParts="$apt/empty" -o Dir::Etc::Parts="$apt/parts" -o Debug::NoLocking=1 -o APT::Sandbox::User=root
  -o APT::Install-Recommends=0)
apt-get "${of_arm64[@]}" update >&2
apt-get "${of_arm64[@]}" install -y --download-only "${packages[@]}" >&2
for package in "$apt"/cache/archives/*.deb; do dpkg-deb -x "$package" "$root"; done
# Make absolute links relative, so that they stay inside the root.
find "$root" -type l -lname '/*' -printf '%p\t%l\n' | while IFS=$'\t' read -r link to; do
  ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" "$root$to")" "$link"
done
# Alternatives that the packages' scripts would select, for OpenCV.
for library in blas/libblas.so.3 lapack/liblapack.so.3; do ln -sfn "$library" "$root/usr/lib/aarch64-linux-gnu/"; done
printf '%s\n' "$wanted" > "$root/.ngs-packages"
rm -rf "$apt"
say "aarch64: $root: $(du -sh "$root" | cut -f1)"
