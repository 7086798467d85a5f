# SPDX-License-Identifier: Apache-2.0
# What runs on mps2-an386.

find_path(CMOCK_DIR lib/cmock.rb HINTS "${PROJECT_SOURCE_DIR}/.dev/cmock/usr/share/cmock"
  "/usr/share/cmock" NO_DEFAULT_PATH
  NO_CMAKE_FIND_ROOT_PATH)
set(missing "")
foreach(needed IN ITEMS HUBFOC_QEMU HUBFOC_HOST_CC HUBFOC_PYTHON CMOCK_DIR)
  if(NOT ${needed})
    list(APPEND missing ${needed})
  endif()
endforeach()
# The firmware itself needs none of these, so a machine without them may configure; its tests then
# say so.
add_test(NAME target_prerequisites COMMAND "${CMAKE_COMMAND}" "-DMISSING=${missing}"
  -P "${CMAKE_CURRENT_LIST_DIR}/prerequisites.cmake")
set_tests_properties(target_prerequisites PROPERTIES TIMEOUT 60)

# ---- the firmware ----

hubfoc_add_qemu_test(NAME firmware_boots ELF hubfoc_qemu
  EXPECT "${banner} on qemu_mps2, configuration ${HUBFOC_CONFIG} 0x[0-9A-F]+"
         "self-test RAM: good" "self-test firmware CRC: good"
         "configuration accepted" "result: READY, no limit")
hubfoc_add_qemu_test(NAME firmware_keeps_its_watchdog_fed ELF hubfoc_qemu ARGUMENTS run_ms=3000
  EXPECT "result: READY, no limit")
hubfoc_add_qemu_test(NAME firmware_with_a_dead_timer_is_caught_by_the_watchdog ELF hubfoc_qemu
  ARGUMENTS tick_fault=1 EXPECT_EXIT 1
  EXPECT "watchdog: not fed in time")
hubfoc_add_qemu_test(NAME firmware_latches_a_fault_of_the_power_stage ELF hubfoc_qemu
  ARGUMENTS power_stage_fault=1 EXPECT_EXIT 1
  EXPECT "result: FAILED, FAULT, power stage reported a fault")
hubfoc_add_qemu_test(NAME firmware_without_its_clock_stays_in_boot ELF hubfoc_qemu
  ARGUMENTS clock_fault=1 EXPECT_EXIT 1
  EXPECT "clock fault" "result: FAILED, BOOT")

# The memory protection unit: the fault is recorded, and the restarted firmware shows it.
hubfoc_add_qemu_test(NAME firmware_records_an_overflow_of_its_stack ELF hubfoc_qemu
  ARGUMENTS crash=1
  EXPECT "crash 1 since the supply came: stack overflow at" "result: READY, no limit")
hubfoc_add_qemu_test(NAME firmware_cannot_write_its_image ELF hubfoc_qemu ARGUMENTS crash=2
  EXPECT "crash 1 since the supply came: memory fault at 0x000[01]" "result: READY, no limit")
hubfoc_add_qemu_test(NAME firmware_cannot_execute_data ELF hubfoc_qemu ARGUMENTS crash=3
  EXPECT "crash 1 since the supply came: memory fault at 0x2000" "result: READY, no limit")

# damaged(NAME SECTION OFFSET): a copy of the firmware with one wrong byte.
function(damaged name section offset)
  add_custom_command(OUTPUT "${name}.elf"
    COMMAND "${CMAKE_COMMAND}" "-DELF=$<TARGET_FILE:hubfoc_qemu>"
    "-DBAD=${CMAKE_CURRENT_BINARY_DIR}/${name}.elf" "-DSECTION=${section}"
      -DOFFSET=${offset} "-DOBJCOPY=${CMAKE_OBJCOPY}" "-DHAL_CMAKE=${PROJECT_SOURCE_DIR}/hal/cmake"
      -P "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/damage.cmake"
    DEPENDS hubfoc_qemu "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/damage.cmake"
    "${PROJECT_SOURCE_DIR}/hal/cmake/write_bytes.cmake"
    VERBATIM)
  add_custom_target(${name} ALL DEPENDS "${name}.elf")
endfunction()
damaged(damaged_configuration .hubfoc_config 100)
damaged(damaged_magic .hubfoc_config 0)
# A reserved entry of the vector table (ARMv7-M, B1.5.3): only the checksum reads it.
damaged(damaged_code .text 28)
hubfoc_add_qemu_test(NAME firmware_refuses_a_damaged_configuration
  ELF "${CMAKE_CURRENT_BINARY_DIR}/damaged_configuration.elf" EXPECT_EXIT 1
  EXPECT "configuration refused: crc32" "BOOT, bridge off" "result: FAILED, BOOT")
hubfoc_add_qemu_test(NAME firmware_refuses_what_is_no_configuration
  ELF "${CMAKE_CURRENT_BINARY_DIR}/damaged_magic.elf" EXPECT_EXIT 1
  EXPECT "configuration refused: magic" "result: FAILED, BOOT")
hubfoc_add_qemu_test(NAME firmware_finds_one_wrong_byte_in_itself
  ELF "${CMAKE_CURRENT_BINARY_DIR}/damaged_code.elf" ARGUMENTS run_ms=1200
  EXPECT_EXIT 1 EXPECT "self-test firmware CRC: FAILED" "result: FAILED, FAULT, self-test failed")

# ---- the same input sequences on host and target ----

set(module_libraries ${modules})
list(TRANSFORM module_libraries PREPEND "hubfoc_")
set(module_sources "")
set(module_includes "")
foreach(module IN LISTS modules)
  get_target_property(sources hubfoc_${module} SOURCES)
  get_target_property(directory hubfoc_${module} SOURCE_DIR)
  list(TRANSFORM sources PREPEND "${directory}/")
  list(APPEND module_sources ${sources})
  list(APPEND module_includes "${directory}/include")
endforeach()
list(TRANSFORM trace_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/" OUTPUT_VARIABLE trace_files)

set(HUBFOC_TRACE "${PROJECT_SOURCE_DIR}/build/host/tests/target/hubfoc_trace"
  CACHE FILEPATH "The host preset's program of the input sequences")

# trace(NAME LABELS SOURCES ... LIBRARIES ... OPTIONS ...): compares the sequences on the emulated
# core with those on the host.
function(trace name labels)
  hubfoc_add_target_program(NAME ${name} ${ARGN})
  target_sources(${name} PRIVATE ${trace_files} "${config_image}"
    "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/print_target.c")
  target_include_directories(${name} PRIVATE ${module_includes}
    "${PROJECT_SOURCE_DIR}/tests/unit/firmware/support")
  target_compile_definitions(${name} PRIVATE ${trace_definitions})
  hubfoc_add_qemu_test(NAME ${name}_is_the_hosts_bit_for_bit ELF ${name} MILLIONS 30000
    SAME_AS "${HUBFOC_TRACE}" LABELS ${labels})
  if("full" IN_LIST labels)
    hubfoc_only_full(${name})
  endif()
endfunction()
# As the image has the modules; with q15.h's own clamps instead of SSAT; unoptimised; on smaller
# instruction sets. What differs between those of the same core is the compiler's work alone.
trace(trace_cortex_m4 "" LIBRARIES ${module_libraries})
trace(trace_cortex_m4_portable full SOURCES ${module_sources} OPTIONS -U__ARM_FEATURE_SAT)
trace(trace_cortex_m4_unoptimised full SOURCES ${module_sources} OPTIONS -O0)
set(HUBFOC_OTHER_CORE cortex-m3)
set(HUBFOC_OTHER_CORE_OPTIONS -O2)
add_subdirectory(other_core cortex_m3)
set(HUBFOC_OTHER_CORE cortex-m0plus)
set(HUBFOC_OTHER_CORE_OPTIONS -Os)
add_subdirectory(other_core cortex_m0plus)

# ---- the whole urban cycle ----

# The inputs are written by a program of the host preset, which drives the simulated vehicle.
set(HUBFOC_RECORD_CYCLE "${PROJECT_SOURCE_DIR}/build/host/tests/target/hubfoc_record_cycle"
  CACHE FILEPATH
  "The host preset's program that records the urban cycle")
hubfoc_add_target_program(NAME replay_cycle
  SOURCES replay_cycle.c cycle.c digest.c print.c print_target.c "${config_image}"
  LIBRARIES ${module_libraries})
hubfoc_only_full(replay_cycle)
add_test(NAME whole_cycle_is_the_hosts_bit_for_bit
  COMMAND "${CMAKE_COMMAND}" "-DRECORDER=${HUBFOC_RECORD_CYCLE}" "-DCYCLE=${cycle_points}"
    "-DELF=$<TARGET_FILE:replay_cycle>" "-DQEMU=${HUBFOC_QEMU}"
    "-DLIMIT=${HUBFOC_LIMIT_PLUGIN},instructions=30000000000"
    -P "${CMAKE_CURRENT_LIST_DIR}/whole_cycle.cmake")
set_tests_properties(whole_cycle_is_the_hosts_bit_for_bit PROPERTIES LABELS "target;full"
  TIMEOUT 900)

# ---- processor in the loop ----

find_program(HUBFOC_PYTHON python3 HINTS "${PROJECT_SOURCE_DIR}/.dev/venv/bin"
  NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH
  DOC "Python of the project's private environment (./tools/dev setup makes it)")

# The engine is the host preset's.
function(pil_test folder name timeout labels)
  if(HUBFOC_PYTHON)
    add_test(NAME ${name} COMMAND "${HUBFOC_PYTHON}" -m pytest -q -p no:cacheprovider ${ARGN}
      WORKING_DIRECTORY "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${folder}")
  else()
    add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" -DMISSING=python3
      -P "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/prerequisites.cmake")
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout} LABELS "target;${labels}")
  set_property(TEST ${name} PROPERTY ENVIRONMENT PYTHONDONTWRITEBYTECODE=1
    "HUBFOC_BUILD_DIR=${PROJECT_SOURCE_DIR}/build/host"
    "PYTHONPATH=${CMAKE_CURRENT_FUNCTION_LIST_DIR}/pil")
endfunction()
pil_test(pil pil 300 python test_pil.py)
file(GLOB scenarios
  CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/host_sim/python/hubsim/scenario/builtin/*.toml")
foreach(path IN LISTS scenarios)
  cmake_path(GET path STEM scenario)
  pil_test(pil pil_${scenario} 3000 "python;full"
    "test_scenarios.py::test_the_emulated_run_is_the_hosts[${scenario}]")
endforeach()

# The README's recipe for a debugger on the emulator.
pil_test(. debug_recipe 120 python test_debug_recipe.py)

# Every way to compile and to execute the steps: whole scenarios and the sequences in all of them, a
# minute or more a cell; in every run the sequences in the one that no build has. Both compile into
# build/matrix.
pil_test(matrix bit_exactness_of_sequences 600 python test_sequences.py)
set_property(TEST bit_exactness_of_sequences APPEND PROPERTY ENVIRONMENT
  "HUBFOC_TRACE_ELF=$<TARGET_FILE:trace_cortex_m4>")
pil_test(matrix bit_exactness 14400 "python;full" test_matrix.py)
set_tests_properties(bit_exactness_of_sequences bit_exactness PROPERTIES RESOURCE_LOCK matrix)

# ---- counted instructions ----

# Exact, so a test: the current loop and both steps within their budgets (tools/benchmark), the slow
# step in few of the states. On the images' core; with --full on each, in more of the states.
function(budgets_test name labels)
  if(HUBFOC_PYTHON)
    add_test(NAME ${name} COMMAND "${HUBFOC_PYTHON}"
      "${PROJECT_SOURCE_DIR}/tools/benchmark/measure.py" --no-simulation --only steps ${ARGN}
      --output "${CMAKE_CURRENT_BINARY_DIR}/${name}.json")
  else()
    add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" -DMISSING=python3
      -P "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/prerequisites.cmake")
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT 1800 LABELS "${labels}"
    RESOURCE_LOCK bench ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
endfunction()
budgets_test(instruction_budgets target --first-core --states 4000)
budgets_test(instruction_budgets_of_every_core "target;full" --states 20000)

# ---- the unit tests of the pure modules ----

if(HUBFOC_PYTHON AND CMOCK_DIR)
  set(UNITY_DIR "${CMOCK_DIR}/vendor/unity")
  add_library(unity_target STATIC "${UNITY_DIR}/src/unity.c")
  target_include_directories(unity_target SYSTEM PUBLIC "${UNITY_DIR}/src")
  target_compile_options(unity_target PRIVATE ${HUBFOC_TEST_CORE})
  target_compile_definitions(unity_target PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64
    UNITY_OUTPUT_CHAR=target_putchar
    "UNITY_OUTPUT_CHAR_HEADER_DECLARATION=target_putchar(int)")
  add_library(hubfoc_run_suites OBJECT "${PROJECT_SOURCE_DIR}/tests/unit/runner/run_suites.c")
  target_compile_definitions(hubfoc_run_suites PRIVATE SUITES_WITHOUT_ARGUMENTS)
  target_compile_options(hubfoc_run_suites PRIVATE ${HUBFOC_TEST_CORE})
  target_link_libraries(hubfoc_run_suites PRIVATE unity_target hubfoc_warnings)
  # Only this looks at what the core has: its saturating, packed and counting instructions. The
  # sequences above compare what the other modules make of them; with --full their tests run too.
  set(HUBFOC_UNITS_OF_THE_CORE unit_core)
  foreach(module IN LISTS modules)
    if(EXISTS "${PROJECT_SOURCE_DIR}/tests/unit/firmware/${module}/CMakeLists.txt")
      add_subdirectory("${PROJECT_SOURCE_DIR}/tests/unit/firmware/${module}" "unit_${module}")
    endif()
  endforeach()
endif()
