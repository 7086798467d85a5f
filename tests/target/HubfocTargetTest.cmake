# SPDX-License-Identifier: Apache-2.0
# Tests on the emulated core.
#
#   hubfoc_add_target_program(NAME x SOURCES ... LIBRARIES ... [OPTIONS ...])   an ELF for
#     mps2-an386, no firmware in it
#   hubfoc_add_qemu_test(NAME x ELF file-or-target [ARGUMENTS ..] [MACHINE ..]
#     [MILLIONS n] [EXPECT_EXIT n]
#                        [EXPECT regex ...] [SAME_AS program] [TIMELESS] [LABELS ...])
#       MILLIONS of emulated instructions are the limit: the result is the same on a busy
#         machine. The limit in time follows
#       from it, ten times what an idle machine takes (a thousand millions a second).
#   hubfoc_add_unit_tests(...)   the host's function of that name, so that the folders of
#     tests/unit can be used as they are

set(HUBFOC_RUN_ON_QEMU "${CMAKE_CURRENT_LIST_DIR}/run_on_qemu.cmake")

# The plugin that counts instructions.
include(HubfocQemuPlugin)
include(HubfocSuites)
set(HUBFOC_LIMIT_PLUGIN "${CMAKE_CURRENT_BINARY_DIR}/limit.so")
hubfoc_add_qemu_plugin(NAME hubfoc_limit_plugin OUTPUT "${HUBFOC_LIMIT_PLUGIN}"
  SOURCE "${CMAKE_CURRENT_LIST_DIR}/limit.c")

function(hubfoc_add_qemu_test)
  cmake_parse_arguments(T "TIMELESS" "NAME;ELF;MACHINE;MILLIONS;EXPECT_EXIT;SAME_AS"
    "ARGUMENTS;EXPECT;LABELS" ${ARGN})
  if(TARGET ${T_ELF})
    set(T_ELF "$<TARGET_FILE:${T_ELF}>")
  endif()
  if(NOT T_MILLIONS)
    set(T_MILLIONS 6000)
  endif()
  set(definitions "-DELF=${T_ELF}" "-DQEMU=${HUBFOC_QEMU}"
    "-DLIMIT=${HUBFOC_LIMIT_PLUGIN},instructions=${T_MILLIONS}000000")
  foreach(option IN ITEMS MACHINE EXPECT_EXIT SAME_AS)
    if(DEFINED T_${option})
      list(APPEND definitions "-D${option}=${T_${option}}")
    endif()
  endforeach()
  if(T_TIMELESS)
    list(APPEND definitions -DTIMELESS=ON)
  endif()
  list(JOIN T_ARGUMENTS " " arguments)
  list(JOIN T_EXPECT "|||" expect)
  add_test(NAME ${T_NAME}
    COMMAND "${CMAKE_COMMAND}" ${definitions} "-DARGUMENTS=${arguments}" "-DEXPECT=${expect}"
    -P "${HUBFOC_RUN_ON_QEMU}")
  math(EXPR seconds "${T_MILLIONS} / 100")
  if(seconds LESS 60)
    set(seconds 60)
  endif()
  set_tests_properties(${T_NAME} PROPERTIES TIMEOUT ${seconds} LABELS "target;${T_LABELS}")
endfunction()

# Start-up, semihosting and the C library's calls: compiled once for each set of flags, which belong
# to a folder.
function(hubfoc_target_core result)
  string(MD5 flags "${CMAKE_C_FLAGS}")
  set(name "hubfoc_target_core_${flags}")
  if(NOT TARGET ${name})
    add_library(${name} OBJECT "${PROJECT_SOURCE_DIR}/tests/target/syscalls.c")
    target_link_libraries(${name} PRIVATE hubfoc_qemu_core hubfoc_warnings)
  endif()
  set(${result} ${name} PARENT_SCOPE)
endfunction()

function(hubfoc_add_target_program)
  cmake_parse_arguments(P "" "NAME" "SOURCES;LIBRARIES;OPTIONS" ${ARGN})
  hubfoc_target_core(core)
  add_executable(${P_NAME} ${P_SOURCES})
  target_link_libraries(${P_NAME} PRIVATE ${core} ${P_LIBRARIES} hubfoc_warnings)
  target_include_directories(${P_NAME}
    PRIVATE $<TARGET_PROPERTY:hubfoc_qemu_core,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_options(${P_NAME} PRIVATE ${P_OPTIONS})
  # A test's worth of stack; the linker script's own is the firmware's.
  target_link_options(${P_NAME} PRIVATE -fno-lto -nostartfiles --specs=nano.specs
    "-T${HUBFOC_QEMU_LINKER_SCRIPT}"
    -Wl,--defsym=link_stack_size=0x20000 ${P_OPTIONS})
  set_target_properties(${P_NAME} PROPERTIES SUFFIX .elf
    LINK_DEPENDS "${HUBFOC_QEMU_LINKER_SCRIPT}")
endfunction()

# The firmware in a unit test is compiled for the Cortex-M4. The test's own arithmetic is in double
# precision, which that core does in software, ten times as long as what is tested: so tests are
# compiled for the Cortex-M7, whose instruction set contains the M4's and whose unit has double
# precision, and run on a board with that.
set(HUBFOC_TEST_CORE -mcpu=cortex-m7 -mfpu=fpv5-d16)
set(HUBFOC_TEST_MACHINE mps2-an500)

function(hubfoc_add_unit_tests)
  cmake_parse_arguments(T "" "NAME;TIMEOUT"
    "TESTS;EXCEPT;APART;SOURCES;LIBRARIES;MOCKS;LABELS" ${ARGN})
  if(T_MOCKS)
    message(FATAL_ERROR "${T_NAME}: mocks are for the host")
  endif()
  hubfoc_suites(suites names "${CMAKE_CURRENT_BINARY_DIR}/${T_NAME}.gen"
    TESTS ${T_TESTS} EXCEPT ${T_EXCEPT})
  set_source_files_properties(${suites} ${T_SOURCES} PROPERTIES
    COMPILE_OPTIONS "${HUBFOC_TEST_CORE}")
  hubfoc_add_target_program(NAME ${T_NAME} SOURCES ${suites} ${T_SOURCES}
    LIBRARIES hubfoc_run_suites unity_target ${T_LIBRARIES})
  target_include_directories(${T_NAME} PRIVATE "${PROJECT_SOURCE_DIR}/tests/unit/runner")
  target_link_options(${T_NAME} PRIVATE ${HUBFOC_TEST_CORE})
  set(labels unit)
  if(NOT T_NAME IN_LIST HUBFOC_UNITS_OF_THE_CORE)
    list(APPEND labels full)
    hubfoc_only_full(${T_NAME})
  endif()
  hubfoc_add_qemu_test(NAME ${T_NAME} ELF ${T_NAME} MACHINE ${HUBFOC_TEST_MACHINE}
    MILLIONS 400000 TIMELESS
    EXPECT "Tests 0 Failures 0 Ignored" LABELS ${labels})
endfunction()
