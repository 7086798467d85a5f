# SPDX-License-Identifier: Apache-2.0
# hubfoc_add_room(NAME core SOURCES a.c b.c DEPENDS hubfoc_config)
#
# One static library per room. Only <room>/include is visible to others, and only through a link dependency, so an
# include that breaks the order of dependency does not compile.
function(hubfoc_add_room)
  cmake_parse_arguments(ROOM "" "NAME" "SOURCES;DEPENDS" ${ARGN})
  add_library(hubfoc_${ROOM_NAME} STATIC ${ROOM_SOURCES})
  target_include_directories(hubfoc_${ROOM_NAME} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/include")
  target_link_libraries(hubfoc_${ROOM_NAME} PUBLIC ${ROOM_DEPENDS} PRIVATE hubfoc_warnings)
endfunction()
