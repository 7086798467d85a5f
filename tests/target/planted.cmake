# SPDX-License-Identifier: Apache-2.0
# Images with an error planted in their driver (chip/README.md).

# planted_image(NAME CHIP FOLDER FILE OLD NEW [SOURCE]): the image with OLD replaced by NEW in one
# file of the port or of the application; SOURCE includes it, if it is a header. With PLANTED_BOARD
# the image is for this board instead of the build's.
function(planted_image name chip folder file old new)
  set(port_objects "hubfoc_port_${chip}")
  set(board_header "${HUBFOC_BOARD_HEADER}")
  if(PLANTED_BOARD)
    set(port_objects "board_${PLANTED_BOARD}")
    set(board_header "boards/${PLANTED_BOARD}.h")
  endif()
  set(port "${PROJECT_SOURCE_DIR}/hal/${chip}")
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
  get_filename_component(stem "${copy}" NAME_WE)
  set(target planted_${name})
  set(stack_bytes 2560)
  if(chip STREQUAL "stm32g431")
    set(stack_bytes 2816)
  endif()
  add_executable(${target} "${copy}"
    "$<FILTER:$<TARGET_OBJECTS:${port_objects}>,EXCLUDE,/${stem}[.]c[.]obj$>")
  set_source_files_properties("${copy}" PROPERTIES GENERATED TRUE)
  target_include_directories(${target} PRIVATE "${port}" "${PROJECT_SOURCE_DIR}/hal/stm32")
  target_compile_definitions(${target} PRIVATE "HUBFOC_BOARD_HEADER=\"${board_header}\"")
  target_link_libraries(${target} PRIVATE hubfoc_app_main hubfoc_app hubfoc_hal
    hubfoc_config_image)
  target_link_options(${target} PRIVATE -nostartfiles --specs=nano.specs "-T${port}/link.ld"
    "-L${PROJECT_SOURCE_DIR}/hal/stm32" "-Wl,--defsym=link_stack_size=${stack_bytes}")
  set_target_properties(${target} PROPERTIES SUFFIX .elf LINK_DEPENDS "${port}/link.ld")
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND "${HUBFOC_PYTHON}" "${PROJECT_SOURCE_DIR}/tests/target/chip/seal.py"
      "${CMAKE_OBJCOPY}" "$<TARGET_FILE:${target}>" VERBATIM)
endfunction()
