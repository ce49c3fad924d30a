# Instead of NgsLibraries.cmake, for Emscripten: one thread, and of third-party libraries only those that are headers.
# What the others do is missing in the module, or done by *_web.cpp.
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(path eigen3/Eigen nlohmann CLI xxhash.h xxh3.h)
  get_filename_component(name ${path} NAME)
  file(CREATE_LINK /usr/include/${path} ${headers}/${name} SYMBOLIC)
endforeach()
include_directories(SYSTEM ${headers} ${CMAKE_CURRENT_LIST_DIR}/../web)  # omp.h, and FLANN's search by our k-d tree
set(NGS_XXHASH_INCLUDE ${headers})
add_compile_options(-Wno-unknown-pragmas -Wno-unused-parameter -include ${CMAKE_CURRENT_LIST_DIR}/../web/ranges.h)
add_library(ngs_eigen INTERFACE)
target_compile_definitions(ngs_eigen INTERFACE EIGEN_DONT_PARALLELIZE EIGEN_DONT_VECTORIZE)
foreach(name OpenMP::OpenMP_CXX nlohmann_json::nlohmann_json OpenEXR::OpenEXR CLI11::CLI11)
  add_library(${name} INTERFACE IMPORTED GLOBAL)
endforeach()
add_library(ngs_compression INTERFACE)
add_library(ngs_opencv INTERFACE)
add_library(ngs_flann INTERFACE)
