# SPDX-License-Identifier: Apache-2.0
# cmake -DRECORDER=hubfoc_record_cycle -DCYCLE=ece15.csv -DELF=replay_cycle.elf [what
# run_on_qemu.cmake takes]
#       -P whole_cycle.cmake
#
# Records the inputs of both step functions over the urban cycle on the host, replays them on the
# emulated core, and compares the two digests of all outputs.
cmake_minimum_required(VERSION 3.25)

if(NOT EXISTS "${RECORDER}")
  message(FATAL_ERROR "${RECORDER} is not built; accepted: after "
    "'cmake --build --preset host --target hubfoc_record_cycle'")
endif()
file(REMOVE cycle.trace)
execute_process(COMMAND "${RECORDER}" "${CYCLE}" OUTPUT_VARIABLE recorded
  COMMAND_ERROR_IS_FATAL ANY)
if(NOT recorded MATCHES "([0-9A-F]+  urban cycle ECE-15, [^\n]*RUN [0-9]+\n)")
  message(FATAL_ERROR "the host's cycle was not driven: ${recorded}")
endif()
set(expected "${CMAKE_MATCH_1}")
file(SIZE cycle.trace bytes)
message("${bytes} bytes of inputs")
include("${CMAKE_CURRENT_LIST_DIR}/run_on_qemu.cmake")
file(REMOVE cycle.trace)
if(NOT output STREQUAL expected)
  message(FATAL_ERROR "the host's output differs:\n${expected}")
endif()
