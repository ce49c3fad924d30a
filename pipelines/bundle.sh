#!/usr/bin/env bash
# Packs the tools as an archive that runs on Linux without installation, and as a Python wheel and a Debian package with the
# same program; for x86-64 with glibc 2.35 or later:
#
#   pipelines/bundle.sh [-o OUT] [--no-setup]
#
#   -o, --output OUT   where ngs-VERSION-linux-x86_64/, its .tar.xz, the .whl and the .deb are written (default:
#                      build-bundle)
#   --no-setup         do not install missing Debian packages
#
# All tools are one program, linked with archives: bundle/components.txt lists what it contains. Debian's archives are used
# where they need no further libraries; the others are built from Debian's source packages, which apt-get downloads and
# verifies. They are kept in build-bundle/ for the next call. NGS_DEBIAN_MIRROR=http://... replaces deb.debian.org.
# The same commit and packages give the same bytes.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/common.sh"

work=$top/build-bundle out='' setup=1
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage_of "$0"; exit 0 ;;
    -o | --output) need "$@"; out=$2; shift 2 ;;
    --no-setup) setup=''; shift ;;
    *) fail 2 "unknown word '$1'" "see $0 --help" ;;
  esac
done
out=${out:-$work}
mkdir -p "$out" "$work/deps"
out=$(cd "$out" && pwd) deps=$work/deps
if [ -n "$setup" ]; then
  "$pipelines/setup.sh"
  "$pipelines/setup.sh" "$pipelines/bundle/packages.txt"
fi

# --- libraries from source ----------------------------------------------------------------------------------------------

# fetch NAME: unpacks Debian's source package into sources/NAME, once. Its lists and downloads stay in this folder.
fetch() {
  local name=$1 codename mirror=${NGS_DEBIAN_MIRROR:-http://deb.debian.org/debian} options
  if [ -d "$work/sources/$name" ]; then return; fi
  codename=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
  mkdir -p "$work"/apt/{lists,cache,parts}
  printf 'deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] %s main\n' "$mirror $codename" \
    "http://deb.debian.org/debian-security $codename-security" > "$work/apt/sources.list"
  options=(-q -o "Dir::Etc::SourceList=$work/apt/sources.list" -o "Dir::Etc::SourceParts=$work/apt/parts"
    -o "Dir::State::Lists=$work/apt/lists" -o "Dir::Cache=$work/apt/cache" -o APT::Sandbox::User=)
  if [ ! -f "$work/apt/updated" ]; then apt-get "${options[@]}" update && touch "$work/apt/updated"; fi
  mkdir -p "$work/sources/$name.part"
  (cd "$work/sources/$name.part" && apt-get "${options[@]}" --download-only source "$name" && dpkg-source -x ./*.dsc tree)
  mv "$work/sources/$name.part" "$work/sources/$name"
}

# library NAME [CMAKE OPTION...]: builds a static library into deps/, once.
library() {
  local name=$1
  shift
  if [ -f "$deps/$name.done" ]; then return; fi
  fetch "$name"
  say "bundle: building $name, log in $work/$name.log"
  {
    cmake -S "$work/sources/$name/tree" -B "$work/$name" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
      -DCMAKE_INSTALL_PREFIX="$deps" -DCMAKE_PREFIX_PATH="$deps" -DBUILD_TESTING=OFF "${launcher[@]}" "${flags[@]}" "$@" &&
      cmake --build "$work/$name" && cmake --install "$work/$name"
  } > "$work/$name.log" 2>&1 || fail 8 "$name was not built" "see $work/$name.log"
  touch "$deps/$name.done"
}

launcher=()
if command -v ccache > /dev/null; then launcher=(-DCMAKE_{C,CXX}_COMPILER_LAUNCHER=ccache); fi
# No build path in a file; -O2 as in Debian's own packages.
flags=(-DCMAKE_{C,CXX}_FLAGS_RELEASE="-O2 -DNDEBUG -ffunction-sections -fdata-sections -ffile-prefix-map=$work=.")

library tiff -Dtiff-{tools,tests,contrib,docs}=OFF -D{jbig,lerc,lzma,webp,libdeflate,cxx}=OFF -DCMAKE_FIND_LIBRARY_SUFFIXES=.a
library imath
library openexr -DOPENEXR_{BUILD_TOOLS,INSTALL_EXAMPLES,INSTALL_TOOLS}=OFF
# One instruction set, so the same bytes on every processor.
library opencv -DBUILD_LIST=core,imgproc,imgcodecs -DBUILD_{opencv_apps,TESTS,PERF_TESTS,JAVA,ZLIB,PNG,JPEG,TIFF,WEBP}=OFF \
  -DENABLE_PRECOMPILED_HEADERS=OFF -DCPU_BASELINE=SSE2 -DCPU_BASELINE_DISABLE=SSE3 -DCPU_DISPATCH= -DOPENCV_DOWNLOAD_TRIES_LIST= \
  -DWITH_{JPEG,PNG,TIFF,WEBP}=ON -DPARALLEL_ENABLE_PLUGINS=OFF \
  -DWITH_{1394,ADE,EIGEN,FFMPEG,GDAL,GDCM,GSTREAMER,GTK,IPP,ITT,JASPER,LAPACK,OPENCL,OPENEXR,OPENJPEG}=OFF \
  -DWITH_{OPENGL,PROTOBUF,PTHREADS_PF,QT,QUIRC,TBB,V4L,VTK}=OFF
if [ ! -f "$deps/cpp-httplib.done" ]; then  # a header only, without the OpenSSL that Debian's library needs
  fetch cpp-httplib
  cp "$work/sources/cpp-httplib/tree/httplib.h" "$deps/include/"
  touch "$deps/cpp-httplib.done"
fi

# --- the program ----------------------------------------------------------------------------------------------------------

say "bundle: building the tools"
build=$top/build-one-program  # next to build/, so that a compiler cache knows most of its objects
cmake -S "$top" -B "$build" -G Ninja -DNGS_ONE_PROGRAM=ON -DNGS_BUILD_TESTS=OFF -DNGS_WERROR="${NGS_WERROR:-OFF}" \
  -DCMAKE_PREFIX_PATH="$deps" -DCMAKE_INSTALL_LIBDIR=lib -DNGS_HTTPLIB_INCLUDE="$deps/include" -DNGS_HTTPLIB= \
  > "$work/tools.log"
cmake --build "$build" --target tools
version=$("$build/bin/ngs" --version --json | sed -n 's/.*"version": "\(.*\)".*/\1/p')
name=ngs-${version%%+*}-linux-$(uname -m)
stage=$out/$name
rm -rf "$stage" "$out"/ngs-*.tar.xz "$out"/ngs_*.whl "$out"/ngs_*.deb
cmake --install "$build" --prefix "$stage" --strip > "$work/install.log"

foreign=$(objdump -p "$stage/bin/ngs" | awk '/NEEDED/ && $2 !~ /^(libc|libm|ld-linux-x86-64)\.so\.[0-9]+$/ { print $2 }')
[ -z "$foreign" ] || fail 1 "bin/ngs: needs $foreign, expected the C library only"

# --- pages, licences, list of contents ---------------------------------------------------------------------------------

doc=$stage/share/doc/ngs
for page in $(cd "$top" && ls -d README.md BENCHMARKS.md docs/*.md docs/images docs/decisions tools/*.md tools/*/*.md \
  pipelines/README.md data-schema/*.md); do
  mkdir -p "$doc/$(dirname "$page")"
  cp -R "$top/$page" "$doc/$page"
done
# Times in the archive: that of the commit.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$top" log -1 --format=%ct 2> /dev/null || stat -c %Y "$top/CHANGELOG.md")}
export SOURCE_DATE_EPOCH
mkdir -p "$stage/licences"
cp "$top/LICENSE" "$stage/licences/ngs"
while read -r component words; do
  package=${words##* }
  case $package in
    source) cp "$work/sources/$component/tree/debian/copyright" "$stage/licences/$component" ;;
    *) cp "/usr/share/doc/$package/copyright" "$stage/licences/$component" ;;
  esac
done < <(grep -v '^#' "$pipelines/bundle/components.txt")
python3 "$pipelines/bundle/sbom.py" "$pipelines/bundle/components.txt" "$work/sources" "$version" > "$stage/sbom.spdx.json"
glibc=$(objdump -T "$stage/bin/ngs" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
glibc=${glibc#GLIBC_}
sed "s/@NAME@/$name/g; s/@GLIBC@/$glibc/g" "$pipelines/bundle/README.txt" > "$stage/README.txt"
chmod -R u=rwX,go=rX "$stage"

tar -C "$out" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -cf - "$name" | xz -9e -T1 > "$stage.tar.xz"
wheel=$(python3 "$pipelines/bundle/wheel.py" "$stage" "$pipelines/python" "${version%%+*}" \
  "manylinux_${glibc/./_}_$(uname -m)" "$out")
(cd "$build" && cpack -B "$work/cpack" > "$work/cpack.log" && cp "$work"/cpack/ngs_*.deb "$out/")
say "$stage: $(du -sk "$stage" | cut -f 1) KiB"
stat -c '%s bytes: %n' "$stage.tar.xz" "$wheel" "$out"/ngs_*.deb >&2
