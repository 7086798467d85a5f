# SPDX-License-Identifier: Apache-2.0
# The flashable image of the STM32G431 on the model of its chip (chip/README.md). The programs are
# of the host's build (chip/CMakeLists.txt).
set(g431_programs "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip")

# chip_g431_test(NAME PROGRAM ELF LABELS ARGUMENT...)
function(chip_g431_test name program elf labels)
  add_test(NAME ${name} COMMAND "${g431_programs}/${program}" "${elf}" ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 600)
endfunction()

# chip_g431_tests(ELF): boot and a stop are quick; the rest is labelled full.
function(chip_g431_tests elf)
  chip_g431_test(chip_g431_boots_and_brakes chip_test_g431 "${elf}" target stop)
  chip_g431_test(chip_g431_stops_by_other_torques chip_test_g431 "${elf}" "target;full" stops)
  chip_g431_test(chip_g431_trips_on_over_current chip_trip_g431 "${elf}" "target;full")
  chip_g431_test(chip_g431_protects_its_memory chip_protect_g431 "${elf}" target)
  chip_g431_test(chip_g431_writes_no_flash_while_the_bridge_switches chip_bridge_g431 "${elf}"
    "target;full" application)
  chip_g431_test(chip_g431_counts_its_starts chip_starts_g431 "${elf}" "target;full")
  chip_g431_test(chip_g431_shows_a_crash_after_its_restart chip_crash_g431 "${elf}" "target;full")
  chip_g431_test(chip_g431_answers_faults chip_faults_g431 "${elf}" "target;full")
  chip_g431_test(chip_g431_sends_in_time_on_a_busy_bus chip_load_g431 "${elf}" target)
  chip_g431_test(chip_g431_sends_in_time_on_a_busy_bus_for_long chip_load_g431 "${elf}"
    "target;full")
  set_tests_properties(chip_g431_sends_in_time_on_a_busy_bus_for_long PROPERTIES
    ENVIRONMENT HUBFOC_FOR_LONG=1)
  chip_g431_test(chip_g431_receives_no_frame_of_29_bits chip_vesc_g431 "${elf}" target)
  chip_g431_test(chip_g431_keeps_a_configuration_when_the_supply_fails chip_cuts_g431 "${elf}"
    "target;full" 64 4)
  chip_g431_test(chip_g431_keeps_a_configuration_in_1000_failures_of_the_supply chip_cuts_g431
    "${elf}" "target;full" 1000 100)
  chip_g431_test(chip_g431_keeps_a_configuration_in_a_failure_at_each_write chip_cuts_g431
    "${elf}" "target;full" every)
  chip_g431_test(chip_g431_has_no_fault_after_a_record_of_the_journal chip_journal_g431 "${elf}"
    target status)
  chip_g431_test(chip_g431_keeps_its_journal_in_a_failure_at_each_write chip_journal_g431
    "${elf}" "target;full")
  set_tests_properties(chip_g431_keeps_a_configuration_in_1000_failures_of_the_supply
    chip_g431_keeps_a_configuration_in_a_failure_at_each_write
    chip_g431_keeps_its_journal_in_a_failure_at_each_write PROPERTIES TIMEOUT 3600)
endfunction()

# planted_g431(NAME FOLDER FILE OLD NEW FINDS PROGRAM ARGUMENT...): found by this program, and with
# what (planted.cmake).
function(planted_g431 name folder file old new finds program)
  set(source "")
  if(file STREQUAL "serial_line.h")
    set(source hal/stm32/serial.c)
  elseif(file STREQUAL "protected.h")
    set(source hal/stm32/startup.c)
  elseif(file STREQUAL "stop_route.h")
    set(source hal/stm32/stop_timer.c)
  endif()
  planted_image(${name} stm32g431 ${folder} ${file} "${old}" "${new}" ${source})
  chip_finds(chip_g431_finds_${name} "$<TARGET_FILE:planted_${name}>" "${finds}" target
    ${program} ${ARGN})
endfunction()

# Errors planted in the driver, of which the model must find each.
function(chip_g431_planted_tests)
  if(NOT HUBFOC_PYTHON)
    return()
  endif()
  set(own hal/stm32g431)
  set(shared hal/stm32)
  set(stop chip_test_g431 stop)
  set(trip chip_trip_g431)
  set(cut chip_cuts_g431 32 0)
  planted_image(no_error stm32g431 ${shared} inverter.c "TIM1->PSC = 0;" "TIM1->PSC = 0;")
  chip_g431_test(chip_g431_finds_no_error chip_test_g431 "$<TARGET_FILE:planted_no_error>" target
    stop)
  planted_g431(a_gate_of_reversed_polarity ${shared} inverter.c "TIM_CCER_CC1NE |"
    "TIM_CCER_CC1NE | (1U << 3) |"
    "leg 0: a gate of reversed polarity" ${stop})
  planted_g431(a_short_dead_time ${shared} inverter.c "(dead_time_code <<" "(dead_time_code / 4U <<"
    "dead time shorter than configured" ${stop})
  planted_g431(a_trigger_at_the_bottom ${shared} inverter.c ": top_counts + trigger_counts" ": 1"
    "currents are not held in the middle of the low pulses" ${stop})
  planted_g431(a_trigger_at_the_top ${shared} inverter.c "top_counts + trigger_counts"
    "top_counts - 1"
    "currents are not held in the middle of the low pulses" ${stop})
  planted_g431(gates_of_another_function ${shared} inverter.c "BOARD_AF_GATE_LOW_C, GPIO"
    "BOARD_AF_GATE_LOW_B, GPIO"
    "leg 2: only some of its gates are driven" ${stop})
  planted_g431(a_wrong_gain_of_the_amplifiers ${own} analog.c "GAIN_16_BIAS_AT_VINM0 = 11"
    "GAIN_16_BIAS_AT_VINM0 = 10"
    "fault: current sensor offset out of range" ${stop})
  planted_g431(an_amplifier_without_its_pin ${own} analog.c "gpio_make_analog(out)"
    "gpio_make_input(out, GPIO_PULL_NONE)"
    "ADC1: the pin of channel 3 is not analogue" ${stop})
  planted_g431(a_converter_before_its_regulator ${own} analog.c
    "(void)wait_for(&adc->CR, 0, 1, POLLS_REGULATOR)" ""
    "ADC1: used before its regulator is up" ${stop})
  planted_g431(a_sampling_time_too_short ${own} analog.c "SAMPLE_47_CYCLES = 4"
    "SAMPLE_47_CYCLES = 3"
    "ADC1: 24.5 cycles of sampling are too few" ${stop})
  planted_g431(too_few_wait_states ${own} clock.c "FLASH_WAIT_STATES = 4" "FLASH_WAIT_STATES = 3"
    "flash read at 170 MHz with 3 of 4 wait states" ${stop})
  planted_g431(no_boost ${own} clock.c "PWR->CR5 &= ~(uint32_t)PWR_CR5_R1MODE" ""
    "clock fault: crystal or PLL did not start" ${stop})
  planted_g431(full_frequency_at_once ${own} clock.c "<< RCC_CFGR_HPRE_Pos |" "* 0U |"
    "the core's clock steps from 16 to 170 MHz" ${stop})
  planted_g431(a_stop_of_another_request ${own} stop_route.h "STOP_REQUEST = 53"
    "STOP_REQUEST = 52" "the torque goes in time and stays away" chip_faults_g431)
  planted_g431(a_wrong_can_filter ${own} can.c "27 | first << 16" "27 | first << 15"
    "comes to RUN" ${stop})
  planted_g431(received_frames_of_29_bits ${own} can.c "REJECT << FDCAN1_RXGFC_ANFE_Pos"
    "0 << FDCAN1_RXGFC_ANFE_Pos" "frames of 29 bits are not received" chip_vesc_g431)
  planted_g431(a_wrong_can_bit_rate ${own} can.c "(PRESCALER - 1)" "PRESCALER"
    "CAN: a bit of 4000 ns on a bus of 2000" ${stop})
  planted_g431(a_transceiver_shut_down ${shared} power.c "(pin_t){port, number}, level)"
    "(pin_t){port, number}, true)"
    "its messages are on CAN" ${stop})
  planted_g431(a_line_of_another_request ${own} serial_line.h "SERIAL_REQUEST_TRANSMIT = 27"
    "SERIAL_REQUEST_TRANSMIT = 29"
    "greets on its serial line" ${stop})
  planted_g431(a_transfer_counted_while_it_is_on ${own} serial_line.h
    "CCR = DMA_CCR1_MINC | DMA_CCR1_DIR;" "CCR |= DMA_CCR1_MINC | DMA_CCR1_DIR;"
    "DMA1 channel 2: 0x40020020 written while it is enabled" ${stop})
  planted_g431(an_over_current_not_connected ${own} overcurrent.c "TIM_AF2_BK2CMP1E |" ""
    "an over-current takes all gates within a microsecond" ${trip})
  planted_g431(an_over_current_threshold_too_high ${own} overcurrent.c "BOARD_TRIP_A * BOARD_SHUNT"
    "BOARD_TRIP_A * 2 * BOARD_SHUNT"
    "an over-current takes all gates within a microsecond" ${trip})
  planted_g431(an_over_current_threshold_too_low ${own} overcurrent.c "BOARD_TRIP_A * BOARD_SHUNT"
    "BOARD_TRIP_A / 2 * BOARD_SHUNT"
    "the board's largest current is no fault" ${trip})
  planted_g431(comparators_that_are_not_tried ${own} overcurrent.c "level >= LEVEL_LEAST_CODE"
    "level + CODES >= LEVEL_LEAST_CODE"
    "names dead comparators" ${trip})
  planted_g431(an_over_current_that_is_no_fault ${shared} inverter.c
    "return tripped || break_acted()" "return tripped"
    "the over-current is the power stage's" ${trip})
  planted_g431(a_program_that_can_be_written ${own} protected.h "PROTECTED_NOT_EIGHTHS 0xC0U"
    "PROTECTED_NOT_EIGHTHS 0xE0U" "the program is not written" chip_protect_g431)
  planted_g431(sectors_that_cannot_be_written ${own} protected.h "PROTECTED_NOT_EIGHTHS 0xC0U"
    "PROTECTED_NOT_EIGHTHS 0x80U" "the application writes its sectors" chip_protect_g431)
  planted_g431(an_erase_of_another_page ${shared} flash.c "(uintptr_t)whole.begin, i)"
    "(uintptr_t)whole.begin, i + 1U)"
    "double word at 0x0801B000 programmed twice" ${cut})
  planted_g431(an_unreadable_word_that_is_a_fault ${own} flash_error.c "is_of_a_sector(FLASH->ECCR)"
    "FLASH->ECCR == 0"
    "last cell of the mark: none" ${cut})
endfunction()
