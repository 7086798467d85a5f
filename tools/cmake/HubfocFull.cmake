# SPDX-License-Identifier: Apache-2.0
# hubfoc_only_full(TARGET...): what nothing but tests labelled "full" needs. It is not part of
# "all", which ./tools/dev test builds, but of the target "full_tests", which --full builds as well,
# and so does every build by a preset of CMakePresets.json.
add_custom_target(full_tests)

function(hubfoc_only_full)
  foreach(target IN LISTS ARGN)
    set_property(TARGET ${target} PROPERTY EXCLUDE_FROM_ALL ON)
    add_dependencies(full_tests ${target})
  endforeach()
endfunction()

# hubfoc_run_when_changed(test file-or-folder...): with --full, and in every run while one of these
# differs from the last commit (tools/run_tests).
function(hubfoc_run_when_changed name)
  set(paths "")
  foreach(path IN LISTS ARGN)
    if(NOT EXISTS "${PROJECT_SOURCE_DIR}/${path}")
      message(FATAL_ERROR "${name}: no ${path}")
    endif()
    list(APPEND paths "${PROJECT_SOURCE_DIR}/${path}")
  endforeach()
  list(REMOVE_DUPLICATES paths)
  list(JOIN paths "," paths)
  set_property(TEST ${name} APPEND PROPERTY LABELS full)
  set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT "HUBFOC_WHEN_CHANGED=${paths}")
endfunction()
