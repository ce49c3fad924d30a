# Third-party libraries. Each is linked by exactly the layer that may include it (libngs/CMakeLists.txt).
if(NGS_ONE_PROGRAM)  # needs nothing but the C library where it runs
  set(CMAKE_FIND_LIBRARY_SUFFIXES ${CMAKE_STATIC_LIBRARY_SUFFIX})
endif()
# libgomp is linked statically where it exists as an archive: the tools set its spin count before it starts
# (tools/shared/os/start/thread_wait.cpp), and a binary runs where the compiler's libraries are not installed.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT NGS_SANITIZE)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libgomp.a
    OUTPUT_VARIABLE gomp_archive OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(IS_ABSOLUTE "${gomp_archive}")
    set(OpenMP_gomp_LIBRARY ${gomp_archive} CACHE FILEPATH "the OpenMP runtime of g++")
  endif()
endif()
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(Eigen3 REQUIRED NO_MODULE)
# -j alone says how many threads there are; vectorised, sums would have the order of the processor's vectors.
add_library(ngs_eigen INTERFACE)
target_link_libraries(ngs_eigen INTERFACE Eigen3::Eigen)
target_compile_definitions(ngs_eigen INTERFACE EIGEN_DONT_PARALLELIZE EIGEN_DONT_VECTORIZE)
find_package(nlohmann_json REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Threads REQUIRED)

# OpenCV without its CMake package: Debian ships that only in libopencv-dev, which pulls in 200 packages
# that ngs does not need.
find_path(NGS_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core imgproc imgcodecs)
  find_library(NGS_OPENCV_${module} opencv_${module} REQUIRED)
endforeach()
add_library(ngs_opencv INTERFACE)
target_include_directories(ngs_opencv SYSTEM INTERFACE ${NGS_OPENCV_INCLUDE})
target_link_libraries(ngs_opencv INTERFACE ${NGS_OPENCV_imgproc} ${NGS_OPENCV_core})

find_path(NGS_FLANN_INCLUDE flann/flann.hpp REQUIRED)
find_library(NGS_LZ4 lz4 REQUIRED)  # flann.hpp instantiates its index serialisation inline
add_library(ngs_flann INTERFACE)
target_include_directories(ngs_flann SYSTEM INTERFACE ${NGS_FLANN_INCLUDE})
target_link_libraries(ngs_flann INTERFACE ${NGS_LZ4})

# What the compressed formats of splats are made of.
find_package(ZLIB REQUIRED)
find_path(NGS_ZSTD_INCLUDE zstd.h REQUIRED)
find_library(NGS_ZSTD zstd REQUIRED)
add_library(ngs_compression INTERFACE)
find_path(NGS_WEBP_INCLUDE webp/encode.h REQUIRED)
find_library(NGS_WEBP webp REQUIRED)
find_path(NGS_MINIZIP_INCLUDE minizip/unzip.h REQUIRED)
find_library(NGS_MINIZIP minizip REQUIRED)
target_include_directories(ngs_compression SYSTEM INTERFACE
  ${NGS_ZSTD_INCLUDE} ${NGS_WEBP_INCLUDE} ${NGS_MINIZIP_INCLUDE})
target_link_libraries(ngs_compression INTERFACE ${NGS_MINIZIP} ${NGS_WEBP} ZLIB::ZLIB ${NGS_ZSTD})

# A shared imgcodecs loads the libraries of picture formats itself.
if(NGS_ONE_PROGRAM)
  find_package(TIFF REQUIRED)
  find_package(JPEG REQUIRED)
  find_package(PNG REQUIRED)
  set_property(TARGET TIFF::TIFF APPEND PROPERTY INTERFACE_LINK_LIBRARIES JPEG::JPEG ngs_compression)
  add_library(ngs_imgcodecs STATIC IMPORTED)
  set_target_properties(ngs_imgcodecs PROPERTIES IMPORTED_LOCATION ${NGS_OPENCV_imgcodecs}
    INTERFACE_LINK_LIBRARIES "ngs_opencv;TIFF::TIFF;JPEG::JPEG;PNG::PNG;ngs_compression")
else()
  add_library(ngs_imgcodecs INTERFACE)
  target_link_libraries(ngs_imgcodecs INTERFACE ${NGS_OPENCV_imgcodecs})
endif()

find_path(NGS_XXHASH_INCLUDE xxhash.h REQUIRED)
find_library(NGS_XXHASH xxhash REQUIRED)
