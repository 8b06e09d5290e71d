# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where, and the Debian package of it. Nothing that is installed knows where: programs
# and library find the rest from where they lie (base/files/data.h), so the tree can be moved.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(data ${CMAKE_INSTALL_DATADIR}/tetlap)

install(TARGETS tetlap RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS tetlap-overlap EXPORT tetlap-overlap LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS tetlap-run LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES include/tetlap/overlap.h include/tetlap/model.h include/tetlap/run.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tetlap)

# Data, under the names of the source tree.
install(DIRECTORY net/weights DESTINATION ${data}/net)
install(DIRECTORY app/stress/scenes DESTINATION ${data}/app/stress)
install(FILES python/tetlap/serve.py DESTINATION ${data}/python/tetlap)
install(PROGRAMS tools/ranks DESTINATION ${data}/tools)
install(DIRECTORY examples meshes DESTINATION ${data})
install(FILES docs/scene.schema.json DESTINATION ${data}/docs)

# Documents and licences.
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs)
install(FILES README.md CHANGELOG.md LICENSE cmake/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES net/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME LICENSE.Apache-2.0)
install(FILES report/LICENSES DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME LICENSES.report)

# Manual pages and completion, printed by the program from the tables of its commands.
set(pages ${CMAKE_BINARY_DIR}/pages)
add_custom_command(OUTPUT ${pages}/man/man1/tetlap.1
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${pages}/bash-completion/completions ${pages}/zsh/vendor-completions ${pages}/fish/vendor_completions.d
  COMMAND tetlap completion bash > ${pages}/bash-completion/completions/tetlap
  COMMAND tetlap completion zsh > ${pages}/zsh/vendor-completions/_tetlap
  COMMAND tetlap completion fish > ${pages}/fish/vendor_completions.d/tetlap.fish
  COMMAND tetlap help --man -o ${pages}/man/man1
  DEPENDS tetlap VERBATIM)
add_custom_target(pages ALL DEPENDS ${pages}/man/man1/tetlap.1)
install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_DATAROOTDIR})

# The Python package.
install(DIRECTORY python/tetlap DESTINATION lib/python3/dist-packages FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN __pycache__ EXCLUDE)

# For those that build against the libraries.
file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(library tetlap-overlap tetlap-run)
  configure_file(cmake/${library}.pc.in ${CMAKE_BINARY_DIR}/${library}.pc @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/${library}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/tetlap-overlap)
install(EXPORT tetlap-overlap NAMESPACE tetlap:: FILE tetlap-overlap-config.cmake DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/tetlap-overlap-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_BINARY_DIR}/tetlap-overlap-config-version.cmake DESTINATION ${package})

# `cpack --config build/release/CPackConfig.cmake` makes tetlap_VERSION_ARCHITECTURE.deb.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tetlap)
set(CPACK_PACKAGE_VENDOR tetlap)
set(CPACK_PACKAGE_CONTACT "The tetlap maintainers <maintainers@tetlap.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# gmsh is loaded where a mesh is read or made, so dpkg-shlibdeps does not see it: libgmsh.so.4.8 is in libgmsh4.8.
get_source_file_property(gmsh_name fem/mesh/reader/gmsh_library.c COMPILE_DEFINITIONS)
string(REGEX REPLACE ".*libgmsh\\.so\\.([0-9.]+).*" "libgmsh\\1" CPACK_DEBIAN_PACKAGE_DEPENDS "${gmsh_name}")
# PETSc is loaded where a scene asks for it: libpetsc_real.so.3.18 is in libpetsc-real3.18.
get_source_file_property(petsc_name fem/sparse/petsc/petsc_library.c COMPILE_DEFINITIONS)
string(REGEX REPLACE ".*libpetsc_real\\.so\\.([0-9.]+).*" "libpetsc-real\\1" petsc_package "${petsc_name}")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "${petsc_package}, gnuplot-nox, libmicrohttpd12, python3-numpy")
include(CPack)
