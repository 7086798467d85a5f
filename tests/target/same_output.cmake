# SPDX-License-Identifier: Apache-2.0
# cmake "-DPROGRAMS=a;b;..." -P same_output.cmake
#
# Programs that must print the same text.
cmake_minimum_required(VERSION 3.25)
list(POP_FRONT PROGRAMS first)
execute_process(COMMAND "${first}" OUTPUT_VARIABLE expected COMMAND_ERROR_IS_FATAL ANY)
message("${expected}")
if(expected STREQUAL "" OR PROGRAMS STREQUAL "")
  message(FATAL_ERROR "there is nothing to compare")
endif()
foreach(program IN LISTS PROGRAMS)
  execute_process(COMMAND "${program}" OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
  if(NOT found STREQUAL expected)
    message(FATAL_ERROR "${program} prints another text:\n${found}")
  endif()
endforeach()
