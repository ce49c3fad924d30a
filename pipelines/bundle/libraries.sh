# shellcheck shell=bash
# Libraries from Debian's source packages, for ../bundle.sh and windows.sh. Variables of the caller: work (lists, downloads
# and sources), builds (build folders and logs), deps (where libraries are installed), flags (options of CMake).

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
  (
    cd "$work/sources/$name.part"
    if ! apt-get "${options[@]}" --download-only source "$name"; then
      say "bundle: the mirror lacks the newest source package of $name: taking that of the last point release"
      rm -f ./*.dsc
      apt-get "${options[@]}" --download-only source "$name/$codename"
    fi
    dpkg-source -x ./*.dsc tree
  )
  mv "$work/sources/$name.part" "$work/sources/$name"
}

# library NAME [CMAKE OPTION...]: builds a static library into deps/, once.
library() {
  local name=$1
  shift
  if [ -f "$deps/$name.done" ]; then return; fi
  fetch "$name"
  say "bundle: building $name, log in $builds/$name.log"
  {
    cmake -S "$work/sources/$name/tree" -B "$builds/$name" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
      -DCMAKE_INSTALL_PREFIX="$deps" -DCMAKE_PREFIX_PATH="$deps" -DBUILD_TESTING=OFF "${launcher[@]}" "${flags[@]}" "$@" &&
      cmake --build "$builds/$name" && cmake --install "$builds/$name"
  } > "$builds/$name.log" 2>&1 || fail 8 "$name was not built" "see $builds/$name.log"
  touch "$deps/$name.done"
}

launcher=()
if command -v ccache > /dev/null; then launcher=(-DCMAKE_{C,CXX}_COMPILER_LAUNCHER=ccache); fi

# header_only NAME HEADER: cpp-httplib is taken so, without the OpenSSL that Debian's library needs.
header_only() {
  if [ -f "$deps/$1.done" ]; then return; fi
  fetch "$1"
  cp "$work/sources/$1/tree/$2" "$deps/include/"
  touch "$deps/$1.done"
}

# shellcheck disable=SC2034  # for the scripts
# One instruction set, so the same bytes on every processor.
opencv_options=(-DBUILD_LIST=core,imgproc,imgcodecs -DBUILD_{opencv_apps,TESTS,PERF_TESTS,JAVA,ZLIB,PNG,JPEG,TIFF,WEBP}=OFF
  -DENABLE_PRECOMPILED_HEADERS=OFF -DCPU_BASELINE=SSE2 -DCPU_BASELINE_DISABLE=SSE3 -DCPU_DISPATCH= -DOPENCV_DOWNLOAD_TRIES_LIST=
  -DWITH_{JPEG,PNG,TIFF,WEBP}=ON -DPARALLEL_ENABLE_PLUGINS=OFF
  -DWITH_{1394,ADE,EIGEN,FFMPEG,GDAL,GDCM,GSTREAMER,GTK,IPP,ITT,JASPER,LAPACK,OPENCL,OPENEXR,OPENJPEG}=OFF
  -DWITH_{OPENGL,PROTOBUF,PTHREADS_PF,QT,QUIRC,TBB,V4L,VTK}=OFF)
