#!/usr/bin/env bash
# Cross-compiles the tools for Windows x86-64 and packs them as an archive that needs no DLL beyond those of Windows:
#
#   pipelines/bundle/windows.sh [-o OUT] [--no-setup]
#
#   -o, --output OUT   where ngs-VERSION-windows-x86_64/ and its .zip are written (default: build-bundle)
#   --no-setup         do not install missing Debian packages
#
# The compiler is Debian's g++-mingw-w64-x86-64-posix. All libraries are built from Debian's source packages, or are headers
# of Debian packages: components-windows.txt lists them. They are kept in build-bundle/ for the next call, as for
# ../bundle.sh. The same commit, packages and folder give the same bytes.
set -euo pipefail
shopt -s inherit_errexit
# shellcheck source=pipelines/common.sh
. "$(dirname "$0")/../common.sh"

# shellcheck source=pipelines/bundle/arguments.sh
. "$pipelines/bundle/arguments.sh"
[ -z "$variant" ] || fail 2 "--cuda: is an option of bundle.sh only" "see $0 --help"
builds=$work/windows deps=$work/windows/deps
mkdir -p "$out" "$deps/include" "$deps/lib"
out=$(cd "$out" && pwd)
if [ -n "$setup" ]; then
  "$pipelines/setup.sh"
  "$pipelines/setup.sh" "$pipelines/bundle/packages-windows.txt"
fi

# --- libraries ------------------------------------------------------------------------------------------------------------

# shellcheck source=pipelines/bundle/libraries.sh
. "$pipelines/bundle/libraries.sh"
export NGS_WINDOWS_DEPS=$deps
toolchain=$top/libngs/cmake/mingw.cmake prefix=x86_64-w64-mingw32
flags=(-DCMAKE_TOOLCHAIN_FILE="$toolchain" -DCMAKE_INSTALL_LIBDIR=lib
  -DCMAKE_{C,CXX}_FLAGS_RELEASE="-O2 -DNDEBUG -ffunction-sections -fdata-sections -ffile-prefix-map=$work=.")

# archive PACKAGE LIBRARY FOLDER SOURCES HEADERS [FLAG...]: compiles C files of a source package into a static library, once.
# FOLDER is that of the headers in include/; SOURCES and HEADERS are patterns.
archive() {
  local package=$1 name=$2 folder=$3 sources=$4 headers=$5 source objects
  shift 5
  if [ -f "$deps/$package.done" ]; then return; fi
  fetch "$package"
  say "windows: building $package"
  objects=$builds/$package
  mkdir -p "$objects" "$deps/include/$folder"
  (
    cd "$work/sources/$package/tree"
    for source in $sources; do
      $prefix-gcc-posix -c -O2 -DNDEBUG -ffunction-sections -fdata-sections -ffile-prefix-map="$work=." -I. "$@" \
        "$source" -o "$objects/$(basename "$source").o"
    done
    rm -f "$deps/lib/lib$name.a"
    $prefix-ar rcs "$deps/lib/lib$name.a" "$objects"/*.o
    # shellcheck disable=SC2086  # patterns
    cp $headers "$deps/include/$folder/"
  )
  touch "$deps/$package.done"
}

# headers PACKAGE: copies the headers and CMake files of a Debian package.
headers() {
  local file
  dpkg -L "$1" | grep -E '^/usr/(include|share/(eigen3/)?cmake|share/cmake)/' | while read -r file; do
    if [ -f "$file" ]; then install -D -m 644 "$file" "$deps${file#/usr}"; fi
  done
}

archive zlib z . '*.c' 'zlib.h zconf.h'
archive libzstd zstd . 'lib/common/*.c lib/compress/*.c lib/decompress/*.c' 'lib/*.h' -DZSTD_DISABLE_ASM
archive lz4 lz4 . 'lib/lz4.c lib/lz4hc.c' 'lib/lz4.h lib/lz4hc.h'
archive xxhash xxhash . xxhash.c 'xxhash.h xxh3.h'
archive minizip minizip minizip 'zip.c unzip.c ioapi.c' 'zip.h unzip.h ioapi.h crypt.h' -I"$deps/include"
for package in libeigen3-dev libcli11-dev nlohmann-json3-dev libflann-dev; do headers "$package"; done
library libpng1.6 -DPNG_{SHARED,TESTS}=OFF
library libjpeg-turbo -DCMAKE_INSTALL_LIBDIR="$deps/lib" -DENABLE_SHARED=OFF -DWITH_TURBOJPEG=OFF -DREQUIRE_SIMD=ON
library libwebp -DWEBP_BUILD_{ANIM_UTILS,CWEBP,DWEBP,GIF2WEBP,IMG2WEBP,VWEBP,WEBPINFO,WEBPMUX,EXTRAS}=OFF
library tiff -Dtiff-{tools,tests,contrib,docs}=OFF -D{jbig,lerc,lzma,webp,libdeflate,cxx}=OFF
library imath
library openexr -DOPENEXR_{BUILD_TOOLS,INSTALL_EXAMPLES,INSTALL_TOOLS}=OFF
library opencv "${opencv_options[@]}" -DOPENCV_{LIB,3P_LIB}_INSTALL_PATH=lib -DOPENCV_INCLUDE_INSTALL_PATH=include \
  -DWITH_{WIN32UI,DIRECTX,DSHOW,MSMF}=OFF
for file in "$deps"/lib/libopencv_*[0-9].a; do  # the names have the version
  if [ -f "$file" ]; then mv "$file" "$(printf '%s' "$file" | sed 's/[0-9]*\.a$/.a/')"; fi
done
header_only cpp-httplib httplib.h

# --- the program ------------------------------------------------------------------------------------------------------------

say "windows: building the tools"
build=$top/build-windows-program
CXXFLAGS=-fmacro-prefix-map=$top/= \
  cmake -S "$top" -B "$build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DNGS_ONE_PROGRAM=ON \
  -DNGS_WERROR="${NGS_WERROR:-OFF}" -DCMAKE_PREFIX_PATH="$deps" -DNGS_HTTPLIB_INCLUDE="$deps/include" -DNGS_HTTPLIB= \
  > "$builds/tools.log"
cmake --build "$build" --target tools
version=$(sed -n 's/.*kVersion = "\(.*\)".*/\1/p' "$build/libngs/ngs/core/version.h")
name=ngs-$version-windows-x86_64
stage=$out/$name
rm -rf "$stage" "$stage.zip"
mkdir -p "$stage/bin" "$stage/share/ngs/data-schema"
cp "$build"/bin/ngs*.exe "$build/bin/ngs.dll" "$stage/bin/"
$prefix-strip "$stage"/bin/*
cp "$top"/data-schema/*.json "$stage/share/ngs/data-schema/"

foreign=$($prefix-objdump -p "$stage"/bin/ngs.{exe,dll} | awk '/DLL Name/ { print tolower($3) }' | sort -u |
  grep -vxE '(kernel32|msvcrt|ws2_32|ngs)\.dll' || true)
[ -z "$foreign" ] || fail 1 "bin/: needs $foreign, expected libraries of Windows only"

# --- pages, licences, list of contents ---------------------------------------------------------------------------------------

# shellcheck source=pipelines/bundle/contents.sh
. "$pipelines/bundle/contents.sh"
add_contents "$stage" "$version" "$pipelines/bundle/components-windows.txt"
sed "s/@NAME@/$name/g" "$pipelines/bundle/README-windows.txt" | sed 's/$/\r/' > "$stage/README.txt"
chmod -R u=rwX,go=rX "$stage"
find "$stage" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
(cd "$out" && find "$name" ! -type d | LC_ALL=C sort | TZ=UTC zip -q -X -9 "$name.zip" -@)
say "$stage: $(du -sk "$stage" | cut -f 1) KiB"
stat -c '%s bytes: %n' "$stage.zip" >&2
