#!/usr/bin/env bash
# Makes all files of a release: the archives, the wheel and the Debian package of bundle.sh, the archive for Windows of
# bundle/windows.sh, the source, the lists of contents (SPDX), and SHA-256 sums of all.
#
#   pipelines/release.sh [-o OUT] [--no-cuda] [--no-setup]
#
#   -o, --output OUT   folder of the files (default: release-VERSION in build-bundle/); must not exist
#   --no-cuda          leaves out the archive with CUDA, which needs nvcc 12 or later
#   --no-setup         do not install missing Debian packages
#
# From a clean checkout only. Check the files with tests/ci/bundle.sh OUT and tests/ci/windows-archive.sh OUT before publishing
# them.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

out='' words=() cuda=1
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --output) need "$@"; out=$2; shift 2 ;;
    --no-cuda) cuda=''; shift ;;
    --no-setup) words+=("$1"); shift ;;
    *) fail 2 "unknown word '$1'" "see $0 --help" ;;
  esac
done
version=$(sed -n 's/^project(ngs VERSION \([0-9.]*\).*/\1/p' "$top/CMakeLists.txt")
out=${out:-$top/build-bundle/release-$version}
[ ! -e "$out" ] || fail 2 "$out: exists" "remove it, or choose another folder with -o"
changed=$(git -C "$top" status --porcelain)
[ -z "$changed" ] || fail 4 "the checkout has changes: ${changed%%$'\n'*}" "commit them"

rm -rf "$out.part"
if [ -n "$cuda" ]; then "$pipelines/bundle.sh" --cuda -o "$out.part" "${words[@]}"; fi
"$pipelines/bundle.sh" -o "$out.part" "${words[@]}"
"$pipelines/bundle/windows.sh" -o "$out.part" "${words[@]}"
for folder in "$out.part"/*/; do
  cp "$folder/sbom.spdx.json" "${folder%/}.spdx.json"
  rm -rf "$folder"
done
git -C "$top" archive --prefix="ngs-$version/" HEAD | gzip -9n > "$out.part/ngs-$version.tar.gz"
(cd "$out.part" && LC_ALL=C sha256sum -- * > SHA256SUMS)
mv "$out.part" "$out"
cat "$out/SHA256SUMS"
