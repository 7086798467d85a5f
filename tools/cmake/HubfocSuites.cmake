# SPDX-License-Identifier: Apache-2.0
# hubfoc_suites(SOURCES NAMES FOLDER TESTS name|path... EXCEPT name...): the sources of a program of
# several test files, and the names of its suites (tests/unit/runner/suite.h). A name stands for
# test_NAME.c of this folder; without TESTS all of it are taken, without those of EXCEPT.
function(hubfoc_suites sources names folder)
  cmake_parse_arguments(S "" "" "TESTS;EXCEPT" ${ARGN})
  if(NOT S_TESTS)
    file(GLOB S_TESTS CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/test_*.c")
    list(TRANSFORM S_EXCEPT REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/test_\\1.c")
    list(REMOVE_ITEM S_TESTS ${S_EXCEPT})
  endif()
  list(TRANSFORM S_TESTS REPLACE "^([a-z0-9_]+)$" "${CMAKE_CURRENT_SOURCE_DIR}/test_\\1.c")
  list(TRANSFORM S_TESTS REPLACE "^.*/test_(.+)[.]c$" "\\1" OUTPUT_VARIABLE listed)
  list(TRANSFORM listed REPLACE "(.+)" "${folder}/suite_\\1.c" OUTPUT_VARIABLE written)
  list(APPEND written "${folder}/suites.c")
  set(script "${PROJECT_SOURCE_DIR}/tests/unit/runner/suites.py")
  add_custom_command(OUTPUT ${written}
    COMMAND "${HUBFOC_PYTHON}" "${script}" "${folder}" ${S_TESTS}
    DEPENDS ${S_TESTS} "${script}" VERBATIM)
  set(${sources} ${written} PARENT_SCOPE)
  set(${names} ${listed} PARENT_SCOPE)
endfunction()
