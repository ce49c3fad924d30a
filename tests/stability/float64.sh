#!/usr/bin/env bash
# The float pipeline against a double build of the same source: every `float` of the library and of three tools becomes
# `double` (build-float64/), then both builds run one chain and are compared.
#   tests/stability/float64.sh                                          builds only; the whole loss against differences
#   tests/stability/float64.sh SCENE.json GT_DIR [options of ngs-joint] and the chain: labels, boundary IoU
# Needs a finished build/ (pipelines/build.sh). Float remain: file contents and the depth sort key.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
wide=$root/build-float64
mkdir -p "$wide/source" "$wide/out"
rm -rf "$wide/fresh"
mkdir "$wide/fresh"
cp -r "$root"/{CMakeLists.txt,libngs,tools} "$wide/fresh/"
mkdir -p "$wide/fresh/tests"
cp -r "$root"/tests/{support,grad} "$wide/fresh/tests/"

(
  cd "$wide/fresh"
  find . \( -name '*.cu' -o -name '*.cuh' \) -delete
  : >libngs/ngs/ops/splat/isa/tile_isa_v4.cpp
  printf '#pragma once\n#include "ngs/math/lanes.h"\nnamespace ngs { using PortablePack = PackF; }\n' \
    >libngs/ngs/math/lanes_portable.h
  float_files='libngs/ngs/io/[a-z]*/(ply|ply_scan|ply_types|ply_writer|npy|exr|safetensors)\.(h|cpp)|ngs/math/(lanes|lanes16|lanes_[a-z0-9]+|lane_scalar|elementary)\.h|tests/support/ply_text\.h'
  find libngs tools tests \( -name '*.h' -o -name '*.cpp' \) | grep -v -E "$float_files" | xargs sed -E -i \
    -e '/bit_cast<std::uint32_t>/!s/\bfloat\b/double/g' \
    -e '/bit_cast<std::uint32_t>/!s/(^|[^A-Za-z0-9_.])([0-9]+\.[0-9]*([eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+)f\b/\1\2/g'
  # Records written to files, and images passed to OpenCV.
  sed -E -i -e 's/double row\[62\]/float row[62]/; s/double\* at = row/float* at = row/; s/sizeof\(double\)/sizeof(float)/' \
    libngs/ngs/io/ply/gaussian_ply_write.cpp
  sed -i 's/CV_32F/CV_64F/' libngs/ngs/io/image/image_file.cpp
  perl -0 -i -pe 's/plane\.value\.data =\s*std::move\((.*?second)\);/const auto& found = $1; plane.value.data.assign(found.begin(), found.end());/s' \
    libngs/ngs/io/image/masks.cpp
  sed -E -i 's/(image\.channels\[.*\]) = plane\(k\);/{ const auto p = plane(k); \1.assign(p.begin(), p.end()); }/' \
    tools/ngs-render/render_output.cpp
  sed -i '/static_assert(sizeof values\[0\] == 4);/d' libngs/ngs/io/ply/query_ply.cpp
  sed -i 's/bit_cast<std::uint32_t>(plane/bit_cast<std::uint64_t>(plane/g' libngs/ngs/scene/rle_masks.cpp
  sed -i 's/__builtin_bit_cast(double, std::int32_t/__builtin_bit_cast(float, std::int32_t/' libngs/ngs/math/stable.h
  # Remove the duplicates of explicit float and double instantiations.
  perl -0 -i -pe 's/(template class PhotometricPass<double, double>;\n)\1/$1/' libngs/ngs/ops/losses/photometric_impl.cpp
  perl -0 -i -pe 's/(std::int64_t first_unusable\([^}]*\}\n)\1/$1/' libngs/ngs/ops/optim/adam.cpp
  sed -i -e '/add_subdirectory(tests)/d' CMakeLists.txt
  {
    cat "$root/tests/stability/float64_lanes.h"
    printf 'namespace ngs {\n'
    sed -n '/^struct Pack4D/,/^};/p' "$root/libngs/ngs/math/lanes_avx2.h"
    printf 'inline Pack4D low_half(PackF x) { return Pack4D::Raw{x.v[0], x.v[1], x.v[2], x.v[3]}; }\n'
    printf 'inline Pack4D high_half(PackF x) { return Pack4D::Raw{x.v[4], x.v[5], x.v[6], x.v[7]}; }\n}\n'
  } >libngs/ngs/math/lanes.h
  find . -type f | while read -r file; do  # unchanged files keep their time stamps
    cmp -s "$file" "$wide/source/$file" || install -D -m 644 "$file" "$wide/source/$file"
  done
)

cmake -S "$wide/source" -B "$wide/build" -G Ninja -DNGS_WITH_CUDA=OFF -DNGS_BUILD_TESTS=OFF -DNGS_WERROR=OFF \
  -DCMAKE_BUILD_TYPE=Float64 -DCMAKE_CXX_FLAGS_FLOAT64="-O2 -DNDEBUG -w" >/dev/null
ninja -C "$wide/build" ngs_passes ngs-variance ngs-joint ngs-render >&2
flags=(-std=c++20 -O2 -march=x86-64-v3 -ffp-contract=off -fno-math-errno -fopenmp -w)
own=("$wide"/build/libngs/libngs_{passes,cut,field,make,capture,evidence,orbit,render,problem,ops,backend,options,scene,core}.a -llz4)
g++ "${flags[@]}" -DDOCTEST_CONFIG_SUPER_FAST_ASSERTS -I"$wide/source/tests" -I"$wide/source/libngs" -I"$wide/build/libngs" \
  "$wide"/source/tests/{grad/joint_grad_test,support/adjoint,support/doctest_main}.cpp "${own[@]}" -o "$wide/joint_grad"
echo "the whole loss in double against extrapolated differences:"
"$wide/joint_grad" --minimal | sed -n 's/.*MESSAGE: /  /p'

[ $# -ge 2 ] || exit 0
scene=$1 truth=$2
shift 2
g++ "${flags[@]}" -I"$root/libngs" -I"$root/build/libngs" "$root/tests/stability/compare_labels.cpp" \
  "$root"/build/libngs/libngs_{io,options,scene,core}.a -lopencv_core -lopencv_imgproc -lopencv_imgcodecs -lxxhash \
  $(pkg-config --libs OpenEXR) -o "$wide/compare_labels"
for build in build build-float64/build; do
  bin=$root/$build/bin out=$wide/out/${build%%/*}
  mkdir -p "$out"
  "$bin/ngs-variance" "$scene" -o "$out/boundary.ply" -w -q >/dev/null
  decided=()
  if [ "$build" != build ]; then decided=(--effects-from "$wide/out/build/joint.json"); fi
  TIMEFORMAT="$build: ngs-joint %U CPU s"
  time "$bin/ngs-joint" "$scene" "$out/boundary.ply" "$@" "${decided[@]}" -o "$out/labelled.ply" -w -q \
    --report "$out/joint.json" || [ $? -eq 7 ]
  "$bin/ngs-render" "$scene" "$out/labelled.ply" --views held-out --layers mask --scale 0 -o "$out/masks" -w -q >/dev/null
  "$root/build/bin/ngs-eval" "$out/masks" "$truth" -o "$out/metrics.json" -w
done
"$wide/compare_labels" "$wide"/out/build/labelled.ply "$wide"/out/build-float64/labelled.ply
