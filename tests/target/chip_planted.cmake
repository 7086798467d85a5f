# SPDX-License-Identifier: Apache-2.0
# Errors planted in the image of the STM32F405, each of which the model or its tests must find, and
# with what (planted.cmake).

# planted(NAME FILE OLD NEW FINDS [LABEL]): in the driver; found in a stop, by the gate driver's
# test or by the faults'. Of those that take seconds one a program is in every run, the others are
# labelled full.
function(planted name file old new finds)
  set(folder hal/stm32)
  if(NOT EXISTS "${PROJECT_SOURCE_DIR}/${folder}/${file}")
    set(folder hal/stm32f405)
  endif()
  set(source "")
  if(file STREQUAL "serial_line.h")
    set(source hal/stm32/serial.c)
  elseif(file STREQUAL "stop_route.h")
    set(source hal/stm32/stop_timer.c)
  elseif(file STREQUAL "can_places.h")
    set(source hal/stm32f405/can.c)
  endif()
  planted_image(${name} stm32f405 ${folder} ${file} "${old}" "${new}" ${source})
  set(program chip_test stop)
  if(file STREQUAL "gate_driver.c" OR name STREQUAL "a_line_that_does_not_receive")
    set(program chip_test driver)
  elseif(name MATCHES "crystal|stop")
    set(program chip_faults)
  elseif(name MATCHES "29_bits")
    set(program chip_vesc)
  elseif(name MATCHES "frames")
    set(program chip_load)
  endif()
  set(labels target ${ARGN})
  chip_finds(chip_finds_${name} "$<TARGET_FILE:planted_${name}>" "${finds}" "${labels}" ${program})
  if(program STREQUAL "chip_load") # in every traffic
    set_tests_properties(chip_finds_${name} PROPERTIES ENVIRONMENT HUBFOC_FOR_LONG=1)
  endif()
endfunction()

# The same build without an error.
planted_image(no_error stm32f405 hal/stm32 inverter.c "TIM1->PSC = 0;" "TIM1->PSC = 0;")
chip_test(chip_finds_no_error stop "$<TARGET_FILE:planted_no_error>")
set_tests_properties(chip_finds_no_error PROPERTIES LABELS "target;full")
hubfoc_only_full(planted_no_error)

planted(a_gate_of_reversed_polarity inverter.c "TIM_CCER_CC1NE |" "TIM_CCER_CC1NE | (1U << 3) |"
  "leg 0: a gate of reversed polarity")
planted(a_gate_that_is_not_enabled inverter.c "TIM_CCER_CC2NE |" ""
  "leg 1: only some of its gates are driven" full)
planted(a_short_dead_time inverter.c "(dead_time_code <<" "(dead_time_code / 4U <<"
  "dead time shorter than configured" full)
planted(a_trigger_at_the_bottom inverter.c ": top_counts + trigger_counts" ": 1"
  "currents are not held in the middle of the low pulses" full)
planted(a_trigger_at_the_top inverter.c "top_counts + trigger_counts" "top_counts - 1"
  "currents are not held in the middle of the low pulses" full)
planted(a_sampling_time_too_short analog.c "SAMPLE_15_CYCLES = 1" "SAMPLE_15_CYCLES = 0"
  "ADC1: 3 cycles of sampling are too few")
planted(an_update_at_both_ends inverter.c "TIM1->RCR = 1;" "TIM1->RCR = 0;"
  "self-test failed: the PWM timer does not update at the top of its count")
planted(compare_values_at_once inverter.c "TIM_CCMR1_OC1PE |" ""
  "CCR1 acts at once, without preload" full)
planted(a_driver_fault_of_wrong_polarity gate_driver.c "EXTI->FTSR |=" "EXTI->RTSR |="
  "a short circuit takes all gates within a microsecond" full)
planted(a_driver_fault_of_low_priority gate_driver.c "PRIORITY_DRIVER_FAULT);"
  "PRIORITY_MILLISECOND);" "a short circuit takes all gates within a microsecond" full)
planted(a_driver_not_read_back gate_driver.c "return first && second;" "return first || true;"
  "names a silent driver")
planted(a_driver_with_a_wrong_threshold gate_driver.c "OC_ADJ_SET_Pos = 6" "OC_ADJ_SET_Pos = 5"
  "the board's largest current through hot switches is no fault" full)
planted(a_driver_that_limits_instead_of_latching gate_driver.c "SHUTDOWN = 1 << 4" "SHUTDOWN = 0"
  "a short circuit takes all gates within a microsecond")
planted(gates_of_another_timer inverter.c "BOARD_AF_GATE_LOW_C, GPIO" "BOARD_AF_TIM3, GPIO"
  "leg 2: only some of its gates are driven" full)
planted(swapped_currents analog.c
  "CURRENT_C : BOARD_CHANNEL_CURRENT_B" "CURRENT_C : BOARD_CHANNEL_CURRENT_C"
  "stops in mode RUN" full)
planted(a_current_of_wrong_sign analog.c
  "BOARD_CURRENT_INVERTED != 0" "BOARD_CURRENT_INVERTED == 0" "fault: phase over-current"
  full)
planted(too_few_wait_states clock.c "FLASH_WAIT_STATES = 5" "FLASH_WAIT_STATES = 2"
  "flash read at 168 MHz with 2 of 5 wait states")
planted(a_crystal_that_is_not_watched clock.c "RCC->CR |=
            RCC_CR_CSSON;" ""
  "the torque goes in time and stays away" full)
planted(a_stop_of_another_channel stop_route.h "STOP_CHANNEL = 7" "STOP_CHANNEL = 6"
  "the torque goes in time and stays away")
planted(a_stop_that_is_not_requested stop_timer.c "TIM8->DIER = TIM_DIER_UDE;" ""
  "the torque goes in time and stays away" full)
planted(a_wrong_can_filter can.c "<< 5; /*" "<< 4; /*" "comes to RUN")
planted(an_identifier_of_29_bits_elsewhere can.c "CAN_TIR_EXID_Pos |" "CAN_TIR_STID_Pos |"
  "VESC status frames as the port has them")
planted(frames_in_the_order_of_their_requests can.c "CAN_MCR_ABOM;" "CAN_MCR_ABOM | (1U << 2);"
  "DAQ makes no gap of WheelBrake longer" full)
planted(frames_that_give_no_place can_places.h "least ? i : highest" "least ? highest : highest"
  "WheelBrake comes in time" full)
planted(a_watchdog_not_fed watchdog.c "void watchdog_feed(void)
{
    IWDG->KR = IWDG_KR_KEY_RELOAD;" "void watchdog_feed(void)
{" "boots without a reset")
planted(a_line_on_another_dma_channel serial_line.h "SERIAL_CHANNEL = 4" "SERIAL_CHANNEL = 3"
  "greets on its serial line" full)
planted(a_line_that_does_not_receive serial_line.h "SERIAL_STREAM_RECEIVE = 1"
  "SERIAL_STREAM_RECEIVE = 2" "answers the shell")
planted(a_transfer_with_flags_of_the_last serial_line.h "DMA_LIFCR_CTCIF3;" "0;"
  "DMA1 stream 3 enabled with flags of its last transfer")
planted(a_timer_without_its_clock inverter.c "RCC->APB2ENR |= RCC_APB2ENR_TIM1EN;" ""
  "write of TIM1_")

planted_image(flags_of_a_reset_that_last stm32f405 hal/stm32 watchdog.c
  "RCC->CSR |= RCC_CSR_RMVF;" "")
chip_finds(chip_finds_flags_of_a_reset_that_last
  "$<TARGET_FILE:planted_flags_of_a_reset_that_last>" "started by low supply" target chip_starts)

# What the memory protection unit lets through.
function(planted_protection name file old new finds)
  set(folder hal/stm32)
  set(source "")
  if(file STREQUAL "protected.h")
    set(folder hal/stm32f405)
    set(source hal/stm32/startup.c)
  endif()
  planted_image(${name} stm32f405 ${folder} ${file} "${old}" "${new}" ${source})
  chip_finds(chip_finds_${name} "$<TARGET_FILE:planted_${name}>" "${finds}" target chip_protect)
endfunction()
planted_protection(a_program_that_can_be_written protected.h "PROTECTED_NOT_EIGHTHS 0x01U"
  "PROTECTED_NOT_EIGHTHS 0x03U" "the program is not written")
planted_protection(sectors_that_cannot_be_written protected.h "PROTECTED_NOT_EIGHTHS 0x01U"
  "PROTECTED_NOT_EIGHTHS 0x00U" "the application writes its sectors")
planted_protection(a_stack_without_its_guard startup.c "{link_guard_begin, MPU_NO_ACCESS"
  "{link_guard_begin, MPU_READ_WRITE" "an overflow of the stack is a fault")
planted_protection(variables_that_can_be_executed startup.c
  "MPU_READ_WRITE | MPU_NO_EXECUTE | MPU_SIZE(PROTECTED_RAM_LOG2)"
  "MPU_READ_WRITE | MPU_SIZE(PROTECTED_RAM_LOG2)" "the stack is not executed")

# The flash while the bridge switches. If the application does not look, the port refuses; what
# happens if that does not look either is seen by the model.
set(looks "!is_at_standstill(&snapshot->output) ||
        !fault_journal_is_due")
planted_image(an_application_that_does_not_look stm32f405 firmware/app app.c "${looks}"
  "!fault_journal_is_due")
add_test(NAME chip_port_refuses_flash_while_the_bridge_switches
  COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/chip_bridge"
    "$<TARGET_FILE:planted_an_application_that_does_not_look>" port)
set_tests_properties(chip_port_refuses_flash_while_the_bridge_switches
  PROPERTIES LABELS target TIMEOUT 120)
planted_source(PLANTED_ALSO flash_written_while_switching hal/stm32 flash.c
  "if (!bridge_is_on()) {" "if (!bridge_is_on() || true) {")
planted_image(flash_written_while_switching stm32f405 firmware/app app.c "${looks}"
  "!fault_journal_is_due")
unset(PLANTED_ALSO)
chip_finds(chip_finds_flash_written_while_switching
  "$<TARGET_FILE:planted_flash_written_while_switching>"
  "programming of the flash while the gates switch" "target;full" chip_bridge port)

# planted_cut(NAME FOLDER FILE OLD NEW FINDS [SOURCE]): found by cuts of the supply.
function(planted_cut name folder file old new finds)
  planted_image(${name} stm32f405 ${folder} ${file} "${old}" "${new}" ${ARGN})
  chip_finds(chip_finds_${name} "$<TARGET_FILE:planted_${name}>" "${finds}" "target;full"
    chip_cuts 32 0)
endfunction()
planted_cut(an_erase_of_another_sector hal/stm32 flash.c "flash_cells_erase(sector,"
  "flash_cells_erase((flash_sector_t)(sector + 1)," "erase of the other sector: none")
planted_cut(a_receiver_that_is_not_circular hal/stm32f405 serial_line.h "settings | DMA_S0CR_CIRC"
  "settings" "an update is not accepted" hal/stm32/serial.c)
set(store firmware/app config_store.c)
planted_cut(a_configuration_replaced_in_place ${store}
  "old.sector == FLASH_CONFIGURATION_A ? FLASH_CONFIGURATION_B : FLASH_CONFIGURATION_A"
  "old.sector" "a cell of the image: none")
planted_cut(a_mark_before_its_image ${store} "flash_status_t status = flash_erase(to);"
  "flash_status_t status = flash_erase(to);
   (void)flash_program(to, mark_at, mark, sizeof mark);" "a cell of the image: none")
planted_cut(an_old_configuration_given_up_first ${store} "flash_status_t status = flash_erase(to);"
  "static const uint32_t NONE[2] = {0, 0};
   (void)flash_program(old.sector, mark_at, NONE, sizeof NONE);
   flash_status_t status = flash_erase(to);" "a cell of the image: none")
planted_cut(a_mark_without_its_check ${store} "return mark[1] == ~mark[0]"
  "return mark[0] != UINT32_MAX" "first cell of the mark: new")
planted_cut(a_sector_that_is_not_erased ${store} "status = flash_erase(to)" "status = FLASH_OK"
  "an update does not end")
