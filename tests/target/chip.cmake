# SPDX-License-Identifier: Apache-2.0
# The flashable image of the paper's vehicle on the model of its chip (chip/README.md).
# The program is of the host's build (chip/CMakeLists.txt).
set(chip_test "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_test")

# chip_test(NAME MODE ELF TIMEOUT)
function(chip_test name mode elf)
  add_test(NAME ${name} COMMAND "${chip_test}" "${elf}" ${mode})
  set_tests_properties(${name} PROPERTIES LABELS target TIMEOUT 120)
endfunction()
chip_test(chip_boots_and_brakes stop "$<TARGET_FILE:hubfoc_stm32f405>")
chip_test(chip_stops_by_other_torques stops "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_stops_by_other_torques PROPERTIES LABELS "target;full")
chip_test(chip_answers_faults faults "$<TARGET_FILE:hubfoc_stm32f405>")
chip_test(chip_gate_driver_protects driver "$<TARGET_FILE:hubfoc_stm32f405>")

# A fault of the core (chip/crash.c).
add_test(NAME chip_shows_a_crash_after_its_restart
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_crash"
    "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_shows_a_crash_after_its_restart PROPERTIES LABELS target TIMEOUT 120)

# A reset of each kind (chip/starts.c).
set(chip_starts "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_starts")
add_test(NAME chip_counts_its_starts COMMAND "${chip_starts}" "$<TARGET_FILE:hubfoc_stm32f405>")
set_tests_properties(chip_counts_its_starts PROPERTIES LABELS target TIMEOUT 120)

# python-can and cantools drive it (chip/test_can_client.py).
if(HUBFOC_PYTHON)
  add_test(NAME chip_is_stopped_by_a_can_client
    COMMAND "${HUBFOC_PYTHON}" -m pytest -q -p no:cacheprovider test_can_client.py
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tests/target/chip")
else()
  add_test(NAME chip_is_stopped_by_a_can_client COMMAND "${CMAKE_COMMAND}" -DMISSING=python3
    -P "${PROJECT_SOURCE_DIR}/tests/target/prerequisites.cmake")
endif()
set_tests_properties(chip_is_stopped_by_a_can_client PROPERTIES LABELS "target;python" TIMEOUT 120
  ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1;PYTHONPATH=${PROJECT_SOURCE_DIR}/host_sim/python;\
HUBFOC_CHIP_ELF=$<TARGET_FILE:hubfoc_stm32f405>;\
HUBFOC_CHIP_BUS=${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_bus")

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

# Errors planted in the driver, of which the model must find each.
include("${CMAKE_CURRENT_LIST_DIR}/planted.cmake")

# planted(NAME FILE OLD NEW [LABEL]): found in a stop. Those that only the whole stop finds are
# labelled full, but for two.
function(planted name file old new)
  if(NOT HUBFOC_PYTHON) # pwm_interrupt_budget says so
    return()
  endif()
  set(folder hal/stm32)
  if(NOT EXISTS "${PROJECT_SOURCE_DIR}/${folder}/${file}")
    set(folder hal/stm32f405)
  endif()
  set(source "")
  if(file STREQUAL "serial_line.h")
    set(source hal/stm32/serial.c)
  endif()
  planted_image(${name} stm32f405 ${folder} ${file} "${old}" "${new}" ${source})
  set(target planted_${name})
  if(name STREQUAL "no_error")
    chip_test(chip_finds_no_error stop "$<TARGET_FILE:${target}>")
  elseif(file STREQUAL "gate_driver.c" OR name STREQUAL "a_line_that_does_not_receive")
    chip_test(chip_finds_${name} planted_driver "$<TARGET_FILE:${target}>")
  else()
    chip_test(chip_finds_${name} planted "$<TARGET_FILE:${target}>")
  endif()
  if(ARGN)
    set_tests_properties(chip_finds_${name} PROPERTIES LABELS "target;${ARGN}")
  endif()
endfunction()
# The same without an error.
planted(no_error inverter.c "TIM1->PSC = 0;" "TIM1->PSC = 0;" full)
planted(a_gate_of_reversed_polarity inverter.c "TIM_CCER_CC1NE |" "TIM_CCER_CC1NE | (1U << 3) |")
planted(a_gate_that_is_not_enabled inverter.c "TIM_CCER_CC2NE |" "" full)
planted(a_short_dead_time inverter.c "(dead_time_code <<" "(dead_time_code / 4U <<")
planted(a_trigger_at_the_bottom inverter.c ": top_counts + trigger_counts" ": 1" full)
planted(a_trigger_at_the_top inverter.c "top_counts + trigger_counts" "top_counts - 1")
planted(a_sampling_time_too_short analog.c "SAMPLE_15_CYCLES = 1" "SAMPLE_15_CYCLES = 0")
planted(an_update_at_both_ends inverter.c "TIM1->RCR = 1;" "TIM1->RCR = 0;")
planted(compare_values_at_once inverter.c "TIM_CCMR1_OC1PE |" "" full)
planted(a_driver_fault_of_wrong_polarity gate_driver.c "EXTI->FTSR |=" "EXTI->RTSR |=")
planted(a_driver_fault_of_low_priority gate_driver.c "PRIORITY_DRIVER_FAULT);"
  "PRIORITY_MILLISECOND);")
planted(a_driver_not_read_back gate_driver.c "return first && second;" "return first || true;")
planted(a_driver_with_a_wrong_threshold gate_driver.c "OC_ADJ_SET_Pos = 6" "OC_ADJ_SET_Pos = 5")
planted(a_driver_that_limits_instead_of_latching gate_driver.c "SHUTDOWN = 1 << 4" "SHUTDOWN = 0")
planted(gates_of_another_timer inverter.c "BOARD_AF_GATE_LOW_C, GPIO"
  "BOARD_AF_TIM3, GPIO" full)
planted(swapped_currents analog.c
  "CURRENT_C : BOARD_CHANNEL_CURRENT_B" "CURRENT_C : BOARD_CHANNEL_CURRENT_C" full)
planted(a_current_of_wrong_sign analog.c
  "BOARD_CURRENT_INVERTED != 0" "BOARD_CURRENT_INVERTED == 0" full)
planted(too_few_wait_states clock.c "FLASH_WAIT_STATES = 5" "FLASH_WAIT_STATES = 2")
planted(a_wrong_can_filter can.c "<< 5; /*" "<< 4; /*")
planted(a_watchdog_not_fed watchdog.c "void watchdog_feed(void)
{
    IWDG->KR = IWDG_KR_KEY_RELOAD;" "void watchdog_feed(void)
{")
planted(a_line_on_another_dma_channel serial_line.h "SERIAL_CHANNEL = 4" "SERIAL_CHANNEL = 3")
planted(a_line_that_does_not_receive serial_line.h "SERIAL_STREAM_RECEIVE = 1"
  "SERIAL_STREAM_RECEIVE = 2")
planted(a_transfer_with_flags_of_the_last serial_line.h "DMA_LIFCR_CTCIF3;" "0;")
planted(a_timer_without_its_clock inverter.c "RCC->APB2ENR |= RCC_APB2ENR_TIM1EN;" "")

if(HUBFOC_PYTHON)
  planted_image(flags_of_a_reset_that_last stm32f405 hal/stm32 watchdog.c
    "RCC->CSR |= RCC_CSR_RMVF;" "")
  add_test(NAME chip_finds_flags_of_a_reset_that_last
    COMMAND "${chip_starts}" "$<TARGET_FILE:planted_flags_of_a_reset_that_last>" planted)
  set_tests_properties(chip_finds_flags_of_a_reset_that_last PROPERTIES LABELS target TIMEOUT 120)
endif()

# planted_cut(NAME FOLDER FILE OLD NEW [SOURCE]): found by cuts of the supply.
function(planted_cut name folder file old new)
  if(NOT HUBFOC_PYTHON)
    return()
  endif()
  planted_image(${name} stm32f405 ${folder} ${file} "${old}" "${new}" ${ARGN})
  add_test(NAME chip_finds_${name}
    COMMAND "${chip_cuts}" "$<TARGET_FILE:planted_${name}>" 32 0 planted)
  set_tests_properties(chip_finds_${name} PROPERTIES LABELS "target;full" TIMEOUT 300)
endfunction()
planted_cut(an_erase_of_another_sector hal/stm32 flash.c "flash_cells_erase(sector,"
  "flash_cells_erase((flash_sector_t)(sector + 1),")
planted_cut(a_receiver_that_is_not_circular hal/stm32f405 serial_line.h "settings | DMA_S0CR_CIRC"
  "settings" hal/stm32/serial.c)
set(store firmware/app config_store.c)
planted_cut(a_configuration_replaced_in_place ${store}
  "old.sector == FLASH_CONFIGURATION_A ? FLASH_CONFIGURATION_B : FLASH_CONFIGURATION_A"
  "old.sector")
planted_cut(a_mark_before_its_image ${store} "flash_status_t status = flash_erase(to);"
  "flash_status_t status = flash_erase(to);
   (void)flash_program(to, mark_at, mark, sizeof mark);")
planted_cut(an_old_configuration_given_up_first ${store} "flash_status_t status = flash_erase(to);"
  "static const uint32_t NONE[2] = {0, 0};
   (void)flash_program(old.sector, mark_at, NONE, sizeof NONE);
   flash_status_t status = flash_erase(to);")
planted_cut(a_mark_without_its_check ${store} "return mark[1] == ~mark[0]"
  "return mark[0] != UINT32_MAX")
planted_cut(a_sector_that_is_not_erased ${store} "status = flash_erase(to)" "status = FLASH_OK")
