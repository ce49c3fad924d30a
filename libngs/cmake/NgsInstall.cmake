# What `cmake --install` copies, and `cpack` packs: tools, library with headers, CMake and pkg-config files, pipelines,
# schemas, pages for man and completions, which are written from the tools' option tables as they are installed.
set(NGS_SHARE ${CMAKE_INSTALL_DATADIR}/ngs)

if(NOT NGS_ONE_PROGRAM)
  include(NgsInstallLibrary)
endif()

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data-schema DESTINATION ${NGS_SHARE} FILES_MATCHING PATTERN "*.json")

if(NGS_BUILD_TOOLS)
  install(TARGETS ${NGS_TOOLS} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  if(NGS_LINKS)  # the other names of the one program
    install(FILES ${NGS_LINKS} DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
  # The chain and the loops over data sets; not what builds and tests a checkout.
  set(scripts common.sh ngs-gs.sh sweep.sh work-point.sh nvos.sh lerf-mask.sh scannet.sh)
  list(APPEND scripts sharded.mk variants.mk ablation.mk robustness.mk work-precision.mk)
  list(TRANSFORM scripts PREPEND ${PROJECT_SOURCE_DIR}/pipelines/)
  install(PROGRAMS ${scripts} DESTINATION ${NGS_SHARE}/pipelines)
  # Programs for ngs-mask --segmenter; what they need npm installs.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/pipelines/segmenters DESTINATION ${NGS_SHARE}/pipelines
    PATTERN node_modules EXCLUDE PATTERN .gitignore EXCLUDE)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/ngs-gs.in ${PROJECT_BINARY_DIR}/ngs-gs @ONLY)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/ngs-gs DESTINATION ${CMAKE_INSTALL_BINDIR})

  set(written ${PROJECT_BINARY_DIR}/share)
  install(CODE "execute_process(COMMAND bash \"${PROJECT_SOURCE_DIR}/tools/installed-texts.sh\"
    \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}\" \"${written}\" COMMAND_ERROR_IS_FATAL ANY)")
  install(DIRECTORY ${written}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR})
  install(DIRECTORY ${written}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(DIRECTORY ${written}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  install(DIRECTORY ${written}/fish/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the authors of ngs <ngs@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "make")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libeigen3-dev, libopenexr-dev, nlohmann-json3-dev, zlib1g-dev")
include(CPack)
