# SPDX-License-Identifier: Apache-2.0
# cmake -DELF=firmware.elf -DOBJCOPY=arm-none-eabi-objcopy -P seal_image.cmake
#
# Fills the section .image_crc with the CRC-32 (IEEE 802.3, as zlib's) of everything between
# link_image_begin and link_image_end, so that the firmware can check itself at every start. A
# script of CMake's own, because the firmware must build with a cross compiler alone: no Python, no
# host compiler.
cmake_minimum_required(VERSION 3.25)
include("${CMAKE_CURRENT_LIST_DIR}/write_bytes.cmake")

foreach(needed IN ITEMS ELF OBJCOPY)
  if(NOT ${needed})
    message(FATAL_ERROR "seal_image: -D${needed}=... is missing")
  endif()
endforeach()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result ERROR_VARIABLE error)
  if(result)
    message(FATAL_ERROR "seal_image: ${ARGN}: ${error}")
  endif()
endfunction()

# The bytes that are checked: all loaded sections but those that lie outside the image.
run("${OBJCOPY}" -O binary --remove-section=.boot_vectors --remove-section=.hubfoc_config
  --remove-section=.hubfoc_config_mark --remove-section=.image_crc
  "${ELF}" "${ELF}.image")
file(READ "${ELF}.image" bytes HEX)
file(REMOVE "${ELF}.image")
string(LENGTH "${bytes}" digits)
math(EXPR count "${digits} / 2")

# Half a byte at a time: a table of 16 instead of 256 entries costs less to set up than it saves.
foreach(index RANGE 15)
  set(entry ${index})
  foreach(bit RANGE 3)
    math(EXPR entry "(${entry} >> 1) ^ (0xEDB88320 * (${entry} & 1))")
  endforeach()
  set(TABLE_${index} ${entry})
endforeach()
set(crc 0xFFFFFFFF)
string(REGEX MATCHALL ".." bytes "${bytes}")
foreach(byte IN LISTS bytes)
  math(EXPR index "(${crc} ^ 0x${byte}) & 15")
  math(EXPR crc "(${crc} >> 4) ^ ${TABLE_${index}}")
  math(EXPR index "(${crc} ^ (0x${byte} >> 4)) & 15")
  math(EXPR crc "(${crc} >> 4) ^ ${TABLE_${index}}")
endforeach()
math(EXPR crc "${crc} ^ 0xFFFFFFFF")

set(bytes "")
foreach(shift IN ITEMS 0 8 16 24)
  math(EXPR byte "((${crc} >> ${shift}) & 255) + 256" OUTPUT_FORMAT HEXADECIMAL)
  string(SUBSTRING "${byte}" 3 2 byte)
  string(APPEND bytes "${byte}")
endforeach()
write_bytes("${OBJCOPY}" "${ELF}.crc" "${bytes}")
run("${OBJCOPY}" "--update-section=.image_crc=${ELF}.crc" "${ELF}")
file(REMOVE "${ELF}.crc")
math(EXPR crc "${crc}" OUTPUT_FORMAT HEXADECIMAL)
message(STATUS "Firmware image: ${count} bytes, CRC-32 ${crc}")
