# CUDA is an addition, never a requirement, and compiles for minutes per architecture: it is asked for. AUTO compiles it
# where a working nvcc of version 12 or later (C++20) is found; ON demands it.
option(NGS_CUDA_FMAD "let nvcc contract products and sums" OFF)
option(NGS_CUDA_REPORT "print registers, spills and shared memory of every kernel" OFF)
set(NGS_CUDA_ENABLED OFF)
if(NOT NGS_WITH_CUDA STREQUAL "OFF")
  find_program(NGS_NVCC nvcc HINTS $ENV{CUDA_HOME}/bin /usr/local/cuda/bin)
  if(NGS_NVCC)
    if(NOT CMAKE_CUDA_ARCHITECTURES)
      execute_process(COMMAND ${NGS_NVCC} --list-gpu-arch OUTPUT_VARIABLE known)
      foreach(architecture 80 86 89 90 100 120)  # where the compiler knows them
        if(known MATCHES "compute_${architecture}[\r\n]")
          list(APPEND CMAKE_CUDA_ARCHITECTURES ${architecture}-real)
          set(newest ${architecture})
        endif()
      endforeach()
      list(APPEND CMAKE_CUDA_ARCHITECTURES ${newest}-virtual)  # PTX, from which drivers compile for later devices
    endif()
    set(ENV{CUDACXX} ${NGS_NVCC})
    include(CheckLanguage)
    check_language(CUDA)  # compiles a program: the host compiler may be too new for this nvcc
  endif()
  if(CMAKE_CUDA_COMPILER)
    enable_language(CUDA)
    if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
      set(CMAKE_CUDA_STANDARD 20)
      set(CMAKE_CUDA_STANDARD_REQUIRED ON)
      if(NOT DEFINED CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25 knows nvcc only up to C++17
        set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
        set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
      endif()
      set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
      set(NGS_CUDA_ENABLED ON)
      # Of one architecture only: among those of a release are some where the scan of CUB 3.0 spills 4 bytes.
      set(warn_spills "")
      if(CMAKE_CUDA_ARCHITECTURES MATCHES "^[0-9]+$")
        set(warn_spills -Xptxas=-warn-spills)
      endif()
      # What is fused is written fma(), on a device as on the CPU (NgsFlags.cmake): without contraction both compute the
      # same bits (docs/gpu.md), and the emulation of the tests says what a device will compute.
      target_compile_options(ngs_flags INTERFACE
        $<$<COMPILE_LANGUAGE:CUDA>:--fmad=$<IF:$<BOOL:${NGS_CUDA_FMAD}>,true,false>
        -Xcompiler=-Wall,-Wextra,-ffp-contract=off,-fno-math-errno,${NGS_TARGET_FLAGS}>
        $<$<COMPILE_LANGUAGE:CUDA>:${warn_spills}>
        $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${NGS_WERROR}>>:-Werror=all-warnings -Xcompiler=-Werror>
        $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${NGS_CUDA_REPORT}>>:-Xptxas=-v>)
      set(CMAKE_CUDA_FLAGS_RELEASE "-O3 -DNDEBUG")
    endif()
  endif()
  if(NGS_WITH_CUDA STREQUAL "ON" AND NOT NGS_CUDA_ENABLED)
    message(FATAL_ERROR "NGS_WITH_CUDA=ON but no working nvcc >= 12 was found; set CUDA_HOME or use -DNGS_WITH_CUDA=OFF")
  endif()
endif()
message(STATUS "ngs: CUDA backend ${NGS_CUDA_ENABLED}")
