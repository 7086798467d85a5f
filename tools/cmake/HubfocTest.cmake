# SPDX-License-Identifier: Apache-2.0
# Unity and CMock (Debian/Ubuntu package "cmock", which carries Unity) wired into CTest.
#
#   hubfoc_add_unit_tests(NAME unit_core LIBRARIES hubfoc_core [TESTS q15 angle ...]
#     [EXCEPT angle ...] [APART angle ...] [SOURCES x.c ...] [MOCKS hal/include/hal/inverter.h ...]
#     [LABELS ...] [TIMEOUT seconds] [PLAIN])
#       One program of the files test_q15.c, test_angle.c, ... of this folder, by default all but
#       EXCEPT (tests/unit/runner/suite.h). It is one test of ctest; each file that is APART is
#       another. MOCKS are headers mocked by CMock. Run with sanitizers and to measure what they
#       reach; the plain host build only knows how to make them (tools/mutants).
#   hubfoc_add_python_test(NAME regen_table FILES test_a.py test_b.py [LABELS python]
#     [TIMEOUT seconds] [INSTRUMENTED] [LONGER])
#       pytest in the project's private environment. LONGER: with --full once more, with
#       HUBFOC_FOR_LONG in the environment, by which its files choose more cases. With sanitizers it
#       is run again only if it is INSTRUMENTED: executes C that this build compiled, in an
#       instrumented program or with the sanitizer loaded first.
#   hubfoc_add_command_test(NAME name COMMAND ... [LABELS ...] [TIMEOUT seconds])

hubfoc_require_test_tools()
set(UNITY_DIR "${CMOCK_DIR}/vendor/unity")
# Ruby runs with --disable=gems, which starts in less than half the time.
set(HUBFOC_CMOCK_YML "${PROJECT_SOURCE_DIR}/tools/cmake/cmock.yml")

add_library(unity STATIC "${UNITY_DIR}/src/unity.c" "${CMOCK_DIR}/src/cmock.c")
target_include_directories(unity SYSTEM PUBLIC "${UNITY_DIR}/src" "${CMOCK_DIR}/src")
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE CMOCK_MEM_DYNAMIC)

include(HubfocSuites)
add_library(hubfoc_run_suites OBJECT "${PROJECT_SOURCE_DIR}/tests/unit/runner/run_suites.c")
target_link_libraries(hubfoc_run_suites PRIVATE unity hubfoc_warnings)

function(hubfoc_add_unit_tests)
  cmake_parse_arguments(T "PLAIN" "NAME;TIMEOUT"
    "TESTS;EXCEPT;APART;SOURCES;LIBRARIES;MOCKS;LABELS" ${ARGN})
  set(gen "${CMAKE_CURRENT_BINARY_DIR}/${T_NAME}.gen")
  file(MAKE_DIRECTORY "${gen}")
  hubfoc_suites(suites names "${gen}" TESTS ${T_TESTS} EXCEPT ${T_EXCEPT})
  set(mock_sources "")
  foreach(header IN LISTS T_MOCKS)
    cmake_path(ABSOLUTE_PATH header BASE_DIRECTORY "${PROJECT_SOURCE_DIR}")
    cmake_path(GET header STEM stem)
    add_custom_command(OUTPUT "${gen}/mock_${stem}.c" "${gen}/mock_${stem}.h"
      COMMAND "${RUBY_EXECUTABLE}" -W0 --disable=gems "${CMOCK_DIR}/lib/cmock.rb"
      "-o${HUBFOC_CMOCK_YML}" "--mock_path=${gen}" "${header}"
      DEPENDS "${header}" "${HUBFOC_CMOCK_YML}" VERBATIM)
    list(APPEND mock_sources "${gen}/mock_${stem}.c")
  endforeach()
  add_executable(${T_NAME} ${suites} ${T_SOURCES} ${mock_sources})
  # Mocks are their generator's business; the tests are held to the project's warnings.
  set_source_files_properties(${mock_sources} PROPERTIES COMPILE_OPTIONS "-w;-O0;-g0")
  # What tests do is done in the modules' libraries; their own code takes longer to optimise than to
  # run. For the compiler's warnings it is optimised once: the firmware's tests for the emulator
  # (most of them with --full), all others with sanitizers.
  if(NOT HUBFOC_SANITIZE OR CMAKE_CURRENT_SOURCE_DIR MATCHES "/tests/unit/firmware/")
    set_source_files_properties(${suites} ${T_SOURCES} PROPERTIES COMPILE_OPTIONS -O0)
  endif()
  # SYSTEM: clang-tidy leaves generated headers alone then, too.
  target_include_directories(${T_NAME} SYSTEM PRIVATE "${gen}")
  target_include_directories(${T_NAME} PRIVATE "${PROJECT_SOURCE_DIR}/tests/unit/runner")
  target_link_libraries(${T_NAME} PRIVATE hubfoc_run_suites unity ${T_LIBRARIES} hubfoc_warnings)
  if(T_PLAIN AND HUBFOC_SANITIZE)
    list(APPEND T_LABELS full)
    hubfoc_only_full(${T_NAME})
  endif()
  if(NOT T_PLAIN AND NOT HUBFOC_SANITIZE AND NOT HUBFOC_COVERAGE AND NOT HUBFOC_MCDC)
    set_property(TARGET ${T_NAME} PROPERTY EXCLUDE_FROM_ALL ON)
    return()
  endif()
  set(together "")
  if(T_APART)
    list(REMOVE_ITEM names ${T_APART})
    set(together ${names})
  endif()
  add_test(NAME ${T_NAME} COMMAND ${T_NAME} ${together})
  hubfoc_test_properties(${T_NAME} "unit;${T_LABELS}" "${T_TIMEOUT}")
  foreach(name IN LISTS T_APART)
    add_test(NAME ${T_NAME}_${name} COMMAND ${T_NAME} ${name})
    hubfoc_test_properties(${T_NAME}_${name} "unit;${T_LABELS}" "${T_TIMEOUT}")
  endforeach()
endfunction()

function(hubfoc_add_python_test)
  cmake_parse_arguments(T "INSTRUMENTED;LONGER" "NAME;TIMEOUT" "FILES;LABELS" ${ARGN})
  if(HUBFOC_SANITIZE AND NOT T_INSTRUMENTED)
    return()
  endif()
  if(T_LONGER)
    hubfoc_add_python_test(NAME ${T_NAME}_for_long FILES ${T_FILES} LABELS ${T_LABELS} full
      TIMEOUT 3000)
    set_property(TEST ${T_NAME}_for_long APPEND PROPERTY ENVIRONMENT HUBFOC_FOR_LONG=1)
  endif()
  add_test(NAME ${T_NAME} COMMAND "${HUBFOC_PYTHON}" -m pytest -q -p no:cacheprovider ${T_FILES}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}")
  set_property(TEST ${T_NAME} PROPERTY ENVIRONMENT "HUBFOC_BUILD_DIR=${PROJECT_BINARY_DIR}"
    "HUBFOC_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
  hubfoc_test_properties(${T_NAME} "python;${T_LABELS}" "${T_TIMEOUT}")
endfunction()

function(hubfoc_add_command_test)
  cmake_parse_arguments(T "" "NAME;TIMEOUT" "COMMAND;LABELS" ${ARGN})
  add_test(NAME ${T_NAME} COMMAND ${T_COMMAND} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
  set_property(TEST ${T_NAME} PROPERTY ENVIRONMENT "HUBFOC_BUILD_DIR=${PROJECT_BINARY_DIR}"
    "HUBFOC_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
  hubfoc_test_properties(${T_NAME} "${T_LABELS}" "${T_TIMEOUT}")
endfunction()

function(hubfoc_test_properties name labels timeout)
  # Ten times what the test takes on an idle machine, and a minute at least; with sanitizers it
  # takes up to four times as long.
  if(timeout STREQUAL "")
    set(timeout 300)
  endif()
  if(HUBFOC_SANITIZE)
    math(EXPR timeout "4 * ${timeout}")
  endif()
  list(REMOVE_ITEM labels "")
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT "${timeout}")
endfunction()
