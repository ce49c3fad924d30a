#!/usr/bin/env bash
# Builds the image of pipelines/Containerfile with buildah, on a Debian 12 of debootstrap instead of one from a registry:
#
#   tests/ci/container.sh [OUT]      OUT: folder of the base and the images (default: build-container)
#
# NGS_DEBIAN_MIRROR=http://... replaces deb.debian.org. A line per check: ok or FAIL. Exit code 1 if a check failed, 77 without
# buildah, debootstrap or the rights that they need.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/ci/shared/checks.sh
. "$top/tests/ci/shared/checks.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
[ "$(id -u)" -eq 0 ] || skip "not root: debootstrap needs it"
for program in debootstrap buildah; do
  command -v "$program" > /dev/null || skip "no $program (Debian: $program)"
done
out=${1:-$top/build-container}
mkdir -p "$out"
out=$(cd "$out" && pwd)
log=$out/log
make_root bookworm "$out/root"
images() { buildah --root "$out/images" --runroot "$out/run" --storage-driver vfs "$@"; }
base=$(images from scratch 2> "$log") || skip "buildah failed: $(cat "$log")"
images add --quiet "$base" "$out/root" / > /dev/null
images commit --quiet --rm "$base" ngs-base > /dev/null
check "the image is built" images build --isolation chroot --build-arg BASE=localhost/ngs-base \
  -f "$top/pipelines/Containerfile" -t ngs "$top"
[ "$failed" -eq 0 ] || exit 1
container=$(images from ngs)
trap 'images rm "$container" > /dev/null' EXIT
# shellcheck disable=SC2317  # called by check
starts_ngs() { [ "$(images inspect --format '{{.OCIv1.Config.Entrypoint}} {{.OCIv1.Config.WorkingDir}}' ngs)" = "[ngs] /work" ]; }
check "it starts ngs, in /work" starts_ngs
check "ngs cuts there, and writes the golden bytes" \
  images run --isolation chroot -v "$top/tests/golden:/golden:ro" "$container" -- /golden/bytes.sh /usr/bin /tmp/golden
check "ngs-gs" images run --isolation chroot "$container" -- ngs-gs /tmp/golden/scene /tmp/golden/gs --hold-out every:4:2 --method flash -q
exit "$failed"
