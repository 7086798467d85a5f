# SPDX-License-Identifier: Apache-2.0
# hubfoc_commit_files(VARIABLE): the files that change when git moves on, for rules whose product
# names the commit. Empty without git.
function(hubfoc_commit_files variable)
  set(watched "")
  find_program(HUBFOC_GIT git DOC "Tells the firmware its commit; without it the commit is unknown")
  if(HUBFOC_GIT AND EXISTS "${PROJECT_SOURCE_DIR}/.git")
    foreach(reference IN ITEMS HEAD logs/HEAD)
      execute_process(COMMAND "${HUBFOC_GIT}" -C "${PROJECT_SOURCE_DIR}" rev-parse --git-path
        "${reference}"
        OUTPUT_VARIABLE path OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      cmake_path(ABSOLUTE_PATH path BASE_DIRECTORY "${PROJECT_SOURCE_DIR}")
      if(EXISTS "${path}" AND NOT IS_DIRECTORY "${path}")
        list(APPEND watched "${path}")
      endif()
    endforeach()
  endif()
  set(${variable} ${watched} PARENT_SCOPE)
endfunction()

# hubfoc_commit_header(TARGET app/commit.h): a header with HUBFOC_COMMIT as a string, for one
# target.
#
# Written anew when git has moved on or a source of the firmware has changed, by the rules of the
# build, so that a build with nothing to do stays one.
function(hubfoc_commit_header target name)
  set(directory "${CMAKE_CURRENT_BINARY_DIR}/commit")
  set(header "${directory}/${name}")
  set(stamp "${directory}/stamp")
  hubfoc_commit_files(watched)
  file(GLOB_RECURSE sources "${PROJECT_SOURCE_DIR}/firmware/*.[ch]"
    "${PROJECT_SOURCE_DIR}/hal/*.[ch]")
  set(script "${PROJECT_SOURCE_DIR}/tools/cmake/commit.cmake")
  # Now too: whoever reads the sources without building them (clang-tidy) needs the header.
  execute_process(COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DOUTPUT=${header}"
    -P "${script}"
    COMMAND_ERROR_IS_FATAL ANY)
  add_custom_command(OUTPUT "${stamp}" BYPRODUCTS "${header}"
    COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DOUTPUT=${header}" -P "${script}"
    COMMAND "${CMAKE_COMMAND}" -E touch "${stamp}"
    DEPENDS ${watched} ${sources} "${script}" COMMENT "The firmware's commit" VERBATIM)
  add_custom_target(${target}_commit DEPENDS "${stamp}")
  add_dependencies(${target} ${target}_commit)
  target_include_directories(${target} PRIVATE "${directory}")
endfunction()
