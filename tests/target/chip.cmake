# SPDX-License-Identifier: Apache-2.0
# The flashable image of the paper's vehicle on the model of its chip (chip/README.md).
# The program is of the host's build (chip/CMakeLists.txt).
set(chip_test "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_test")

# chip_test(NAME MODE ELF TIMEOUT)
function(chip_test name mode elf)
  add_test(NAME ${name} COMMAND "${chip_test}" "${elf}" ${mode})
  set_tests_properties(${name} PROPERTIES LABELS target TIMEOUT 300)
endfunction()
chip_test(chip_boots_and_brakes stop "$<TARGET_FILE:hubfoc_stm32f405>")
chip_test(chip_stops_by_other_torques stops "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_stops_by_other_torques PROPERTIES LABELS "target;full")

# Each fault of the chip (chip/faults.c).
set(chip_faults "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_faults")
add_test(NAME chip_answers_faults COMMAND "${chip_faults}" "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_answers_faults PROPERTIES LABELS target TIMEOUT 300)

# Other nodes on the bus (chip/load.c).
add_test(NAME chip_sends_in_time_on_a_busy_bus
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_load"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_sends_in_time_on_a_busy_bus PROPERTIES LABELS target TIMEOUT 600)
add_test(NAME chip_sends_in_time_on_a_busy_bus_for_long
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_load"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_sends_in_time_on_a_busy_bus_for_long PROPERTIES LABELS "target;full"
  TIMEOUT 900 ENVIRONMENT HUBFOC_FOR_LONG=1)

# Frames with 29-bit identifiers (chip/vesc.c).
add_test(NAME chip_sends_vesc_status_and_receives_no_frame_of_29_bits
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_vesc"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_sends_vesc_status_and_receives_no_frame_of_29_bits
  PROPERTIES LABELS target TIMEOUT 300)

# The scope of the image, by XCP on CAN (chip/scope.c).
add_test(NAME chip_records_a_current_step_as_the_host_gave_it
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_scope"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_records_a_current_step_as_the_host_gave_it
  PROPERTIES LABELS target TIMEOUT 300)

chip_test(chip_gate_driver_protects driver "$<TARGET_FILE:hubfoc_stm32f405>")

# What the memory protection unit lets through (chip/protect.c).
add_test(NAME chip_protects_its_memory
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_protect"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_protects_its_memory PROPERTIES LABELS target TIMEOUT 120)

# The flash while the bridge switches (chip/bridge.c).
add_test(NAME chip_writes_no_flash_while_the_bridge_switches
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_bridge"
    "$<TARGET_FILE:hubfoc_stm32f405>" application)
set_tests_properties(chip_writes_no_flash_while_the_bridge_switches
  PROPERTIES LABELS target TIMEOUT 120)

# A fault of the core (chip/crash.c).
add_test(NAME chip_shows_a_crash_after_its_restart
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_crash"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_shows_a_crash_after_its_restart PROPERTIES LABELS target TIMEOUT 300)

# A reset of each kind (chip/starts.c).
set(chip_starts "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_starts")
add_test(NAME chip_counts_its_starts COMMAND "${chip_starts}" "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_counts_its_starts PROPERTIES LABELS target TIMEOUT 120)

# python-can and cantools drive it, pyxcp reads and changes it (chip/wheel_on_bus.py).
# chip_by_python(NAME TIMEOUT ARGUMENT...): of pytest
function(chip_by_python name timeout)
  if(HUBFOC_PYTHON)
    add_test(NAME ${name} COMMAND "${HUBFOC_PYTHON}" -m pytest -q -p no:cacheprovider ${ARGN}
      WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tests/target/chip")
  else()
    add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" -DMISSING=python3
      -P "${PROJECT_SOURCE_DIR}/tests/target/prerequisites.cmake")
  endif()
  set(host "${PROJECT_SOURCE_DIR}/build/host")
  set(path "${PROJECT_SOURCE_DIR}/host_sim/python:${PROJECT_SOURCE_DIR}/tools")
  string(APPEND path ":${PROJECT_SOURCE_DIR}/tests/unit/host_sim/support")
  set_tests_properties(${name} PROPERTIES LABELS "target;python" TIMEOUT ${timeout}
    ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1;PYTHONPATH=${path};HUBFOC_BUILD_DIR=${host};\
HUBFOC_CHIP_ELF=$<TARGET_FILE:hubfoc_stm32f405>;\
HUBFOC_CHIP_BUS=${host}/tests/target/chip/chip_bus")
endfunction()
chip_by_python(chip_is_stopped_by_a_can_client 120 test_can_client.py)
chip_by_python(chip_speaks_xcp_on_can 300 test_xcp_on_can.py)
chip_by_python(chip_measures_by_xcp_for_long 1200 test_xcp_on_can.py -k gap)
set_tests_properties(chip_measures_by_xcp_for_long PROPERTIES LABELS "target;python;full")
set_property(TEST chip_measures_by_xcp_for_long APPEND PROPERTY ENVIRONMENT HUBFOC_FOR_LONG=1)

# The supply fails in the middle of an update of the configuration (chip/cuts.c).
set(chip_cuts "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_cuts")
add_test(NAME chip_keeps_a_configuration_when_the_supply_fails
  COMMAND "${chip_cuts}" "$<TARGET_FILE:hubfoc_stm32f405>" 8 1)
set_tests_properties(chip_keeps_a_configuration_when_the_supply_fails
  PROPERTIES LABELS target TIMEOUT 120)
add_test(NAME chip_keeps_a_configuration_in_1000_failures_of_the_supply
  COMMAND "${chip_cuts}" "$<TARGET_FILE:hubfoc_stm32f405>" 1000 100)
set_tests_properties(chip_keeps_a_configuration_in_1000_failures_of_the_supply
  PROPERTIES LABELS "target;full" TIMEOUT 3600)
add_test(NAME chip_keeps_a_configuration_in_a_failure_at_each_write
  COMMAND "${chip_cuts}" "$<TARGET_FILE:hubfoc_stm32f405>" every)
set_tests_properties(chip_keeps_a_configuration_in_a_failure_at_each_write
  PROPERTIES LABELS "target;full" TIMEOUT 3600)

# The supply fails while the journal is written (chip/journal.c).
add_test(NAME chip_keeps_its_journal_in_a_failure_at_each_write
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_journal"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_keeps_its_journal_in_a_failure_at_each_write
  PROPERTIES LABELS "target;full" TIMEOUT 3600)

# The core stands still while a word is programmed; no step is missed for it.
add_test(NAME chip_has_no_fault_after_a_record_of_the_journal
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_journal"
    "$<TARGET_FILE:hubfoc_stm32f405>" status)
set_tests_properties(chip_has_no_fault_after_a_record_of_the_journal
  PROPERTIES LABELS target TIMEOUT 120)

# Errors planted in it.
if(HUBFOC_PYTHON) # pwm_interrupt_budget says so
  include("${CMAKE_CURRENT_LIST_DIR}/planted.cmake")
  include("${CMAKE_CURRENT_LIST_DIR}/chip_planted.cmake")
endif()
