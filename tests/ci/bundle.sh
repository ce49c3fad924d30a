#!/usr/bin/env bash
# Tests the files of pipelines/bundle.sh on bare systems without network, which contain a C library and a shell:
#
#   tests/ci/bundle.sh [DIR] [SUITE...]      DIR: folder of the files (default: build-bundle)
#
# SUITE is a Debian release (default: bookworm trixie), or the path of a root folder. debootstrap makes the roots of releases
# in build-bundle/roots/ and keeps them. NGS_DEBIAN_MIRROR=http://... replaces deb.debian.org; with that of Ubuntu
# (http://archive.ubuntu.com/ubuntu) SUITE may be jammy. In each root:
#   the archive  runs from its folder, loads only the C library, and writes the results of tests/golden/golden.sha256;
#                that with CUDA, if it is in DIR, does the same without a driver
#   the package  is installed by dpkg, runs, and leaves no file when purged
# and here, in an empty environment of Python without network:
#   the wheel    is installed by pip, cuts with the program and with the module, and leaves no file when uninstalled
# A line per check: ok or FAIL. Exit code 1 if a check failed, 77 without debootstrap or rights for chroot.
set -euo pipefail
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../../pipelines/common.sh"
# shellcheck source=tests/ci/shared/checks.sh
. "$top/tests/ci/shared/checks.sh"

case ${1:-} in -h | --help) usage_of "$0"; exit 0 ;; esac
files=$(cd "${1:-$top/build-bundle}" && pwd)
suites=("${@:2}")
[ ${#suites[@]} -gt 0 ] || suites=(bookworm trixie)
archive=$(find "$files" -maxdepth 1 -name 'ngs-*-linux-x86_64.tar.xz') wheel=$(find "$files" -maxdepth 1 -name '*.whl')
package=$(find "$files" -maxdepth 1 -name 'ngs_*.deb') cuda_archive=$(find "$files" -maxdepth 1 -name 'ngs-*-cuda.tar.xz')
for file in "$archive" "$wheel" "$package"; do
  [ -f "$file" ] || fail 3 "$files: '$file', expected one archive, one wheel and one package" "make them with pipelines/bundle.sh"
done
[ "$(id -u)" -eq 0 ] || skip "not root: debootstrap and chroot need it"
work=$top/build-bundle/test log=$top/build-bundle/test/log
rm -rf "$work"
mkdir -p "$work" "$top/build-bundle/roots"

# root_of SUITE: prints the root folder of a release; makes it if it does not exist.
root_of() {
  local root=$top/build-bundle/roots/$1
  if [ -d "$1" ]; then (cd "$1" && pwd); return; fi
  make_root "$1" "$root"
  echo "$root"
}

# shellcheck disable=SC2317  # called by check
only_the_c_library() {  # BIN
  ! inside sh -c "ldd $1/ngs" | grep -vE '(linux-vdso|/lib(64)?/.*(libc|libm|ld-linux-x86-64))\.so'
}

# shellcheck disable=SC2317  # called by check
refuses_cuda() {  # REASON
  local code=0 text
  text=$(inside /opt/ngs/bin/ngs-variance /tmp/golden/draft/scene.json -o /tmp/golden/cuda.ply --device cuda 2>&1) || code=$?
  echo "exit code $code: $text"
  [ "$code" -eq 8 ] && [[ $text == *"error: --device cuda: $1"* ]]
}

test_archive() {  # NAME ROOT ARCHIVE REASON: a root folder with /opt/golden; why there is no GPU
  rm -rf "$2/opt/ngs"
  mkdir "$2/opt/ngs"
  tar -xJf "$3" -C "$2/opt/ngs" --strip-components=1
  check "$1: ngs --version" inside /opt/ngs/bin/ngs --version
  check "$1: loads only the C library" only_the_c_library /opt/ngs/bin
  check "$1: writes the golden bytes" inside /opt/golden/bytes.sh /opt/ngs/bin /tmp/golden
  check "$1: --device cuda ends with 8, $4" refuses_cuda "$4"
  check "$1: ngs-gs" inside /opt/ngs/bin/ngs-gs /tmp/golden/scene /tmp/golden/gs --hold-out every:4:2 --method flash -q
}

test_root() {  # SUITE ROOT
  local root=$2 before
  inside() { unshare -n chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root NGS_THREADS=2 "$@"; }
  lists() { inside sh -c 'find /usr /etc -path "*ngs*" | grep -vE "/(perl|locale|zoneinfo)|/usr/include" | LC_ALL=C sort'; }
  mkdir -p "$root/proc" "$root/opt/golden"
  mount -t proc proc "$root/proc" || skip "no right to mount /proc"
  # shellcheck disable=SC2064  # the root of now
  trap "umount '$root/proc'" EXIT
  cp "$top/tests/golden/bytes.sh" "$top/tests/golden/golden.sha256" "$root/opt/golden/"
  cp "$package" "$root/opt/ngs.deb"
  if [ -n "$cuda_archive" ]; then
    test_archive "$1, the archive with CUDA" "$root" "$cuda_archive" "no device: no NVIDIA driver is installed"
  fi
  test_archive "$1, the archive" "$root" "$archive" "this build has no CUDA"
  before=$(lists)
  check "$1: dpkg installs the package, which needs the C library only" inside dpkg -i /opt/ngs.deb
  check "$1: the package loads only the C library" only_the_c_library /usr/bin
  check "$1: the package cuts" inside ngs cut /tmp/golden/scene --quality draft -o /tmp/golden/cut
  check "$1: dpkg purges the package" inside dpkg --purge ngs
  check "$1: the purge leaves no file" test "$before" = "$(lists)"
  rm -rf "$root/opt/ngs" "$root/opt/ngs.deb" "$root/opt/golden" "$root/tmp/golden"
  umount "$root/proc"
  trap - EXIT
}

test_wheel() {
  local venv=$work/venv
  python3 -m venv "$venv" > "$work/venv.log" 2>&1 || { say "SKIP the wheel: python3 -m venv failed, see $work/venv.log"; return; }
  installed() { find "$venv" | LC_ALL=C sort; }
  installed > "$work/before"
  # shellcheck disable=SC2317  # called by check
  alone() { (cd "$work" && unshare -n env -i PATH="$venv/bin:/usr/bin:/bin" NGS_THREADS=2 "$@"); }
  check "wheel: pip installs it without network" \
    alone pip install --no-index --no-compile --disable-pip-version-check "$wheel"
  check "wheel: ngs-synth" alone ngs-synth two-spheres -o scene --view-count 4 --width-px 96 --height-px 72 --fit-steps 60
  check "wheel: ngs cut" alone ngs cut scene --quality draft -o cut
  check "wheel: import ngs" alone python3 -B -c 'if True:
    import ngs
    report = ngs.run("extract", "cut/labelled.ply", object_ply="again.ply")
    assert report["tool"] == "ngs-extract", report
    assert ngs.read_ply("again.ply")["x"] == ngs.read_ply("cut/object.ply")["x"]'
  check "wheel: pip uninstalls it" alone pip uninstall -y --disable-pip-version-check ngs-tools
  installed > "$work/after"
  check "wheel: pip uninstall leaves no file" cmp "$work/before" "$work/after"
}

for suite in "${suites[@]}"; do
  root=$(root_of "$suite")
  test_root "$(basename "$suite")" "$root"
done
test_wheel
exit "$failed"
