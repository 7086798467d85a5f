# SPDX-License-Identifier: Apache-2.0
# Images with an error planted in their driver (chip/README.md), linked of the same objects as the
# image, but not optimised whole where the flash holds that.

# planted_source(RESULT NAME FOLDER FILE OLD NEW [SOURCE]): FILE with OLD replaced by NEW; SOURCE
# includes it, if it is a header. RESULT: what has to be compiled.
function(planted_source result name folder file old new)
  set(folder "${PROJECT_SOURCE_DIR}/${folder}")
  file(READ "${folder}/${file}" text)
  string(FIND "${text}" "${old}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "planted error ${name}: '${old}' is not in ${folder}/${file}")
  endif()
  string(REPLACE "${old}" "${new}" text "${text}")
  set(copy "${CMAKE_CURRENT_BINARY_DIR}/planted/${name}/${file}")
  file(CONFIGURE OUTPUT "${copy}" CONTENT "${text}" @ONLY)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${folder}/${file}")
  if(ARGN)
    get_filename_component(source "${ARGN}" NAME)
    set(copy "${CMAKE_CURRENT_BINARY_DIR}/planted/${name}/${source}")
    configure_file("${PROJECT_SOURCE_DIR}/${ARGN}" "${copy}" COPYONLY)
  endif()
  set_source_files_properties("${copy}" PROPERTIES GENERATED TRUE)
  set(${result} "${copy}" PARENT_SCOPE)
endfunction()

# planted_image(NAME CHIP FOLDER FILE OLD NEW [SOURCE]): the image with OLD replaced by NEW in one
# file of the port or of the application, and with what is in PLANTED_ALSO (from planted_source()).
# With PLANTED_BOARD the image is for this board instead of the build's.
function(planted_image name chip folder file old new)
  set(port_objects "hubfoc_port_${chip}")
  set(board_header "${HUBFOC_BOARD_HEADER}")
  if(PLANTED_BOARD)
    set(port_objects "board_${PLANTED_BOARD}")
    set(board_header "boards/${PLANTED_BOARD}.h")
  endif()
  set(port "${PROJECT_SOURCE_DIR}/hal/${chip}")
  planted_source(copy "${name}" "${folder}" "${file}" "${old}" "${new}" ${ARGN})
  set(stems "")
  foreach(source IN LISTS copy PLANTED_ALSO)
    get_filename_component(stem "${source}" NAME_WE)
    list(APPEND stems "${stem}")
  endforeach()
  string(JOIN "|" stems ${stems})
  set(target planted_${name})
  add_executable(${target} "${copy}" ${PLANTED_ALSO}
    "$<FILTER:$<TARGET_OBJECTS:${port_objects}>,EXCLUDE,/(${stems})[.]c[.]obj$>")
  target_include_directories(${target} PRIVATE "${port}" "${PROJECT_SOURCE_DIR}/hal/stm32")
  target_compile_definitions(${target} PRIVATE "HUBFOC_BOARD_HEADER=\"${board_header}\"")
  target_link_libraries(${target} PRIVATE hubfoc_app_main hubfoc_app hubfoc_hal
    hubfoc_config_image)
  set(stack 3584)
  if(port MATCHES "stm32g431$")
    set(stack 3328)
  endif()
  if(chip STREQUAL "stm32g431")
    hubfoc_optimise_whole(${target})
    hubfoc_link_whole(${target})
  else()
    target_link_options(${target} PRIVATE -fno-lto)
  endif()
  target_link_options(${target} PRIVATE -nostartfiles --specs=nano.specs
    "-T${port}/link.ld" "-L${PROJECT_SOURCE_DIR}/hal/stm32"
    "-Wl,--defsym=link_stack_size=${stack}")
  set_target_properties(${target} PROPERTIES SUFFIX .elf LINK_DEPENDS "${port}/link.ld")
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND "${HUBFOC_PYTHON}" "${PROJECT_SOURCE_DIR}/tests/target/chip/seal.py"
      "${CMAKE_OBJCOPY}" "$<TARGET_FILE:${target}>" VERBATIM)
endfunction()

# chip_finds(NAME ELF FINDS LABELS PROGRAM ARGUMENT...): PROGRAM must find the error planted in this
# image, and with FINDS: the beginning of what the test says is wrong, of what the model notes, of
# the fault that the controller names, or of a line of the program's own.
function(chip_finds name elf finds labels program)
  add_test(NAME ${name} COMMAND "${PROJECT_SOURCE_DIR}/build/host/tests/target/chip/${program}"
    "${elf}" ${ARGN} --finds "${finds}")
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 300)
  if("full" IN_LIST labels AND elf MATCHES "TARGET_FILE:([a-z0-9_]+)>")
    hubfoc_only_full(${CMAKE_MATCH_1})
  endif()
endfunction()
