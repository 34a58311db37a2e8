# SPDX-License-Identifier: BSD-3-Clause
# Test script: cmake -DBUILD=<build> -DCONFIG=<configuration> -DFOLDER=<folder> -DCPACK=<cpack>
#   -DDPKG_DEB=<dpkg-deb or empty> -DCONTENTS=<list of regular expressions>
#   -DDEPENDS=<list of Debian packages> -P CheckPackages.cmake
#
# Makes the packages and looks whether they hold and ask for what is expected.
file(REMOVE_RECURSE "${FOLDER}")
file(MAKE_DIRECTORY "${FOLDER}")
execute_process(COMMAND "${CPACK}" -B "${FOLDER}" -C "${CONFIG}" WORKING_DIRECTORY "${BUILD}"
  OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE status)
if (NOT status EQUAL 0)
  message(FATAL_ERROR "cpack failed:\n${output}")
endif ()

function (check_contents package list)
  foreach (expected IN LISTS CONTENTS)
    if (NOT list MATCHES "${expected}")
      message(FATAL_ERROR "${package} has no ${expected}:\n${list}")
    endif ()
  endforeach ()
endfunction ()

# The archive is unpacked, for tests that run what it holds.
file(GLOB archive "${FOLDER}/*.tar.gz")
execute_process(COMMAND "${CMAKE_COMMAND}" -E tar tf "${archive}" OUTPUT_VARIABLE list
  COMMAND_ERROR_IS_FATAL ANY)
check_contents("${archive}" "${list}")
file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${FOLDER}")
string(REGEX REPLACE "\\.tar\\.gz$" "" unpacked "${archive}")
file(RENAME "${unpacked}" "${FOLDER}/unpacked")

if (DPKG_DEB)
  file(GLOB package "${FOLDER}/*.deb")
  execute_process(COMMAND "${DPKG_DEB}" -c "${package}" OUTPUT_VARIABLE list
    COMMAND_ERROR_IS_FATAL ANY)
  check_contents("${package}" "${list}")
  execute_process(COMMAND "${DPKG_DEB}" -f "${package}" Depends OUTPUT_VARIABLE depends
    COMMAND_ERROR_IS_FATAL ANY)
  foreach (expected IN LISTS DEPENDS)
    if (NOT depends MATCHES "(^| )${expected}( |,|\n|$)")
      message(FATAL_ERROR "${package} does not depend on ${expected}: ${depends}")
    endif ()
  endforeach ()
endif ()
