# cmake --install build/release --prefix DIR: a tree that may be moved (engine/core/files/shipped.h finds what it needs beside the
# program), and cpack: the same as a Debian package.
include(GNUInstallDirs)
set(ED3R_SHARE "${CMAKE_INSTALL_DATADIR}/ed3r")

install(TARGETS ed3r RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(TARGETS ed3r_video LIBRARY DESTINATION lib/ed3r)
install(DIRECTORY sweeps DESTINATION "${ED3R_SHARE}")
install(DIRECTORY scripts/ DESTINATION "${ED3R_SHARE}/scripts" FILES_MATCHING PATTERN "plot*.py"
  PATTERN calibration EXCLUDE PATTERN detector_training EXCLUDE PATTERN trust_parts EXCLUDE PATTERN __pycache__ EXCLUDE)
# What scripts/setup --web makes, where it was made.
install(DIRECTORY build/web/ DESTINATION "${ED3R_SHARE}/web" OPTIONAL FILES_MATCHING PATTERN "*.js" PATTERN "*.css"
  PATTERN shots EXCLUDE)
install(FILES LICENSE NOTICE README.md CHANGELOG.md CITATION.cff studies/READINGS.md
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/ed3r")
if(TARGET ed3r_python)
  install(TARGETS ed3r_python LIBRARY DESTINATION lib/python3/dist-packages/ed3r)
  install(DIRECTORY engine/python/ed3r/ DESTINATION lib/python3/dist-packages/ed3r
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN py.typed PATTERN __pycache__ EXCLUDE)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ed3r)
set(CPACK_PACKAGE_VENDOR "ED3R experiment engine")
set(CPACK_PACKAGE_CONTACT "the authors of the ED3R experiment engine <see CITATION.cff>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Batch engine for studies of energy-aware wildfire detection by UAVs")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-matplotlib, python3-numpy")
include(CPack)
