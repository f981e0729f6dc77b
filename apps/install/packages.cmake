# Debian packages `nlos` and `libnlos-dev`, of this build: for others to use, configure by the preset
# `package`, which is portable.
set(CPACK_PACKAGE_NAME nlos)
set(CPACK_PACKAGE_VENDOR "The nlos authors")
set(NLOS_MAINTAINER "The nlos authors <nlos@example.org>" CACHE STRING
    "Who stands in packages as their maintainer")
set(CPACK_PACKAGE_CONTACT ${NLOS_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME nlos)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS ffmpeg)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Renders what a pulsed laser and a time-resolved detector record of a hidden
scene by way of a relay wall, reconstructs the scene from such transients,
fits models to them, and compares results with ground truth.")

# Who links the static libraries needs what they were built with.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libnlos-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "pkg-config, libembree-dev, libtbb-dev, libtinygltf-dev, nlohmann-json3-dev, libfmt-dev, libeigen3-dev, libfftw3-dev, libhdf5-dev, libmatio-dev, libopenexr-dev, libflann-dev, liblz4-dev, libopencv-dev, libcairo2-dev, libfreetype-dev, libpng-dev, libturbojpeg0-dev, zlib1g-dev, libceres-dev, libisal-dev, libzip-dev, libpugixml-dev, libyaml-cpp-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The renderer of transients, the reconstructors and the fits of the program
nlos as static libraries, with headers and a package for CMake.")

# What Debian wants beside them: a changelog and the licences.
string(TIMESTAMP DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(changelog.in changelog @ONLY)
execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
file(READ ${PROJECT_SOURCE_DIR}/LICENSE LICENSE)
configure_file(copyright.in copyright @ONLY)
foreach(component program development)
  string(TOUPPER ${component} upper)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz ${CMAKE_CURRENT_BINARY_DIR}/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}
          COMPONENT ${component})
endforeach()

include(CPack)
