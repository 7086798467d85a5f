# SPDX-License-Identifier: Apache-2.0
# Unity and CMock (Debian/Ubuntu package "cmock", which carries Unity) wired into CTest.
#
#   hubfoc_add_unit_test(NAME q15 SOURCES test_q15.c LIBRARIES hubfoc_core [MOCKS
#     hal/include/hal/inverter.h ...]
#                        [LABELS unit])
#       The first source is the test file; its runner is generated. MOCKS are headers mocked by
#         CMock.
#   hubfoc_add_python_test(NAME regen_table FILES test_a.py test_b.py [LABELS python] [TIMEOUT
#     seconds] [INSTRUMENTED])
#       pytest in the project's private environment. With sanitizers it is run again only if it is
#         INSTRUMENTED: executes C
#       that this build compiled, in an instrumented program or with the sanitizer loaded first.
#   hubfoc_add_command_test(NAME name COMMAND ... [LABELS ...] [TIMEOUT seconds])

hubfoc_require_test_tools()
set(UNITY_DIR "${CMOCK_DIR}/vendor/unity")
# Ruby runs with --disable=gems, which starts in less than half the time.
set(HUBFOC_CMOCK_YML "${PROJECT_SOURCE_DIR}/tools/cmake/cmock.yml")

add_library(unity STATIC "${UNITY_DIR}/src/unity.c" "${CMOCK_DIR}/src/cmock.c")
target_include_directories(unity SYSTEM PUBLIC "${UNITY_DIR}/src" "${CMOCK_DIR}/src")
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE CMOCK_MEM_DYNAMIC)

function(hubfoc_add_unit_test)
  cmake_parse_arguments(T "" "NAME;TIMEOUT" "SOURCES;LIBRARIES;MOCKS;LABELS" ${ARGN})
  set(target "test_${T_NAME}")
  set(gen "${CMAKE_CURRENT_BINARY_DIR}/${target}.gen")
  file(MAKE_DIRECTORY "${gen}")
  list(GET T_SOURCES 0 test)
  cmake_path(ABSOLUTE_PATH test)
  set(runner "${gen}/${target}_runner.c")
  # The .yml comes first: the runner generator resets its options when it meets it.
  add_custom_command(OUTPUT "${runner}"
    COMMAND "${RUBY_EXECUTABLE}" -W0 --disable=gems "${UNITY_DIR}/auto/generate_test_runner.rb"
    "${HUBFOC_CMOCK_YML}" "${test}" "${runner}"
    DEPENDS "${test}" "${HUBFOC_CMOCK_YML}" VERBATIM)
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
  add_executable(${target} ${T_SOURCES} "${runner}" ${mock_sources})
  # Runners and mocks are the generators' business; the test itself is held to the project's
  # warnings.
  set_source_files_properties("${runner}" ${mock_sources} PROPERTIES
    COMPILE_OPTIONS "-w;-O0;-g0")
  # Test functions are declared by the generated runner only. What they do is done in the modules'
  # libraries; their own code takes longer to optimise than to run. For the compiler's warnings it
  # is optimised once: the firmware's tests for the emulator, all others with sanitizers.
  set(options -Wno-missing-prototypes)
  if(NOT HUBFOC_SANITIZE OR CMAKE_CURRENT_SOURCE_DIR MATCHES "/tests/unit/firmware/")
    list(APPEND options -O0)
  endif()
  set_source_files_properties(${T_SOURCES} PROPERTIES COMPILE_OPTIONS "${options}")
  # SYSTEM: clang-tidy leaves generated headers alone then, too.
  target_include_directories(${target} SYSTEM PRIVATE "${gen}")
  target_link_libraries(${target} PRIVATE unity ${T_LIBRARIES} hubfoc_warnings)
  add_test(NAME ${T_NAME} COMMAND ${target})
  hubfoc_test_properties(${T_NAME} "unit;${T_LABELS}" "${T_TIMEOUT}")
endfunction()

function(hubfoc_add_python_test)
  cmake_parse_arguments(T "INSTRUMENTED" "NAME;TIMEOUT" "FILES;LABELS" ${ARGN})
  if(HUBFOC_SANITIZE AND NOT T_INSTRUMENTED)
    return()
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
