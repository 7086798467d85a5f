# SPDX-License-Identifier: Apache-2.0
# hubfoc_add_qemu_plugin(NAME target SOURCE x.c OUTPUT x.so [OPTIONS ...] [DEPENDS file ...])
#
# A plugin for the emulator, in the version of the interface that it accepts. Without an emulator or
# a compiler for the host (HUBFOC_QEMU, HUBFOC_HOST_CC) there is none.
find_program(HUBFOC_QEMU qemu-system-arm)
find_program(HUBFOC_HOST_CC NAMES cc gcc clang)

function(hubfoc_add_qemu_plugin)
  cmake_parse_arguments(P "" "NAME;SOURCE;OUTPUT" "OPTIONS;DEPENDS" ${ARGN})
  if(NOT HUBFOC_QEMU OR NOT HUBFOC_HOST_CC)
    return()
  endif()
  execute_process(COMMAND "${HUBFOC_QEMU}" --version OUTPUT_VARIABLE qemu_version
    COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCH "[0-9]+[.][0-9]+" qemu_version "${qemu_version}")
  set(interface 1)
  foreach(since IN ITEMS 9.0=2 9.1=3 9.2=4)
    string(REPLACE "=" ";" since "${since}")
    list(GET since 0 version)
    if(qemu_version VERSION_GREATER_EQUAL version)
      list(GET since 1 interface)
    endif()
  endforeach()
  add_custom_command(OUTPUT "${P_OUTPUT}"
    COMMAND "${HUBFOC_HOST_CC}" -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC
    -DQEMU_PLUGIN_API=${interface} ${P_OPTIONS} "${P_SOURCE}" -o "${P_OUTPUT}"
    DEPENDS "${P_SOURCE}" ${P_DEPENDS} VERBATIM)
  add_custom_target(${P_NAME} ALL DEPENDS "${P_OUTPUT}")
endfunction()
