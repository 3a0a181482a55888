# cmake --install, find_package(handloop) and the Debian package.
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY HANDLOOP_LIBRARIES)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/handloop")

install(TARGETS ${libraries} EXPORT handloopTargets
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
        FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/handloop" COMPONENT development)
install(EXPORT handloopTargets NAMESPACE handloop:: DESTINATION "${package_dir}" COMPONENT development)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/handloopConfig.cmake.in" "${PROJECT_BINARY_DIR}/handloopConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/handloopConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/handloopConfig.cmake" "${PROJECT_BINARY_DIR}/handloopConfigVersion.cmake"
              "${CMAKE_CURRENT_LIST_DIR}/HandloopDependencies.cmake"
        DESTINATION "${package_dir}" COMPONENT development)

install(TARGETS handloop RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/scenes" DESTINATION "${CMAKE_INSTALL_DATADIR}/handloop" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/packaging/handloop.bash" RENAME handloop
        DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program
        FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME copyright COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT development
        PATTERN "build" EXCLUDE)

# ---- cpack: one .deb with the program, the libraries and the scenes --------------------------------------------------
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME handloop)
set(CPACK_PACKAGE_VENDOR "handloop")
set(CPACK_PACKAGE_CONTACT "handloop maintainers <handloop@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
    "Puts a simulated hand in the loop of a haptic device: tunes controllers, states\n stability margins over measured human arms, and traces what a model lacks.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # what the program is linked with
set(CPACK_DEBIAN_PACKAGE_DEPENDS gnuplot-nox)
# What building against the libraries needs: every -dev package the build itself needs.
file(STRINGS "${PROJECT_SOURCE_DIR}/packaging/packages.txt" packages REGEX "^lib.*-dev$|^nlohmann-json3-dev$")
list(REMOVE_ITEM packages libgtest-dev libbenchmark-dev)
list(JOIN packages ", " packages)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "${packages}")
set(CPACK_STRIP_FILES ON)
include(CPack)
