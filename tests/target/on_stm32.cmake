# SPDX-License-Identifier: Apache-2.0
# The flashable image itself, on the model of its chip.

# layout(NAME EXPRESSION...): facts about the linked image, from its symbols.
add_test(NAME stm32_image_is_laid_out_as_documented
  COMMAND "${CMAKE_COMMAND}" "-DNM=${CMAKE_NM}" "-DELF=$<TARGET_FILE:hubfoc_stm32f405>"
  "-DCONFIG=CONFIG_${config_symbol}" -DCHIP=stm32f405
    -P "${CMAKE_CURRENT_LIST_DIR}/check_layout.cmake")

# The other STM32's image, with its own flags: the linker checks that it fits, the report behind it
# the depth of the stack.
set(other "${CMAKE_CURRENT_BINARY_DIR}/stm32g431")
add_test(NAME stm32g431_image_fits
  COMMAND "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}" "${other}"
    --build-generator Ninja --build-target hubfoc_stm32g431 --build-options
    -DHUBFOC_PORT=stm32g431 -DHUBFOC_CONFIG=wheel24v -DHUBFOC_TESTS=OFF
    "-DCMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE}" -DCMAKE_BUILD_TYPE=Release
    --test-command "${CMAKE_COMMAND}" "-DNM=${CMAKE_NM}"
    "-DELF=${other}/hubfoc_stm32g431.elf" -DCONFIG=CONFIG_WHEEL24V -DCHIP=stm32g431
    -P "${CMAKE_CURRENT_LIST_DIR}/check_layout.cmake")
set_tests_properties(stm32g431_image_fits PROPERTIES LABELS target TIMEOUT 600
  FIXTURES_SETUP stm32g431_image)

# ---- on the model of the chip ----

find_program(HUBFOC_PYTHON python3 HINTS "${PROJECT_SOURCE_DIR}/.dev/venv/bin"
  NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH
  DOC "Python of the project's private environment (./tools/dev setup makes it)")

# The vehicle is the paper's, so is the image; the wiring is the first board's.
list(GET HUBFOC_BOARDS_stm32f405 0 first_board)
if(HUBFOC_CONFIG STREQUAL "lu2013" AND HUBFOC_BOARD_HEADER STREQUAL "boards/${first_board}.h")
  include(chip.cmake)
  include(chip_boards.cmake)
endif()

# The other STM32's image on the model of its chip.
include("${CMAKE_CURRENT_LIST_DIR}/chip_g431.cmake")
chip_g431_tests("${other}/hubfoc_stm32g431.elf")
set_tests_properties(chip_g431_boots_and_brakes chip_g431_trips_on_over_current
  chip_g431_answers_faults chip_g431_counts_its_starts chip_g431_protects_its_memory
  chip_g431_writes_no_flash_while_the_bridge_switches chip_g431_shows_a_crash_after_its_restart
  chip_g431_sends_in_time_on_a_busy_bus chip_g431_keeps_a_configuration_when_the_supply_fails
  chip_g431_keeps_a_configuration_in_1000_failures_of_the_supply
  chip_g431_keeps_a_configuration_in_a_failure_at_each_write
  chip_g431_keeps_its_journal_in_a_failure_at_each_write
  PROPERTIES FIXTURES_REQUIRED stm32g431_image)
# With errors planted in its driver: the tests of its own preset. Cleaning would delete the copies
# that are made when CMake runs.
add_test(NAME chip_g431_finds_planted_errors
  COMMAND "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}" "${other}_planted"
    --build-generator Ninja --build-noclean --build-options
    -DHUBFOC_PORT=stm32g431 -DHUBFOC_CONFIG=wheel24v
    "-DCMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE}" -DCMAKE_BUILD_TYPE=Release
    --test-command "${CMAKE_CTEST_COMMAND}" -LE full -R chip_g431_finds --output-on-failure)
set_tests_properties(chip_g431_finds_planted_errors PROPERTIES LABELS "target;full" TIMEOUT 1800)

# ---- counted instructions ----

set(benchmark_path "${PROJECT_SOURCE_DIR}/tools:${PROJECT_SOURCE_DIR}/host_sim/python")
set(benchmark_environment "PYTHONDONTWRITEBYTECODE=1;PYTHONPATH=${benchmark_path}")

# Exact, so a test: the PWM interrupt of this image within its budget, on the model of its chip, and
# the load of the core (tools/benchmark). The model's vehicle is the paper's.
if(NOT HUBFOC_PYTHON)
  add_test(NAME pwm_interrupt_budget COMMAND "${CMAKE_COMMAND}" -DMISSING=python3
    -P "${CMAKE_CURRENT_LIST_DIR}/prerequisites.cmake")
elseif(HUBFOC_CONFIG STREQUAL "lu2013" AND HUBFOC_BOARD_HEADER STREQUAL "boards/${first_board}.h")
  add_test(NAME pwm_interrupt_budget COMMAND "${HUBFOC_PYTHON}"
    "${PROJECT_SOURCE_DIR}/tools/benchmark/measure.py" --only interrupt
    --image "$<TARGET_FILE:hubfoc_stm32f405>" --output "${CMAKE_CURRENT_BINARY_DIR}/bench.json")

  # Flash, RAM and stack of both linked images within their budgets.
  add_test(NAME ports_keep_their_memory_budgets COMMAND "${HUBFOC_PYTHON}" -m benchmark.ports
    "$<TARGET_FILE:hubfoc_stm32f405>" "${other}/hubfoc_stm32g431.elf"
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tools")
  set_tests_properties(ports_keep_their_memory_budgets PROPERTIES TIMEOUT 60 LABELS target
    FIXTURES_REQUIRED stm32g431_image ENVIRONMENT "${benchmark_environment}")
endif()
if(TEST pwm_interrupt_budget)
  set_tests_properties(pwm_interrupt_budget PROPERTIES TIMEOUT 600 LABELS target
    ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
endif()

# While the flash is erased or written nothing is read in it.
if(HUBFOC_PYTHON)
  add_test(NAME code_in_ram_needs_no_flash COMMAND "${HUBFOC_PYTHON}" -m benchmark.ram_code
    "$<TARGET_FILE:hubfoc_stm32f405>" "${other}/hubfoc_stm32g431.elf"
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tools")
  set_tests_properties(code_in_ram_needs_no_flash PROPERTIES TIMEOUT 60 LABELS target
    FIXTURES_REQUIRED stm32g431_image ENVIRONMENT "${benchmark_environment}")
endif()

# A measuring tool finds the application's variables in the images (test_measuring_tool.py).
if(HUBFOC_PYTHON)
  add_test(NAME a_measuring_tool_finds_the_variables COMMAND "${HUBFOC_PYTHON}" -m pytest -q
    -p no:cacheprovider test_measuring_tool.py
    WORKING_DIRECTORY "${CMAKE_CURRENT_LIST_DIR}")
  set_tests_properties(a_measuring_tool_finds_the_variables PROPERTIES TIMEOUT 60
    LABELS "target;python" FIXTURES_REQUIRED stm32g431_image ENVIRONMENT
    "${benchmark_environment};\
HUBFOC_IMAGES=$<TARGET_FILE:hubfoc_stm32f405>:${other}/hubfoc_stm32g431.elf")
endif()

# The other STM32's image on the model of its chip: its clock, its timing, the budget of its PWM
# interrupt, the load of its core.
if(HUBFOC_PYTHON)
  add_test(NAME stm32g431_drives_and_brakes COMMAND "${HUBFOC_PYTHON}" -m benchmark.stm32g431
    "${other}/hubfoc_stm32g431.elf" WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tools")
  set_tests_properties(stm32g431_drives_and_brakes PROPERTIES LABELS "target;full" TIMEOUT 600
    FIXTURES_REQUIRED stm32g431_image ENVIRONMENT "${benchmark_environment}")
endif()

# ---- the release ----

set(image "${PROJECT_BINARY_DIR}/hubfoc_stm32f405")

add_test(NAME stm32_image_is_the_same_from_another_folder
  COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DBUILD=${PROJECT_BINARY_DIR}"
    -DTARGET=hubfoc_stm32f405 -DPRESET=stm32f405 "-DCOMPILER=${CMAKE_C_COMPILER}"
    "-DOPTIONS=-DHUBFOC_CONFIG=${HUBFOC_CONFIG}"
    "-DFILES=${image}.bin;${image}.hex;${image}_config.bin"
    "-DWORK=${CMAKE_CURRENT_BINARY_DIR}/rebuild"
    -P "${CMAKE_CURRENT_LIST_DIR}/rebuild.cmake")
set_tests_properties(stm32_image_is_the_same_from_another_folder PROPERTIES LABELS "target;full"
  TIMEOUT 600)
set_tests_properties(stm32_image_is_laid_out_as_documented PROPERTIES TIMEOUT 60)
