# SPDX-License-Identifier: Apache-2.0
# hubfoc_stm32_port(TARGET BOARD_HEADER CHIP_SOURCE...): the port of one STM32 for one board, an
# object library: what the chips have in common (hal/stm32) and the sources of the chip, from whose
# folder this is called.
set(HUBFOC_STM32 "${PROJECT_SOURCE_DIR}/hal/stm32")
set(HUBFOC_STM32_SOURCES dead_time.c flash.c gpio.c interrupts.c inverter.c packets.c power.c
  rotor_sensor.c serial.c startup.c stop_timer.c time.c watchdog.c)
list(TRANSFORM HUBFOC_STM32_SOURCES PREPEND "${HUBFOC_STM32}/")
set(HUBFOC_STM32_APART flash.c startup.c)
list(TRANSFORM HUBFOC_STM32_APART PREPEND "${HUBFOC_STM32}/")
foreach(source IN ITEMS copy.c crash.c divide64.c fault_entry.c)
  list(APPEND HUBFOC_STM32_SOURCES "${PROJECT_SOURCE_DIR}/hal/cortex_m/${source}")
  list(APPEND HUBFOC_STM32_APART "${PROJECT_SOURCE_DIR}/hal/cortex_m/${source}")
endforeach()
list(APPEND HUBFOC_STM32_SOURCES "${PROJECT_SOURCE_DIR}/hal/cortex_m/memory.c")

# The PWM interrupt's; everything else no control step executes.
set(HUBFOC_STM32_FAST inverter.c rotor_sensor.c analog.c)

function(hubfoc_stm32_port target header)
  add_library(${target} OBJECT ${HUBFOC_STM32_SOURCES} ${ARGN})
  target_link_libraries(${target} PUBLIC hubfoc_hal PRIVATE hubfoc_warnings)
  target_compile_definitions(${target} PRIVATE "HUBFOC_BOARD_HEADER=\"${header}\"")
  target_include_directories(${target} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}" "${HUBFOC_STM32}")
  foreach(source IN LISTS HUBFOC_STM32_SOURCES ARGN)
    get_filename_component(name "${source}" NAME)
    if(NOT name IN_LIST HUBFOC_STM32_FAST)
      set_source_files_properties("${source}" PROPERTIES
        COMPILE_OPTIONS "$<$<CONFIG:Release>:-Os>")
    endif()
  endforeach()
  hubfoc_optimise_whole(${target} APART ${HUBFOC_STM32_APART})
endfunction()
