# SPDX-License-Identifier: Apache-2.0
# Coverage-guided fuzzers, by clang whatever compiler builds the rest. Run briefly and always the
# same way here, for long with ./tools/dev test --full; by hand, `fuzz_fast_step CORPUS` goes on for
# as long as it is let.
find_program(HUBFOC_CLANG clang DOC "clang with libFuzzer (./tools/dev setup proofs)")
if(NOT HUBFOC_CLANG)
  add_test(NAME fuzz_fast_step COMMAND "${CMAKE_COMMAND}"
    -P "${CMAKE_CURRENT_LIST_DIR}/missing_clang.cmake")
  hubfoc_test_properties(fuzz_fast_step fuzz 10)
  return()
endif()

# Comparisons are not traced, which takes two thirds of the time and reaches no more: configurations
# are made valid, commands and checksums are given.
set(compile ${CMAKE_C_COMPILER_LAUNCHER} "${HUBFOC_CLANG}" -std=c11 -O2 -g1 -Wall -Wextra -Werror
  -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
  -fno-sanitize-coverage=trace-cmp "-DHUBFOC_VERSION=\"${PROJECT_VERSION}\""
  "-DHUBFOC_PORT_NAME=\"fuzzer\"" -DFLASH_FAKE_WORDS=2400
  "-I${PROJECT_SOURCE_DIR}/hal/include" "-I${PROJECT_SOURCE_DIR}/tests/unit/firmware/support"
  "-I${PROJECT_BINARY_DIR}/firmware/app/commit" "-I${PROJECT_SOURCE_DIR}/firmware"
  # What fuzz_fast_step.c takes from modules that keep it to themselves.
  "-I${PROJECT_SOURCE_DIR}/firmware/config" "-I${PROJECT_SOURCE_DIR}/firmware/controller")
set(fuzzed_modules core config foc motor torque monitor modes pedals controller comms)
foreach(module IN LISTS fuzzed_modules ITEMS app)
  list(APPEND compile "-I${PROJECT_SOURCE_DIR}/firmware/${module}/include")
endforeach()

# fuzzed_object(OBJECT SOURCE OPTION...)
function(fuzzed_object object source)
  cmake_path(GET object PARENT_PATH folder)
  file(MAKE_DIRECTORY "${folder}")
  add_custom_command(OUTPUT "${object}" DEPFILE "${object}.d" DEPENDS "${source}"
    COMMAND ${compile} ${ARGN} -MD -MF "${object}.d" -MT "${object}" -c "${source}" -o "${object}"
    VERBATIM)
endfunction()

# What the fuzzers run, compiled once.
set(fuzzed_sources ${configurations}
  "${PROJECT_SOURCE_DIR}/tests/unit/firmware/support/flash_fake.c")
foreach(file IN ITEMS black_box_lines board_check config_lines config_store console console_xcp
    crash_lines energy fault_journal installer recorder report)
  list(APPEND fuzzed_sources "${PROJECT_SOURCE_DIR}/firmware/app/${file}.c")
endforeach()
foreach(module IN LISTS fuzzed_modules)
  get_target_property(module_sources hubfoc_${module} SOURCES)
  list(TRANSFORM module_sources PREPEND "${PROJECT_SOURCE_DIR}/firmware/${module}/")
  list(APPEND fuzzed_sources ${module_sources})
endforeach()
set(objects "")
foreach(source IN LISTS fuzzed_sources)
  cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE name)
  set(object "${CMAKE_CURRENT_BINARY_DIR}/fuzzed/${name}.o")
  fuzzed_object("${object}" "${source}")
  list(APPEND objects "${object}")
endforeach()
set(library "${CMAKE_CURRENT_BINARY_DIR}/libfuzzed.a")
add_custom_command(OUTPUT "${library}" DEPENDS ${objects} VERBATIM
  COMMAND "${CMAKE_COMMAND}" -E rm -f "${library}"
  COMMAND "${CMAKE_AR}" qcs "${library}" ${objects})

# The sequences of tests/target by these objects of clang print what those of gcc print, with
# sanitizers and without.
set(traced "${PROJECT_SOURCE_DIR}/tests/target")
set(program "${CMAKE_CURRENT_BINARY_DIR}/trace_by_clang")
set(objects "")
foreach(name IN ITEMS trace digest print print_host wheel)
  fuzzed_object("${CMAKE_CURRENT_BINARY_DIR}/traced/${name}.o" "${traced}/${name}.c" "-I${traced}"
    -DCONFIG_IMAGE=CONFIG_LU2013)
  list(APPEND objects "${CMAKE_CURRENT_BINARY_DIR}/traced/${name}.o")
endforeach()
add_custom_command(OUTPUT "${program}" DEPENDS ${objects} "${library}" VERBATIM
  COMMAND "${HUBFOC_CLANG}" -fsanitize=fuzzer-no-link,address,undefined ${objects} "${library}"
    -o "${program}")
add_custom_target(build_trace_by_clang ALL DEPENDS "${program}")
add_dependencies(build_trace_by_clang hubfoc_app_commit)
set(HUBFOC_TRACE "${PROJECT_SOURCE_DIR}/build/host/tests/target/hubfoc_trace"
  CACHE FILEPATH "The host preset's program of the input sequences")
add_test(NAME trace_by_clang_is_that_by_gcc COMMAND "${CMAKE_COMMAND}"
  "-DPROGRAMS=${HUBFOC_TRACE};$<TARGET_FILE:hubfoc_trace>;${program}"
  -P "${traced}/same_output.cmake")
hubfoc_test_properties(trace_by_clang_is_that_by_gcc target 300)

# hubfoc_add_fuzzer(NAME RUNS LONG_RUNS OPTION...)
function(hubfoc_add_fuzzer name runs long_runs)
  set(program "${CMAKE_CURRENT_BINARY_DIR}/fuzz_${name}")
  fuzzed_object("${program}.o" "${CMAKE_CURRENT_SOURCE_DIR}/fuzz_${name}.c")
  add_custom_command(OUTPUT "${program}" DEPENDS "${program}.o" "${library}" VERBATIM
    COMMAND "${HUBFOC_CLANG}" -fsanitize=fuzzer,address,undefined "${program}.o" "${library}"
      -o "${program}")
  add_custom_target(build_fuzz_${name} ALL DEPENDS "${program}")
  add_dependencies(build_fuzz_${name} hubfoc_app_commit)
  add_test(NAME fuzz_${name} COMMAND "${program}" -seed=20130000 -runs=${runs} ${ARGN}
    -timeout=20 -verbosity=0 WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  hubfoc_test_properties(fuzz_${name} fuzz 300)
  add_test(NAME fuzz_${name}_for_long COMMAND "${program}" -seed=20260101 -runs=${long_runs} ${ARGN}
    -timeout=20 -verbosity=0 WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  hubfoc_test_properties(fuzz_${name}_for_long "fuzz;full" 7200)
endfunction()

# The whole controller; the CAN node; what comes over the serial line, what is read from memories
# that may hold anything, and packets of XCP. The numbers of inputs: README.
hubfoc_add_fuzzer(fast_step 60000 3000000 -max_len=1000)
hubfoc_add_fuzzer(can_frames 20000 10000000 -max_len=600)
hubfoc_add_fuzzer(console 2000 1000000 -max_len=600 -len_control=0)
hubfoc_add_fuzzer(images 2000 10000000 -max_len=600 -len_control=0)
hubfoc_add_fuzzer(xcp 100000 10000000 -max_len=600 -len_control=0)
# Nine tenths of the console's inputs are at most fifty bytes long: a quarter of the time each.
add_test(NAME fuzz_console_short_for_long
  COMMAND "${CMAKE_CURRENT_BINARY_DIR}/fuzz_console" -seed=20260102 -runs=9000000 -max_len=50
  -len_control=0 -timeout=20 -verbosity=0 WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
hubfoc_test_properties(fuzz_console_short_for_long "fuzz;full" 7200)
