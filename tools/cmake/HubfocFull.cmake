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
