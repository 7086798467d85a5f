# SPDX-License-Identifier: Apache-2.0
# cmake -DELF=good.elf -DBAD=bad.elf -DSECTION=.hubfoc_config -DOFFSET=100 -DOBJCOPY=...
# -DHAL_CMAKE=hal/cmake -P damage.cmake
#
# A copy of an ELF in which one byte of a section has all its bits turned over.
cmake_minimum_required(VERSION 3.25)
include("${HAL_CMAKE}/write_bytes.cmake")

execute_process(COMMAND "${OBJCOPY}" -O binary "--only-section=${SECTION}" "${ELF}" "${BAD}.bin"
  COMMAND_ERROR_IS_FATAL ANY)
file(READ "${BAD}.bin" bytes HEX)
math(EXPR at "2 * ${OFFSET}")
math(EXPR behind "${at} + 2")
string(SUBSTRING "${bytes}" 0 ${at} before)
string(SUBSTRING "${bytes}" ${at} 2 byte)
string(SUBSTRING "${bytes}" ${behind} -1 after)
math(EXPR byte "(0x${byte} ^ 255) + 256" OUTPUT_FORMAT HEXADECIMAL)
string(SUBSTRING "${byte}" 3 2 byte)
write_bytes("${OBJCOPY}" "${BAD}.bin" "${before}${byte}${after}")
execute_process(COMMAND "${OBJCOPY}" "--update-section=${SECTION}=${BAD}.bin" "${ELF}" "${BAD}"
  COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE "${BAD}.bin")
