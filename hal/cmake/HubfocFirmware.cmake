# SPDX-License-Identifier: Apache-2.0
# hubfoc_add_firmware(NAME hubfoc_stm32f405 LINKER_SCRIPT link.ld PORT hubfoc_port_stm32f405
# STACK_BYTES 4096
#                     INTERRUPTS lowest_handler ... highest_handler FAULTS handler)
#
# The firmware of one port: <name>.elf with its CRC filled in, <name>.bin, <name>.hex, and
# <name>_config.bin and <name>_config.hex, the configuration alone, for the serial line, and
# <name>_config_probe.hex, the same with its address and with whatever else of the port's linker
# script a probe has to write with it. Prints the size of what was
# linked and, where there is a Python, the worst-case depth of the stack, which fails the build if
# STACK_BYTES, less the 32 of the guard below, are not enough for main() and one of each interrupt
# on top of each other. FAULTS: the faults' handler, which has a stack of its own.
set(HUBFOC_SEAL "${CMAKE_CURRENT_LIST_DIR}/seal_image.cmake")
find_program(HUBFOC_REPORT_PYTHON python3 DOC "Any Python 3.11 or newer, for the stack report")

# What each function puts on the stack, and whom it calls, beside every object that is compiled
# apart, and beside the program.
target_compile_options(hubfoc_warnings INTERFACE -fcallgraph-info=su)

function(hubfoc_add_firmware)
  cmake_parse_arguments(F "" "NAME;LINKER_SCRIPT;PORT;STACK_BYTES;FAULTS"
    "INTERRUPTS" ${ARGN})
  cmake_path(ABSOLUTE_PATH F_LINKER_SCRIPT NORMALIZE)
  target_compile_definitions(hubfoc_config_image PRIVATE
    "CONFIG_SECTION=__attribute__((section(\".hubfoc_config\"),used))")
  add_executable(${F_NAME})
  target_link_libraries(${F_NAME} PRIVATE hubfoc_app_main hubfoc_app ${F_PORT} hubfoc_config_image)
  hubfoc_link_whole(${F_NAME})
  target_link_options(${F_NAME} PRIVATE -nostartfiles --specs=nano.specs "-T${F_LINKER_SCRIPT}"
    "-L${PROJECT_SOURCE_DIR}/hal/stm32"
    "-Wl,--defsym=link_stack_size=${F_STACK_BYTES}" "-Wl,-Map=${PROJECT_BINARY_DIR}/${F_NAME}.map"
    -Wl,--print-memory-usage)
  set_target_properties(${F_NAME} PROPERTIES SUFFIX .elf
    RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}"
    LINK_DEPENDS "${F_LINKER_SCRIPT};${PROJECT_SOURCE_DIR}/hal/stm32/sections.ld")
  if(HUBFOC_REPORT_PYTHON)
    list(TRANSFORM F_INTERRUPTS PREPEND "--interrupt=" OUTPUT_VARIABLE interrupts)
    # boot.h and app.c: everything before inverter_start() and time_start_tick().
    foreach(called IN ITEMS boot_run console_greet controller_init controller_initial_setpoint
        controller_fast_report recorder_init background_check_init can_link_init pedal_link_init)
      list(APPEND interrupts "--before-interrupts=app_boot:${called}")
    endforeach()
    if(F_FAULTS)
      list(APPEND interrupts "--own-stack=${F_FAULTS}")
    endif()
    math(EXPR stack_limit "${F_STACK_BYTES} - 32")
    set(stack_report "${HUBFOC_REPORT_PYTHON}"
      "${PROJECT_SOURCE_DIR}/tools/benchmark/stack_report.py"
      "--elf=${PROJECT_BINARY_DIR}/${F_NAME}.elf" "--objects=${PROJECT_BINARY_DIR}/firmware"
      "--objects=${PROJECT_BINARY_DIR}/hal" --limit=${stack_limit} --root=main ${interrupts})
  else()
    set(stack_report "${CMAKE_COMMAND}" -E echo "No stack report: no python3")
  endif()
  set(stem "${PROJECT_BINARY_DIR}/${F_NAME}")
  # BIN from HEX: an empty .data has its address in RAM once the image is sealed, and straight from
  # the ELF the file would be filled up to there, 400 MB.
  add_custom_command(TARGET ${F_NAME} POST_BUILD
    COMMAND "${CMAKE_COMMAND}" "-DELF=${stem}.elf" "-DOBJCOPY=${CMAKE_OBJCOPY}" -P "${HUBFOC_SEAL}"
    COMMAND "${CMAKE_OBJCOPY}" -O ihex "${stem}.elf" "${stem}.hex"
    COMMAND "${CMAKE_OBJCOPY}" -I ihex -O binary --gap-fill 0xFF "${stem}.hex" "${stem}.bin"
    COMMAND "${CMAKE_OBJCOPY}" -O binary --only-section=.hubfoc_config "${stem}.elf"
    "${stem}_config.bin"
    COMMAND "${CMAKE_OBJCOPY}" -I binary -O ihex "${stem}_config.bin" "${stem}_config.hex"
    COMMAND "${CMAKE_OBJCOPY}" -O ihex --only-section=.hubfoc_config
    --only-section=.hubfoc_config_mark "${stem}.elf" "${stem}_config_probe.hex"
    COMMAND "${CMAKE_SIZE}" --format=berkeley "${stem}.elf"
    COMMAND ${stack_report}
    BYPRODUCTS "${stem}.bin" "${stem}.hex" "${stem}_config.bin" "${stem}_config.hex"
    "${stem}_config_probe.hex" VERBATIM)
endfunction()
