# Cross compilation for Windows x86-64 with Debian's g++-mingw-w64-x86-64-posix. NGS_WINDOWS_DEPS, as a variable of CMake or
# of the environment, is the folder of libraries that pipelines/bundle/windows.sh builds.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
if(NOT NGS_WINDOWS_DEPS)
  set(NGS_WINDOWS_DEPS "$ENV{NGS_WINDOWS_DEPS}")
endif()
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES NGS_WINDOWS_DEPS)
set(CMAKE_FIND_ROOT_PATH "${NGS_WINDOWS_DEPS}" /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# Windows 10 or later; printf of the C standard. The stack of Windows x64 is aligned to 16 bytes and g++ does not align
# spilled vectors of 32 bytes (GCC bug 54412), so no move of a vector may require alignment.
foreach(language C CXX)
  set(CMAKE_${language}_FLAGS_INIT
    "-D_WIN32_WINNT=0x0A00 -D__USE_MINGW_ANSI_STDIO=1 -DNOMINMAX -Wa,-muse-unaligned-vector-move -Wa,-mbig-obj")
endforeach()
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -Wl,--no-insert-timestamp")  # equal sources, equal bytes
set(CMAKE_SHARED_LINKER_FLAGS_INIT ${CMAKE_EXE_LINKER_FLAGS_INIT})
