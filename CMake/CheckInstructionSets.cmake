# SPDX-License-Identifier: BSD-3-Clause
# Test script: cmake -DNM=<nm> -DOBJECTS=<list> -P CheckInstructionSets.cmake
#
# Objects compiled for AVX2 or AVX-512 may define strong symbols (their table of kernels) and local
# ones only. A weak symbol (an inline function or template with external linkage) could be chosen by
# the linker for the whole library, which then stops on processors without these instructions.
set(checked 0)
foreach (object IN LISTS OBJECTS)
  if (NOT object MATCHES "(Evaluator|Determinant)AVX")
    continue ()
  endif ()
  execute_process(COMMAND "${NM}" --defined-only --extern-only "${object}"
    OUTPUT_VARIABLE symbols RESULT_VARIABLE status)
  if (status)
    message(FATAL_ERROR "${NM} cannot read ${object}")
  endif ()
  if (symbols MATCHES "(^|\n)[0-9a-fA-F]* [VvWwu] [^\n]*")
    message(FATAL_ERROR "${object} defines a symbol that may replace the baseline's copy:\n"
      "${CMAKE_MATCH_0}\nGive it internal linkage.")
  endif ()
  if (NOT symbols MATCHES "(Evaluator|Determinant)AVX")
    message(FATAL_ERROR "${object} does not define its table of kernels")
  endif ()
  math(EXPR checked "${checked} + 1")
endforeach ()
if (checked EQUAL 0)
  message(FATAL_ERROR "none of the objects is compiled for an instruction set: ${OBJECTS}")
endif ()
