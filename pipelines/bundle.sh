#!/usr/bin/env bash
# Packs the tools as an archive that runs on Linux without installation, and as a Python wheel and a Debian package with the
# same program; for x86-64 with glibc 2.35 or later:
#
#   pipelines/bundle.sh [--cuda] [-o OUT] [--no-setup]
#
#   --cuda             packs an archive of the tools with CUDA instead, without wheel and package; needs nvcc 12 or later
#   -o, --output OUT   where ngs-VERSION-linux-x86_64/, its .tar.xz, the .whl and the .deb are written, or
#                      ngs-VERSION-linux-x86_64-cuda/ and its .tar.xz (default: build-bundle)
#   --no-setup         do not install missing Debian packages
#
# All tools are one program, linked with archives: bundle/components.txt lists what it contains. Debian's archives are used
# where they need no further libraries; the others are built from Debian's source packages, which apt-get downloads and
# verifies. They are kept in build-bundle/ for the next call. NGS_DEBIAN_MIRROR=http://... replaces deb.debian.org.
# The same commit, packages and folder give the same bytes: OpenCV stores where it was built.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

# shellcheck source=pipelines/bundle/arguments.sh
. "$pipelines/bundle/arguments.sh"
mkdir -p "$out" "$work/deps"
out=$(cd "$out" && pwd) deps=$work/deps builds=$work
if [ -n "$setup" ]; then
  "$pipelines/setup.sh"
  "$pipelines/setup.sh" "$pipelines/bundle/packages.txt"
fi

# --- libraries from source ----------------------------------------------------------------------------------------------

# shellcheck source=pipelines/bundle/libraries.sh
. "$pipelines/bundle/libraries.sh"
# No build path in a file; -O2 as in Debian's own packages.
flags=(-DCMAKE_{C,CXX}_FLAGS_RELEASE="-O2 -DNDEBUG -ffunction-sections -fdata-sections -ffile-prefix-map=$work=.")

library tiff -Dtiff-{tools,tests,contrib,docs}=OFF -D{jbig,lerc,lzma,webp,libdeflate,cxx}=OFF -DCMAKE_FIND_LIBRARY_SUFFIXES=.a
library imath
library openexr -DOPENEXR_{BUILD_TOOLS,INSTALL_EXAMPLES,INSTALL_TOOLS}=OFF
library opencv "${opencv_options[@]}"
header_only cpp-httplib httplib.h

# --- the program ----------------------------------------------------------------------------------------------------------

say "bundle: building the tools"
build=$top/build-one-program$variant  # next to build/, so that a compiler cache knows most of its objects
CXXFLAGS=-fmacro-prefix-map=$top/= \
  cmake -S "$top" -B "$build" -G Ninja -DNGS_ONE_PROGRAM=ON -DNGS_BUILD_TESTS=OFF -DNGS_WERROR="${NGS_WERROR:-OFF}" \
  -DNGS_WITH_CUDA="$([ -n "$variant" ] && echo ON || echo OFF)" \
  -DCMAKE_PREFIX_PATH="$deps" -DCMAKE_INSTALL_LIBDIR=lib -DNGS_HTTPLIB_INCLUDE="$deps/include" -DNGS_HTTPLIB= \
  > "$work/tools.log"
cmake --build "$build" --target tools
version=$("$build/bin/ngs" --version --json | sed -n 's/.*"version": "\(.*\)".*/\1/p')
name=ngs-${version%%+*}-linux-$(uname -m)$variant
stage=$out/$name
rm -rf "$stage" "$out"/ngs-*-"$(uname -m)$variant".tar.xz
cmake --install "$build" --prefix "$stage" --strip > "$work/install.log"

foreign=$(objdump -p "$stage/bin/ngs" | awk '/NEEDED/ && $2 !~ /^(libc|libm|ld-linux-x86-64)\.so\.[0-9]+$/ { print $2 }')
[ -z "$foreign" ] || fail 1 "bin/ngs: needs $foreign, expected the C library only"

# --- pages, licences, list of contents -----------------------------------------------------------------------------------

# shellcheck source=pipelines/bundle/contents.sh
. "$pipelines/bundle/contents.sh"
components=("$pipelines/bundle/components.txt") cuda=''
if [ -n "$variant" ]; then
  # shellcheck source=pipelines/bundle/toolkit.sh
  . "$pipelines/bundle/toolkit.sh"
  components+=("$pipelines/bundle/components-cuda.txt")
fi
add_contents "$stage" "$version" "${components[@]}"
glibc=$(objdump -T "$stage/bin/ngs" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
glibc=${glibc#GLIBC_}
sed "s/@NAME@/$name/g; s/@GLIBC@/$glibc/g; ${cuda:+s/@CUDA@/$cuda/;}/@CUDA@/d" "$pipelines/bundle/README.txt" \
  > "$stage/README.txt"
chmod -R u=rwX,go=rX "$stage"

tar -C "$out" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -cf - "$name" | xz -9e -T1 > "$stage.tar.xz"
say "$stage: $(du -sk "$stage" | cut -f 1) KiB"
stat -c '%s bytes: %n' "$stage.tar.xz" >&2
if [ -n "$variant" ]; then exit 0; fi

# --- the wheel and the package ------------------------------------------------------------------------------------------------

rm -f "$out"/ngs_*.whl "$out"/ngs_*.deb
wheel=$(python3 "$pipelines/bundle/wheel.py" "$stage" "$pipelines/python" "${version%%+*}" \
  "manylinux_${glibc/./_}_$(uname -m)" "$out")
(cd "$build" && cpack -B "$work/cpack" > "$work/cpack.log" && cp "$work"/cpack/ngs_*.deb "$out/")
stat -c '%s bytes: %n' "$wheel" "$out"/ngs_*.deb >&2
