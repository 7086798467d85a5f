# SPDX-License-Identifier: Apache-2.0
# The flashable image for the STM32G431. The linker checks that it fits (hal/stm32g431/link.ld), the
# report behind it the depth of the stack. It runs on the model of its chip.
add_test(NAME stm32g431_image_is_laid_out_as_documented
  COMMAND "${CMAKE_COMMAND}" "-DNM=${CMAKE_NM}" "-DELF=$<TARGET_FILE:hubfoc_stm32g431>"
    "-DCONFIG=CONFIG_${config_symbol}" -DCHIP=stm32g431
    -P "${CMAKE_CURRENT_LIST_DIR}/check_layout.cmake")
set_tests_properties(stm32g431_image_is_laid_out_as_documented PROPERTIES LABELS target TIMEOUT 60)

find_program(HUBFOC_PYTHON python3 HINTS "${PROJECT_SOURCE_DIR}/.dev/venv/bin"
  NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH
  DOC "Python of the project's private environment (./tools/dev setup makes it)")

# Wheel and wiring are those of the bench configuration and of the only board.
if(HUBFOC_CONFIG STREQUAL "wheel24v")
  include(planted.cmake)
  include(chip_g431.cmake)
  chip_g431_tests("$<TARGET_FILE:hubfoc_stm32g431>")
  chip_g431_planted_tests()
endif()
