# What other projects need: the library with headers, CMake and pkg-config files. Layers in the order of linking.
set(NGS_PLUGINS ${CMAKE_INSTALL_LIBDIR}/ngs)
set(layers interactive mesh eval edit methods passes cut field make capture evidence orbit render problem io ops options backend scene core os)
list(TRANSFORM layers PREPEND ngs_ OUTPUT_VARIABLE layer_targets)
install(TARGETS ngs ${layer_targets} ngs_flags ngs_eigen ngs_opencv ngs_flann ngs_compression EXPORT ngsTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS ngs_codecs LIBRARY DESTINATION ${NGS_PLUGINS})
# Whoever links the library loads the codecs' plug-in from where it was installed.
target_link_options(ngs INTERFACE
  $<INSTALL_INTERFACE:-Wl,-rpath,$<INSTALL_PREFIX>/${NGS_PLUGINS}>)
# The headers that docs/library.md names, and what they include.
file(READ ${PROJECT_SOURCE_DIR}/docs/library.md queue)
set(headers "")
while(queue)
  string(REGEX MATCHALL "ngs/[a-z0-9_/]+\\.h" found "${queue}")
  set(queue "")
  list(REMOVE_DUPLICATES found)
  foreach(header ${found})
    if(NOT header IN_LIST headers AND EXISTS ${PROJECT_SOURCE_DIR}/libngs/${header})
      list(APPEND headers ${header})
      file(STRINGS ${PROJECT_SOURCE_DIR}/libngs/${header} includes REGEX "^#include \"ngs/")
      list(APPEND queue ${includes})
      get_filename_component(folder ${header} DIRECTORY)
      install(FILES ${PROJECT_SOURCE_DIR}/libngs/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder})
    endif()
  endforeach()
endwhile()
install(FILES ${PROJECT_BINARY_DIR}/libngs/ngs/core/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ngs/core)

include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/ngs)
install(EXPORT ngsTargets NAMESPACE ngs:: DESTINATION ${package})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/ngsConfig.cmake.in ${PROJECT_BINARY_DIR}/ngsConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ngsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/ngsConfig.cmake ${PROJECT_BINARY_DIR}/ngsConfigVersion.cmake DESTINATION ${package})

file(RELATIVE_PATH NGS_PC_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /.)  # wherever --prefix puts it
set(NGS_PC_LIBS "")
foreach(layer ${layers})
  string(APPEND NGS_PC_LIBS " -lngs_${layer}")
endforeach()
get_target_property(definitions ngs_backend INTERFACE_COMPILE_DEFINITIONS)
if(definitions)
  list(TRANSFORM definitions PREPEND -D)
  list(JOIN definitions " " NGS_PC_DEFINITIONS)
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/ngs.pc.in ${PROJECT_BINARY_DIR}/ngs.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/ngs.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
