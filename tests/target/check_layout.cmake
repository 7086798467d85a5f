# SPDX-License-Identifier: Apache-2.0
# cmake -DNM=arm-none-eabi-nm -DELF=hubfoc_stm32f405.elf -DCONFIG=CONFIG_LU2013 -DCHIP=stm32f405
#   -P check_layout.cmake
#
# Facts about the flashable image that no compiler checks: what has to be where
# (the link.ld of the chip's port).
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND "${NM}" "${ELF}" OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)

function(address_of symbol result)
  if(NOT symbols MATCHES "([0-9a-f]+) [A-Za-z] ${symbol}\n")
    message(FATAL_ERROR "no symbol ${symbol}")
  endif()
  set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

function(expect symbol address why)
  address_of(${symbol} found)
  if(NOT found STREQUAL address)
    message(FATAL_ERROR "${symbol} is at 0x${found}, not 0x${address}: ${why}")
  endif()
endfunction()

if(CHIP STREQUAL "stm32f405")
  expect(boot_vectors 08000000 "the core reads stack and entry from the start of the flash")
  expect(${CONFIG} 08004000 "the configuration begins sector 1, so that it can be flashed alone")
  expect(link_journal_end 08020000 "sectors 1 to 4 hold no program")
  expect(vectors 08020000 "the vector table begins the checked image, aligned to 512 bytes")
elseif(CHIP STREQUAL "stm32g431")
  expect(vectors 08000000 "the core reads stack and entry from the start of the flash")
  expect(link_image_begin 08000000 "the vector table is checked with the image")
  expect(${CONFIG} 0801b000 "the configuration begins a page, so that it can be flashed alone")
  expect(link_configuration_b 0801d000 "each configuration has four pages")
  expect(link_journal_end 08020000 "the journal ends with the flash")
else()
  message(FATAL_ERROR "-DCHIP=${CHIP}: stm32f405 or stm32g431")
endif()
expect(link_guard_begin 20000000 "an overflowing stack must leave RAM and fault")
