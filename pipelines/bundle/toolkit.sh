# shellcheck shell=bash
# Versions and licences of what `bundle.sh --cuda` takes from NVIDIA's CUDA toolkit, into sources/NAME/{version,licence}. Sets
# cuda, the version of the runtime. Variables of the caller: build, work.

toolkit=$(dirname "$(dirname "$(realpath "$(sed -n 's/^NGS_NVCC:.*=//p' "$build/CMakeCache.txt")")")")

# value_of MACRO FILE: the number that a header defines.
value_of() { awk -v name="$1" '$1 == "#define" && $2 == name { print $3; exit }' "$2"; }

number=$(value_of CUDART_VERSION "$toolkit/include/cuda_runtime_api.h")
cuda=$((number / 1000)).$((number % 1000 / 10))
# NVIDIA's installer and its wheels name the licence differently.
licence=$(find -L "$toolkit" -name EULA.txt -o -path '*/nvidia_cuda_runtime-*/License.txt' | sort | head -n 1)
[ -n "$licence" ] || fail 3 "$toolkit: contains no EULA.txt, which the archive must contain" "install the toolkit's documentation"
mkdir -p "$work"/sources/{cuda-runtime,cccl}
echo "$cuda" > "$work/sources/cuda-runtime/version"
cp "$licence" "$work/sources/cuda-runtime/licence"

cccl=$toolkit/include/cccl  # before CUDA 13: include/
[ -d "$cccl" ] || cccl=$toolkit/include
number=$(value_of CUB_VERSION "$cccl/cub/version.cuh")
echo "$((number / 100000)).$((number / 100 % 1000)).$((number % 100))" > "$work/sources/cccl/version"
{ sed '/\*\//q' "$cccl/cub/cub.cuh"; echo; cat /usr/share/common-licenses/Apache-2.0; } > "$work/sources/cccl/licence"
