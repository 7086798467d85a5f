# SPDX-License-Identifier: Apache-2.0
# The flashable image for the STM32G431. The linker checks that it fits (hal/stm32g431/link.ld), the
# report behind it the depth of the stack. No emulator has this chip's peripherals.
add_test(NAME stm32g431_image_is_laid_out_as_documented
  COMMAND "${CMAKE_COMMAND}" "-DNM=${CMAKE_NM}" "-DELF=$<TARGET_FILE:hubfoc_stm32g431>"
    "-DCONFIG=CONFIG_${config_symbol}" -DCHIP=stm32g431
    -P "${CMAKE_CURRENT_LIST_DIR}/check_layout.cmake")
set_tests_properties(stm32g431_image_is_laid_out_as_documented PROPERTIES LABELS target TIMEOUT 60)
