# SPDX-License-Identifier: BSD-3-Clause
# Test script: cmake -DBUILD=<build> -DCONFIG=<configuration> -DSOURCE=<source> -DPREFIX=<prefix>
#   -DREADELF=<readelf> -P InstallAndMove.cmake
#
# Installs, moves the installed tree to the prefix, and looks for paths that would not survive on
# another machine.
file(REMOVE_RECURSE "${PREFIX}" "${PREFIX}.staged")
execute_process(
  COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}.staged" --config "${CONFIG}"
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME "${PREFIX}.staged" "${PREFIX}")

file(GLOB_RECURSE libraries "${PREFIX}/*.so")
if (NOT libraries)
  file(GLOB_RECURSE libraries "${PREFIX}/*.a")
endif ()
if (NOT libraries)
  message(FATAL_ERROR "no library was installed in ${PREFIX}")
endif ()
foreach (library IN LISTS libraries)
  execute_process(COMMAND "${READELF}" --dynamic "${library}" OUTPUT_VARIABLE dynamic
    COMMAND_ERROR_IS_FATAL ANY)
  foreach (folder IN ITEMS "${BUILD}" "${SOURCE}")
    string(FIND "${dynamic}" "${folder}" position)
    if (NOT position EQUAL -1)
      message(FATAL_ERROR "${library} looks for libraries in ${folder}")
    endif ()
  endforeach ()
  if (library MATCHES "\\.so$")
    execute_process(COMMAND ldd "${library}" OUTPUT_VARIABLE needed COMMAND_ERROR_IS_FATAL ANY)
    if (needed MATCHES "[^\n]*not found")
      message(FATAL_ERROR "${library} cannot be loaded: ${CMAKE_MATCH_0}")
    endif ()
  endif ()
endforeach ()

file(GLOB_RECURSE texts "${PREFIX}/*.cmake" "${PREFIX}/*.xml" "${PREFIX}/*.h" "${PREFIX}/*.py*")
foreach (text IN LISTS texts)
  file(READ "${text}" content)
  foreach (folder IN ITEMS "${BUILD}" "${SOURCE}")
    string(FIND "${content}" "${folder}" position)
    if (NOT position EQUAL -1)
      message(FATAL_ERROR "${text} names ${folder}")
    endif ()
  endforeach ()
endforeach ()
