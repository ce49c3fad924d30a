# One place for compiler flags. No fast-math and no contraction: a fused product is written fma() where it
# is wanted, so that every build of one source gives the same numbers.
add_library(ngs_flags INTERFACE)
# What every translation unit may take for granted: on x86-64 AVX2 and FMA, or nothing (portable: the program starts on
# every x86-64); elsewhere what the compiler does, which on aarch64 has NEON. The compositing kernels also exist for what
# the processor may have beyond that (libngs/CMakeLists.txt). Results are the same for all.
set(NGS_ISA "" CACHE STRING "instruction set on x86-64: x86-64-v3 (default) or portable")
if(NGS_ISA AND NOT NGS_ISA MATCHES "^(x86-64-v3|portable)$")
  message(FATAL_ERROR "NGS_ISA=${NGS_ISA}: expected x86-64-v3 or portable")
endif()
set(NGS_X86_64 OFF)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(NGS_X86_64 ON)
  if(NGS_ISA STREQUAL "portable")
    set(NGS_TARGET_FLAGS -march=x86-64)
  else()
    set(NGS_TARGET_FLAGS -march=x86-64-v3)
  endif()
elseif(EMSCRIPTEN)
  set(NGS_TARGET_FLAGS -msimd128 -fwasm-exceptions -pthread)
else()
  set(NGS_TARGET_FLAGS -fsigned-char)  # as on x86-64
endif()
target_compile_options(ngs_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wconversion -ffp-contract=off -fno-math-errno ${NGS_TARGET_FLAGS}>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # g++ 12 warns about its own std::string operator+ (GCC bug 105651)
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict -Wno-stringop-overflow -Wno-array-bounds>)
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # Masks of lanes are combined by & and |; for the pack of one lane, whose mask is a bool, clang asks for && and ||.
  # Signs are no part of what g++ calls -Wconversion.
  target_compile_options(ngs_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-bitwise-instead-of-logical -Wno-sign-conversion>)
endif()
# ngs_of_this_system(LIST): without the sources of other systems. In the browser, X_web.cpp replaces X.cpp or X_posix.cpp.
function(ngs_of_this_system list)
  set(sources ${${list}})
  foreach(source ${sources})
    if(EMSCRIPTEN AND source MATCHES "_web\\.cpp$")
      string(REPLACE "_web.cpp" ".cpp" replaced ${source})
      string(REPLACE "_web.cpp" "_posix.cpp" replaced_posix ${source})
      list(REMOVE_ITEM sources ${replaced} ${replaced_posix})
    endif()
  endforeach()
  set(others "_(windows|web)\\.cpp$")
  if(WIN32)
    set(others "_(posix|web)\\.cpp$")
  elseif(EMSCRIPTEN)
    set(others "_windows\\.cpp$|/io/mesh/")  # ngs-mesh is not in the module
  endif()
  list(FILTER sources EXCLUDE REGEX ${others})
  set(${list} ${sources} PARENT_SCOPE)
endfunction()
if(NGS_WERROR)
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
endif()
# Sources that are mostly headers (JSON, strings) compile in batches, at about half of the time. Not the ops: their
# kernels take long by themselves, and single files spread better over cores.
option(NGS_UNITY "compile in batches and with precompiled headers; OFF: every file by itself" ON)
# Further arguments: sources that stay by themselves, as a name of theirs stands for something else in another file.
function(ngs_compile_in_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${NGS_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
# ngs_precompile(TARGET [HEADER...]): JSON, the standard library and HEADER, compiled once for TARGET. JSON alone takes a
# file 2 s to read. ngs_precompiled(TARGET OTHER): as OTHER, which has the same flags.
function(ngs_precompile target)
  if(NGS_UNITY)
    target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <fstream>
      <functional> <iostream> <limits> <map> <memory> <nlohmann/json.hpp> <numeric> <optional> <set> <span> <sstream>
      <string> <string_view> <vector> ${ARGN})
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)  # for ccache
  endif()
endfunction()
function(ngs_precompiled target other)
  if(NGS_UNITY)
    target_precompile_headers(${target} REUSE_FROM ${other})
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  endif()
endfunction()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
if(NGS_SANITIZE)
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${NGS_SANITIZE} -fno-omit-frame-pointer>)
  string(REPLACE "fuzzer-no-link," "" NGS_SANITIZE_LINK "${NGS_SANITIZE}")
  target_link_options(ngs_flags INTERFACE -fsanitize=${NGS_SANITIZE_LINK})
endif()
