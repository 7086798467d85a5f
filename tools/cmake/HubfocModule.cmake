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
  file(STRINGS "${file}" lines REGEX "^(flags|size|port|file) ")
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
      if(port STREQUAL HUBFOC_PORT OR port STREQUAL "${HUBFOC_PORT}/${MODULE}")
        target_compile_options(hubfoc_${MODULE} PRIVATE ${words})
      endif()
    else()
      list(POP_FRONT words path)
      if(kind STREQUAL "size")
        set(words -Os)
      endif()
      if(path MATCHES "^${MODULE}/(.*)$")
        if(NOT EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${CMAKE_MATCH_1}")
          message(FATAL_ERROR "tools/cmake/optimise.txt: no firmware/${path}")
        endif()
        set_property(SOURCE "${CMAKE_MATCH_1}" APPEND PROPERTY COMPILE_OPTIONS ${words})
      endif()
    endif()
  endforeach()
endfunction()

# Firmware for a board is optimised once more, whole, when it is linked: in a release build with
# GCC. Its objects have ordinary code too, of which every other program is linked (-fno-lto).
#
# hubfoc_optimise_whole(TARGET [APART source...]): the objects; sources that keep out of it.
# hubfoc_link_whole(TARGET): the program. One partition, so that the result does not depend on how
# many there are, and the prefixes of the compiler's own options for what it writes itself.
if(CMAKE_CROSSCOMPILING AND CMAKE_C_COMPILER_ID STREQUAL "GNU"
    AND CMAKE_BUILD_TYPE STREQUAL "Release")
  set(HUBFOC_WHOLE ON)
endif()

function(hubfoc_optimise_whole target)
  cmake_parse_arguments(W "" "" "APART" ${ARGN})
  if(HUBFOC_WHOLE)
    target_compile_options(${target} PRIVATE -flto -ffat-lto-objects)
    set_property(SOURCE ${W_APART} APPEND PROPERTY COMPILE_OPTIONS -fno-lto)
  endif()
endfunction()

function(hubfoc_link_whole target)
  if(HUBFOC_WHOLE)
    target_link_options(${target} PRIVATE -flto -flto-partition=one -fcallgraph-info=su
      "-ffile-prefix-map=${PROJECT_BINARY_DIR}=build"
      "-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.")
  endif()
endfunction()

function(hubfoc_add_module)
  cmake_parse_arguments(MODULE "" "NAME" "SOURCES;APART;DEPENDS" ${ARGN})
  add_library(hubfoc_${MODULE_NAME} STATIC ${MODULE_SOURCES})
  target_include_directories(hubfoc_${MODULE_NAME} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/include")
  target_link_libraries(hubfoc_${MODULE_NAME} PUBLIC ${MODULE_DEPENDS} PRIVATE hubfoc_warnings)
  hubfoc_optimise(${MODULE_NAME})
  hubfoc_optimise_whole(hubfoc_${MODULE_NAME} APART ${MODULE_APART})
  if(HUBFOC_SANITIZE)
    # Most of the instrumented tests' time is spent here: an eighth less than with -O1.
    target_compile_options(hubfoc_${MODULE_NAME} PRIVATE -O2)
  endif()
endfunction()
