# SPDX-License-Identifier: Apache-2.0
# cmake -DELF=x.elf -DQEMU=qemu-system-arm -DLIMIT=limit.so,instructions=1000000000
# [-DMACHINE=mps2-an386]
#       [-DARGUMENTS="a=1 b=2"] [-DEXPECT_EXIT=0|1|limit]
#         [-DEXPECT="regex1|||regex2"] [-DSAME_AS=program] [-DTIMELESS=ON]
#       -P run_on_qemu.cmake
#
# Runs a program on the emulated core and judges exit status and output. Always with a limit of
# instructions (limit.c) and with semihosting switched on: without it the first request aborts the
# emulator. The instruction-count clock makes every run the same. TIMELESS: without that clock, for
# a program that looks at no timer; it takes a third of the emulator's time. SAME_AS: a host program
# that must print the same text. EXPECT_EXIT=limit: the program runs on until it is ended.
cmake_minimum_required(VERSION 3.25)

foreach(default IN ITEMS MACHINE=mps2-an386 EXPECT_EXIT=0 TIMELESS=OFF)
  string(REPLACE "=" ";" default "${default}")
  list(GET default 0 name)
  if(NOT DEFINED ${name})
    list(GET default 1 ${name})
  endif()
endforeach()
if(NOT QEMU)
  message(FATAL_ERROR "qemu-system-arm was not found when this build was configured; "
    "./tools/dev setup qemu installs it")
endif()

set(semihosting "enable=on,target=native,arg=hubfoc")
separate_arguments(ARGUMENTS)
foreach(argument IN LISTS ARGUMENTS)
  string(APPEND semihosting ",arg=${argument}")
endforeach()
# An emulator whose test is killed, by ctest's time limit or by hand, ends with it.
find_program(SETPRIV setpriv)
set(ends_with_its_test "")
if(SETPRIV)
  set(ends_with_its_test "${SETPRIV}" --pdeathsig KILL)
endif()
set(clock "")
if(NOT TIMELESS)
  set(clock -icount shift=3,sleep=off)
endif()
execute_process(COMMAND ${ends_with_its_test} "${QEMU}" -M ${MACHINE} -display none -monitor none
  -serial stdio ${clock} -semihosting-config "${semihosting}" -plugin "${LIMIT}" -kernel "${ELF}"
  INPUT_FILE /dev/null
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
message("${output}")

if(EXPECT_EXIT STREQUAL "limit")
  if(NOT (result EQUAL 124 AND output MATCHES "instruction limit: more than"))
    message(FATAL_ERROR "exit status ${result}, but the program was expected to run on")
  endif()
elseif(NOT result STREQUAL EXPECT_EXIT)
  message(FATAL_ERROR "exit status ${result}, expected ${EXPECT_EXIT}")
endif()
string(REPLACE "|||" ";" EXPECT "${EXPECT}")
foreach(expected IN LISTS EXPECT)
  if(NOT output MATCHES "${expected}")
    message(FATAL_ERROR "the output holds nothing that matches: ${expected}")
  endif()
endforeach()

if(SAME_AS)
  execute_process(COMMAND "${SAME_AS}" RESULT_VARIABLE host_result OUTPUT_VARIABLE host_output)
  if(NOT host_result EQUAL 0 OR host_output STREQUAL "")
    message(FATAL_ERROR "${SAME_AS}: exit status ${host_result}, output '${host_output}'")
  endif()
  if(NOT output STREQUAL host_output)
    message(FATAL_ERROR "the host's output differs:\n${host_output}")
  endif()
endif()
