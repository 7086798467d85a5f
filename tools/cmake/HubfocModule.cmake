# SPDX-License-Identifier: Apache-2.0
# hubfoc_add_module(NAME core SOURCES a.c b.c DEPENDS hubfoc_config)
#
# One static library per module. Only <module>/include is visible to others, and only through a link
# dependency, so an include that breaks the order of dependency does not compile.

# The flags of tools/cmake/optimise.txt, for a release build with GCC for a board.
function(hubfoc_optimise MODULE)
  set(file "${PROJECT_SOURCE_DIR}/tools/cmake/optimise.txt")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  if(NOT CMAKE_CROSSCOMPILING OR NOT CMAKE_C_COMPILER_ID STREQUAL "GNU"
      OR NOT CMAKE_BUILD_TYPE STREQUAL "Release")
    return()
  endif()
  file(STRINGS "${file}" lines REGEX "^(flags|size|port) ")
  foreach(line IN LISTS lines)
    separate_arguments(words UNIX_COMMAND "${line}")
    list(POP_FRONT words kind)
    if(kind STREQUAL "flags")
      list(POP_FRONT words module)
      if(module STREQUAL MODULE)
        target_compile_options(hubfoc_${MODULE} PRIVATE ${words})
      endif()
    elseif(kind STREQUAL "port")
      list(POP_FRONT words port)
      if(port STREQUAL HUBFOC_PORT)
        target_compile_options(hubfoc_${MODULE} PRIVATE ${words})
      endif()
    elseif(words MATCHES "^${MODULE}/(.*)$")
      if(NOT EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${CMAKE_MATCH_1}")
        message(FATAL_ERROR "tools/cmake/optimise.txt: no firmware/${words}")
      endif()
      set_property(SOURCE "${CMAKE_MATCH_1}" APPEND PROPERTY COMPILE_OPTIONS -Os)
    endif()
  endforeach()
endfunction()

function(hubfoc_add_module)
  cmake_parse_arguments(MODULE "" "NAME" "SOURCES;DEPENDS" ${ARGN})
  add_library(hubfoc_${MODULE_NAME} STATIC ${MODULE_SOURCES})
  target_include_directories(hubfoc_${MODULE_NAME} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/include")
  target_link_libraries(hubfoc_${MODULE_NAME} PUBLIC ${MODULE_DEPENDS} PRIVATE hubfoc_warnings)
  hubfoc_optimise(${MODULE_NAME})
  if(HUBFOC_SANITIZE)
    # Most of the instrumented tests' time is spent here: an eighth less than with -O1.
    target_compile_options(hubfoc_${MODULE_NAME} PRIVATE -O2)
  endif()
endfunction()
