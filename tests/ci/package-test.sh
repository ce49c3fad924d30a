#!/usr/bin/env bash
# Packs ngs as a .deb, installs it with its dependencies on a bare Debian 12, runs the chain there, and removes it:
#   tests/ci/package-test.sh [ROOT]           ROOT: folder of the bare system, made by debootstrap if empty and kept
#                                              for the next call; default: build/package-root
#   NGS_DEBIAN_MIRROR=http://... uses this mirror instead of deb.debian.org; NGS_BUILD=DIR uses this build instead of build/
# A line per check: ok or FAIL. Exit code 1 if a check failed, 77 without debootstrap, rights for chroot, or mirror.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/ci/shared/checks.sh
. "$top/tests/ci/shared/checks.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
build=$(cd "${NGS_BUILD:-$top/build}" && pwd)
root=${1:-$build/package-root}
command -v cpack > /dev/null || skip "no cpack (Debian: cmake)"
command -v dpkg-shlibdeps > /dev/null || skip "no dpkg-shlibdeps (Debian: dpkg-dev)"
command -v debootstrap > /dev/null || skip "no debootstrap (Debian: debootstrap)"
[ "$(id -u)" -eq 0 ] || skip "not root: debootstrap and chroot need it"

mkdir -p "$root"
root=$(cd "$root" && pwd)
make_root bookworm "$root"

rm -f "$build"/ngs_*.deb
(cd "$build" && cpack -G DEB > cpack.log 2>&1) || fail 1 "cpack failed" "see $build/cpack.log"
package=$(find "$build" -maxdepth 1 -name 'ngs_*.deb')
log=$build/package-test.log
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive HOME=/root "$@"; }
lists() { inside sh -c 'find /usr /etc /var/lib/dpkg/info -name "*ngs-*" -o -path "*/ngs/*" | grep -v "/perl" | LC_ALL=C sort'; }

inside dpkg --purge ngs > /dev/null 2>&1 || true
before=$(lists)
mount -t proc proc "$root/proc" || skip "no right to mount /proc, which programs need to find their folder"
trap 'umount "$root/proc"' EXIT
cp /etc/resolv.conf "$root/etc/resolv.conf"
cp "$package" "$root/ngs.deb"
check "apt-get update" inside apt-get update
check "apt install ./$(basename "$package") with its dependencies" inside apt-get install -y --no-install-recommends ./ngs.deb make
check "ngs-joint --version" inside ngs-joint --version
check "all libraries are found" inside sh -c '! ldd /usr/bin/ngs-joint /usr/bin/ngs-scene $(find /usr/lib -name libngs_codecs.so) | grep "not found"'
check "ngs-synth makes a capture" inside ngs-synth torus-box -o /tmp/scene -w --view-count 8 --width-px 96 --height-px 72 --fit-steps 60 -q
check "ngs-gs runs the whole chain" inside ngs-gs /tmp/scene /tmp/out --gt /tmp/scene/masks_gt --hold-out every:4:2 --quality draft -q
for made in object.ply background.ply metrics.json report.html masks/0002.png; do
  check "$made was made" test -s "$root/tmp/out/$made"
done
check "man pages are installed" sh -c "test -s '$root'/usr/share/man/man1/ngs-joint.1*"
for made in bash-completion/completions/ngs-joint zsh/vendor-completions/_ngs fish/vendor_completions.d/ngs-joint.fish; do
  check "/usr/share/$made is installed" test -s "$root/usr/share/$made"
done
check "apt purge removes the package" inside apt-get purge -y ngs
check "apt purge leaves no files" test "$before" = "$(lists)"
rm -rf "$root/tmp/scene" "$root/tmp/out" "$root/ngs.deb"
exit "$failed"
