# SPDX-License-Identifier: Apache-2.0
# The tools of the build. Missing ones are named in one line together with the command that installs
# them, and what is installed or removed after a configure leads to a new one.

# tools/dev rewrites this file when the tools on this machine have changed.
set(HUBFOC_NOTED_TOOLS "${PROJECT_SOURCE_DIR}/.dev/tools")
if(EXISTS "${HUBFOC_NOTED_TOOLS}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${HUBFOC_NOTED_TOOLS}")
endif()

# A tool that was found before and has been removed since is looked for again.
get_cmake_property(cached CACHE_VARIABLES)
foreach(variable IN LISTS cached)
  if(variable MATCHES "^(HUBFOC_.*|RUBY_EXECUTABLE|CMOCK_DIR|Eigen3_DIR)$")
    get_property(type CACHE ${variable} PROPERTY TYPE)
    if(type MATCHES "^(FILEPATH|PATH)$" AND IS_ABSOLUTE "${${variable}}"
      AND NOT EXISTS "${${variable}}")
      unset(${variable} CACHE)
    endif()
  endif()
endforeach()

# Python of the project's private environment; empty where there is none.
find_program(HUBFOC_PYTHON python3 HINTS "${PROJECT_SOURCE_DIR}/.dev/venv/bin"
  NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH
  DOC "Python of the project's private environment (./tools/dev setup makes it)")

# hubfoc_require_test_tools(): what the host's tests cannot be built without.
macro(hubfoc_require_test_tools)
  find_program(RUBY_EXECUTABLE ruby)
  find_path(CMOCK_DIR lib/cmock.rb
    HINTS "${PROJECT_SOURCE_DIR}/.dev/cmock/usr/share/cmock" "${PROJECT_SOURCE_DIR}/.dev/cmock"
    "/usr/share/cmock"
    DOC "CMock with vendor/unity" NO_DEFAULT_PATH)
  find_package(Eigen3 3.3 QUIET NO_MODULE)
  set(missing "")
  if(NOT RUBY_EXECUTABLE)
    list(APPEND missing "Ruby")
  endif()
  if(NOT CMOCK_DIR)
    list(APPEND missing "CMock with Unity")
  endif()
  if(NOT Eigen3_FOUND)
    list(APPEND missing "Eigen")
  endif()
  foreach(package IN ITEMS numpy pytest fmpy)
    file(GLOB found
      "${PROJECT_SOURCE_DIR}/.dev/venv/lib/python3*/site-packages/${package}-*.dist-info")
    if(NOT HUBFOC_PYTHON OR NOT found)
      list(APPEND missing "the Python environment .dev/venv with ${package}")
      break()
    endif()
  endforeach()
  if(missing)
    list(JOIN missing ", " missing)
    # The space keeps CMake from wrapping the line.
    message(FATAL_ERROR " The tests need: ${missing}. './tools/dev setup' installs them; "
      "'-D HUBFOC_TESTS=OFF' builds the simulator alone.")
  endif()
endmacro()
