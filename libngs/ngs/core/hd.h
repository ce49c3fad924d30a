#pragma once
// NGS_HD marks a function that compiles for host and device. It is the only CUDA keyword that may appear
// outside backend/ and *.cu.
#if defined(__FAST_MATH__)
#error "ngs guarantees the same bytes on every run: build without -ffast-math"
#endif
#if defined(__CUDACC__)
#define NGS_HD __host__ __device__
#else
#define NGS_HD
#endif
