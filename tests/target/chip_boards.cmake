# SPDX-License-Identifier: Apache-2.0
# The flashable images of the other boards with an STM32F405 on the model of the chip
# (chip/README.md, chip/stm32f405/boards.c).
if(NOT HUBFOC_PYTHON) # pwm_interrupt_budget says so
  return()
endif()
set(boards_programs "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip")
set(boards_shipped "${PROJECT_SOURCE_DIR}/firmware/config/generated/lu2013.bin")

# board_image(BOARD LABELS): as tools/dev firmware --board builds it, with its own build folder.
function(board_image board labels)
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/${board}")
  add_test(NAME ${board}_image_fits
    COMMAND "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}" "${folder}"
      --build-generator Ninja --build-target hubfoc_stm32f405 --build-options
      -DHUBFOC_PORT=stm32f405 -DHUBFOC_BOARD=${board} -DHUBFOC_CONFIG=lu2013 -DHUBFOC_TESTS=OFF
      "-DCMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE}" -DCMAKE_BUILD_TYPE=Release
      --test-command "${CMAKE_COMMAND}" "-DNM=${CMAKE_NM}"
      "-DELF=${folder}/hubfoc_stm32f405.elf" -DCONFIG=CONFIG_LU2013 -DCHIP=stm32f405
      -P "${CMAKE_CURRENT_LIST_DIR}/check_layout.cmake")
  set_tests_properties(${board}_image_fits PROPERTIES LABELS "${labels}" TIMEOUT 600
    FIXTURES_SETUP ${board}_image)
endfunction()

# board_test(NAME BOARD LABELS PROGRAM ARGUMENT...): PROGRAM with the board's image.
function(board_test name board labels program)
  add_test(NAME ${name} COMMAND "${boards_programs}/${program}"
    "${CMAKE_CURRENT_BINARY_DIR}/${board}/hubfoc_stm32f405.elf" ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 120
    FIXTURES_REQUIRED "${board}_image;vesc4_configuration")
endfunction()

# The paper's vehicle with pulses that the shunts of a VESC 4 need (hal/stm32f405/DERIVATIONS.md,
# Sampling window).
set(boards_folder "${CMAKE_CURRENT_BINARY_DIR}/vesc4")
set(boards_long_pulses "${boards_folder}/vesc4.bin")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  "${PROJECT_SOURCE_DIR}/tools/motors/lu2013.toml")
file(READ "${PROJECT_SOURCE_DIR}/tools/motors/lu2013.toml" boards_toml)
string(REGEX REPLACE "\nmin_pulse_s = [^ \n]+" "\nmin_pulse_s = 1.52e-6" boards_own
  "${boards_toml}")
if(boards_own STREQUAL boards_toml)
  message(FATAL_ERROR "tools/motors/lu2013.toml has no min_pulse_s")
endif()
file(CONFIGURE OUTPUT "${boards_folder}/vesc4.toml" CONTENT "${boards_own}" @ONLY)
add_test(NAME vesc4_configuration_is_generated
  COMMAND "${HUBFOC_PYTHON}" -m regen_table generate "${boards_folder}/vesc4.toml"
    -o "${boards_folder}" WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tools")
set_tests_properties(vesc4_configuration_is_generated PROPERTIES LABELS target TIMEOUT 120
  FIXTURES_SETUP vesc4_configuration ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")

# Linked from this build's modules; with --full once more as a build of its own.
set(PLANTED_BOARD vesc4_10)
planted_image(vesc4_no_error stm32f405 hal/stm32 inverter.c "TIM1->PSC = 0;" "TIM1->PSC = 0;")

# vesc4_test(NAME PROGRAM ARGUMENT...)
function(vesc4_test name program)
  add_test(NAME ${name} COMMAND "${boards_programs}/${program}"
    "$<TARGET_FILE:planted_vesc4_no_error>" ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS target TIMEOUT 120
    FIXTURES_REQUIRED vesc4_configuration)
endfunction()
set(board_vesc4 vesc4_10 "${boards_long_pulses}")
vesc4_test(chip_vesc4_boots_and_brakes chip_test stop ${board_vesc4})
vesc4_test(chip_vesc4_brakes_at_the_largest_voltage chip_window fast ${board_vesc4})
vesc4_test(chip_vesc4_refuses_short_pulses chip_window refused vesc4_10 "${boards_shipped}")
vesc4_test(chip_vesc4_latches_over_currents chip_latch latches ${board_vesc4})
set_tests_properties(chip_vesc4_latches_over_currents PROPERTIES TIMEOUT 300) # three trips
hubfoc_run_when_changed(chip_vesc4_latches_over_currents hal tests/target)
hubfoc_run_when_changed(chip_vesc4_brakes_at_the_largest_voltage hal tests/target)
vesc4_test(chip_vesc4_reads_its_sensors chip_sensors ${board_vesc4})
board_image(vesc4_10 "target;full")
board_test(chip_vesc4_of_its_own_build_boots_and_brakes vesc4_10 "target;full" chip_test stop
  ${board_vesc4})
board_test(chip_vesc4_finds_a_driver_that_limits vesc4_10 "target;full" chip_latch limits
  ${board_vesc4} --finds "an over-current takes all gates within a microsecond")

# The first board's image is the build's own.
add_test(NAME chip_vesc6_mk3_reads_its_sensors COMMAND "${boards_programs}/chip_sensors"
  "$<TARGET_FILE:hubfoc_stm32f405>" vesc6_mk3 "${boards_shipped}")
set_tests_properties(chip_vesc6_mk3_reads_its_sensors PROPERTIES LABELS target TIMEOUT 120)

# The paper's vehicle with winding sensors of each kind; the table's points are those of
# chip/thermometers.c.
foreach(kind ntc pt1000 kty84 table none)
  set(points "")
  if(kind STREQUAL table)
    set(points "winding_sensor_points = [[-20.0, 97e3], [25.0, 10e3], [60.0, 2488.0],
  [120.0, 389.0], [150.0, 200.0]]")
  endif()
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/winding_${kind}")
  file(CONFIGURE OUTPUT "${folder}/winding_${kind}.toml" @ONLY CONTENT "${boards_toml}
[monitor]
winding_sensor = \"${kind}\"
${points}
")
  add_test(NAME winding_${kind}_configuration_is_generated
    COMMAND "${HUBFOC_PYTHON}" -m regen_table generate "${folder}/winding_${kind}.toml"
      -o "${folder}" WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tools")
  set_tests_properties(winding_${kind}_configuration_is_generated PROPERTIES LABELS target
    TIMEOUT 120 FIXTURES_SETUP winding_${kind} ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
  add_test(NAME chip_reads_a_winding_sensor_of_kind_${kind}
    COMMAND "${boards_programs}/chip_thermometers" "$<TARGET_FILE:hubfoc_stm32f405>" vesc6_mk3
      ${kind} "${folder}/winding_${kind}.bin")
  set_tests_properties(chip_reads_a_winding_sensor_of_kind_${kind} PROPERTIES LABELS target
    TIMEOUT 120 FIXTURES_REQUIRED winding_${kind})
  hubfoc_run_when_changed(chip_reads_a_winding_sensor_of_kind_${kind} hal tests/target
    tools/regen_table)
endforeach()

# Boards with sensors in the phases, without a gate driver's bus: the paper's vehicle with their
# full scales.
# scaled_board(BOARD CURRENT_A VOLTAGE_V DEAD_TIME_S BANDWIDTH_HZ LABELS)
function(scaled_board board current_a voltage_v dead_time_s bandwidth_hz labels)
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/${board}_drive")
  set(own "${boards_toml}")
  foreach(pair "current_full_scale_a=${current_a}" "voltage_full_scale_v=${voltage_v}"
      "dead_time_s=${dead_time_s}" "current_bandwidth_hz=${bandwidth_hz}")
    string(REPLACE "=" ";" pair "${pair}")
    list(GET pair 0 key)
    list(GET pair 1 value)
    string(REGEX REPLACE "\n${key} = [^ \n]+" "\n${key} = ${value}" own "${own}")
  endforeach()
  file(CONFIGURE OUTPUT "${folder}/${board}.toml" CONTENT "${own}" @ONLY)
  add_test(NAME ${board}_configuration_is_generated
    COMMAND "${HUBFOC_PYTHON}" -m regen_table generate "${folder}/${board}.toml" -o "${folder}"
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tools")
  set_tests_properties(${board}_configuration_is_generated PROPERTIES LABELS "${labels}"
    TIMEOUT 120 FIXTURES_SETUP ${board}_configuration ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
  set(PLANTED_BOARD ${board})
  planted_image(${board}_no_error stm32f405 hal/stm32 inverter.c "TIM1->PSC = 0;" "TIM1->PSC = 0;")
  add_test(NAME chip_${board}_boots_and_brakes COMMAND "${boards_programs}/chip_test"
    "$<TARGET_FILE:planted_${board}_no_error>" stop ${board} "${folder}/${board}.bin")
  set_tests_properties(chip_${board}_boots_and_brakes PROPERTIES LABELS "${labels}" TIMEOUT 120
    FIXTURES_REQUIRED ${board}_configuration)
  if("full" IN_LIST labels)
    hubfoc_only_full(planted_${board}_no_error)
  endif()
endfunction()
scaled_board(vesc75_300 516.0 91.0 1e-6 1000.0 target)
scaled_board(mks84_200_hp 495.0 87.3 1e-6 1000.0 "target;full")
scaled_board(gate_board 1200.0 1000.0 2e-6 500.0 target)

board_image(vesc6_mk6 "target;full")
board_test(chip_vesc6_mk6_reads_its_sensors vesc6_mk6 "target;full" chip_sensors vesc6_mk6
  "${boards_shipped}")
board_test(chip_vesc6_mk6_boots_and_brakes vesc6_mk6 "target;full" chip_test stop vesc6_mk6)
board_test(chip_vesc6_mk6_gate_driver_protects vesc6_mk6 "target;full" chip_test driver vesc6_mk6)

# Errors planted in what only the VESC 4 uses.
# planted_vesc4(NAME FOLDER FILE OLD NEW FINDS PROGRAM MODE CONFIGURATION)
function(planted_vesc4 name folder file old new finds program mode configuration)
  planted_image(vesc4_${name} stm32f405 ${folder} ${file} "${old}" "${new}")
  chip_finds(chip_vesc4_finds_${name} "$<TARGET_FILE:planted_vesc4_${name}>" "${finds}"
    "target;full" ${program} ${mode} vesc4_10 "${configuration}")
  set_tests_properties(chip_vesc4_finds_${name} PROPERTIES FIXTURES_REQUIRED vesc4_configuration)
endfunction()
planted_vesc4(short_pulses_that_are_accepted firmware/app board_check.c "if (least_ns == 0 ||"
  "if (least_ns >= 0 ||" "samples while the low sides conduct" chip_window fast
  "${boards_shipped}")
planted_vesc4(a_trigger_at_the_bottom hal/stm32 inverter.c ": top_counts + trigger_counts" ": 1"
  "currents are not held in the middle of the low pulses" chip_test stop "${boards_long_pulses}")
planted_vesc4(amplifiers_that_do_not_measure hal/stm32 power.c "(pin_t){port, number}, level)"
  "(pin_t){port, number}, true)" "drives the outputs that its board needs" chip_test stop
  "${boards_long_pulses}")
planted_vesc4(one_shunt_for_two_currents hal/stm32f405 analog.c
  "configure(ADC1, BOARD_CHANNEL_CURRENT_A" "configure(ADC1, BOARD_CHANNEL_CURRENT_C"
  "fault: phase over-current" chip_test stop "${boards_long_pulses}")
planted_vesc4(a_driver_fault_at_another_interrupt hal/stm32f405 gate_driver.c
  ": INTERRUPT_PINS_10_TO_15" ": INTERRUPT_PINS_5_TO_9"
  "the fault line takes all gates within 1 us" chip_test stop "${boards_long_pulses}")
planted_vesc4(a_driver_fault_of_wrong_polarity hal/stm32f405 gate_driver.c "EXTI->FTSR |="
  "EXTI->RTSR |=" "an over-current takes all gates within a microsecond" chip_latch latches
  "${boards_long_pulses}")
planted_vesc4(a_latch_that_is_not_released hal/stm32f405 gate_driver.c
  "gpio_write(BOARD_DRIVER_ENABLE, false);" ""
  "an acknowledgement at standstill releases the latch" chip_latch latches
  "${boards_long_pulses}")
planted_vesc4(a_latch_that_is_released_too_long hal/stm32f405 gate_driver.c
  "pause_for(POLLS_RELEASE);" "pause_for(8U * POLLS_RELEASE);"
  "EN_GATE low for more than 10 and less than 20 us" chip_latch latches "${boards_long_pulses}")
planted_vesc4(a_latch_that_is_released_at_once hal/stm32f405 gate_driver.c "*status = 0;"
  "*status = 0; gate_driver_release();" "the driver latches" chip_latch latches
  "${boards_long_pulses}")
unset(PLANTED_BOARD)
