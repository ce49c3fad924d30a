# One place for compiler flags. No fast-math and no contraction: a fused product is written fma() where it
# is wanted, so that every build of one source gives the same numbers.
add_library(ngs_flags INTERFACE)
target_compile_options(ngs_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wconversion -ffp-contract=off -fno-math-errno -march=x86-64-v3>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # g++ 12 warns about its own std::string operator+ (GCC bug 105651)
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # masks of lanes are combined by & and |; for the pack of one lane, whose mask is a bool, clang asks for && and ||
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-bitwise-instead-of-logical>)
endif()
if(NGS_WERROR)
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
if(NGS_SANITIZE)
  target_compile_options(ngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${NGS_SANITIZE} -fno-omit-frame-pointer>)
  string(REPLACE "fuzzer-no-link," "" NGS_SANITIZE_LINK "${NGS_SANITIZE}")
  target_link_options(ngs_flags INTERFACE -fsanitize=${NGS_SANITIZE_LINK})
endif()
