# SPDX-License-Identifier: Apache-2.0
# Tests on the emulated core.
#
#   hubfoc_add_target_program(NAME x SOURCES ... LIBRARIES ... [OPTIONS ...])   an ELF for mps2-an386, no firmware in it
#   hubfoc_add_qemu_test(NAME x ELF file-or-target [ARGUMENTS ..] [MACHINE ..] [SERIAL n] [SECONDS n] [EXPECT_EXIT n]
#                        [EXPECT regex ...] [SAME_AS program] [LABELS ...])
#   hubfoc_add_unit_test(...)   the host's function of that name, so that the folders of tests/unit can be used as they are

find_program(HUBFOC_QEMU qemu-system-arm)
set(HUBFOC_RUN_ON_QEMU "${CMAKE_CURRENT_LIST_DIR}/run_on_qemu.cmake")

function(hubfoc_add_qemu_test)
  cmake_parse_arguments(T "" "NAME;ELF;MACHINE;SERIAL;SECONDS;EXPECT_EXIT;SAME_AS" "ARGUMENTS;EXPECT;LABELS" ${ARGN})
  if(TARGET ${T_ELF})
    set(T_ELF "$<TARGET_FILE:${T_ELF}>")
  endif()
  if(NOT T_SECONDS)
    set(T_SECONDS 60)
  endif()
  set(definitions "-DELF=${T_ELF}" "-DQEMU=${HUBFOC_QEMU}" "-DSECONDS=${T_SECONDS}")
  foreach(option IN ITEMS MACHINE SERIAL EXPECT_EXIT SAME_AS)
    if(DEFINED T_${option})
      list(APPEND definitions "-D${option}=${T_${option}}")
    endif()
  endforeach()
  list(JOIN T_ARGUMENTS " " arguments)
  list(JOIN T_EXPECT "|||" expect)
  add_test(NAME ${T_NAME}
    COMMAND "${CMAKE_COMMAND}" ${definitions} "-DARGUMENTS=${arguments}" "-DEXPECT=${expect}" -P "${HUBFOC_RUN_ON_QEMU}")
  math(EXPR limit "${T_SECONDS} + 20")
  set_tests_properties(${T_NAME} PROPERTIES TIMEOUT ${limit} LABELS "target;${T_LABELS}")
endfunction()

function(hubfoc_add_target_program)
  cmake_parse_arguments(P "" "NAME" "SOURCES;LIBRARIES;OPTIONS" ${ARGN})
  add_executable(${P_NAME} ${P_SOURCES} "${PROJECT_SOURCE_DIR}/tests/target/syscalls.c")
  target_link_libraries(${P_NAME} PRIVATE hubfoc_qemu_core ${P_LIBRARIES} hubfoc_warnings)
  target_compile_options(${P_NAME} PRIVATE ${P_OPTIONS})
  # A test's worth of stack; the linker script's own is the firmware's.
  target_link_options(${P_NAME} PRIVATE -nostartfiles --specs=nano.specs "-T${HUBFOC_QEMU_LINKER_SCRIPT}"
    -Wl,--defsym=link_stack_size=0x20000 ${P_OPTIONS})
  set_target_properties(${P_NAME} PROPERTIES SUFFIX .elf LINK_DEPENDS "${HUBFOC_QEMU_LINKER_SCRIPT}")
endfunction()

# Needs Ruby for the runners; without it there is nothing to add, and tests/target says so with a failing test.
function(hubfoc_add_unit_test)
  cmake_parse_arguments(T "" "NAME;TIMEOUT" "SOURCES;LIBRARIES;MOCKS;LABELS" ${ARGN})
  if(T_MOCKS)
    message(FATAL_ERROR "${T_NAME}: mocks are for the host")
  endif()
  list(GET T_SOURCES 0 test)
  cmake_path(ABSOLUTE_PATH test)
  set(runner "${CMAKE_CURRENT_BINARY_DIR}/${T_NAME}_runner.c")
  add_custom_command(OUTPUT "${runner}"
    COMMAND "${HUBFOC_RUBY}" -W0 "${UNITY_DIR}/auto/generate_test_runner.rb" "${HUBFOC_CMOCK_YML}" "${test}" "${runner}"
    DEPENDS "${test}" "${HUBFOC_CMOCK_YML}" VERBATIM)
  set_source_files_properties("${runner}" PROPERTIES COMPILE_OPTIONS "-w")
  set_source_files_properties(${T_SOURCES} PROPERTIES COMPILE_OPTIONS "-Wno-missing-prototypes")
  hubfoc_add_target_program(NAME target_${T_NAME} SOURCES ${T_SOURCES} "${runner}" LIBRARIES unity_target ${T_LIBRARIES})
  hubfoc_add_qemu_test(NAME target_${T_NAME} ELF target_${T_NAME} SECONDS 580 EXPECT "Tests 0 Failures 0 Ignored" LABELS unit)
endfunction()
