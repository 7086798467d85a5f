# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=<repository> -DBUILD=<its build directory> -DPRESET=stm32f405 -DTARGET=<target>
#       -DCOMPILER=<compiler>
#       -DOPTIONS="-DNAME=value ..." "-DFILES=<file below BUILD>;..." -DWORK=<scratch>
#       -P rebuild.cmake
#
# The same sources, compiled by the same compiler in a folder with another name and depth, give the
# same files, byte for byte. The commit is handed over, because the copy has no history. The ELF of
# the firmware is the same too, except where a compiler cache rewrites the names of sources in the
# information for debuggers. Files that were found to be the same before need no second build, as
# long as the compiler is the same (HUBFOC_NO_CACHE=1 builds always): .dev/known/rebuilt.
cmake_minimum_required(VERSION 3.25)
file(READ "${BUILD}/firmware/app/commit/app/commit.h" header)
if(NOT header MATCHES "HUBFOC_COMMIT \"([^\"]+)\"")
  message(FATAL_ERROR "rebuild: no commit in app/commit.h")
endif()
set(ENV{HUBFOC_COMMIT} "${CMAKE_MATCH_1}")
separate_arguments(OPTIONS)

set(content "${OPTIONS}")
foreach(path IN LISTS FILES)
  file(SHA256 "${path}" here)
  string(APPEND content " ${here}")
endforeach()
execute_process(COMMAND "${COMPILER}" --version OUTPUT_VARIABLE compiler
  COMMAND_ERROR_IS_FATAL ANY)
string(SHA256 key "${content} ${compiler}")
set(known "${SOURCE}/.dev/known/rebuilt")
if(EXISTS "${known}" AND NOT "$ENV{HUBFOC_NO_CACHE}")
  file(STRINGS "${known}" keys)
  if(key IN_LIST keys)
    message(STATUS "the same in another folder before (known)")
    return()
  endif()
endif()

# Compiled anew: a compiler cache would only show that it gives back what it was given.
set(ENV{CCACHE_DISABLE} 1)
set(copy "${WORK}/somewhere else/deeper")
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${copy}")
foreach(name IN ITEMS CMakeLists.txt CMakePresets.json firmware hal host_sim tests tools)
  file(COPY "${SOURCE}/${name}" DESTINATION "${copy}")
endforeach()
list(JOIN OPTIONS ";" options)
foreach(command IN ITEMS "--preset;${PRESET};${options}"
  "--build;--preset;${PRESET};--target;${TARGET}")
  execute_process(COMMAND "${CMAKE_COMMAND}" ${command} WORKING_DIRECTORY "${copy}"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result)
    message(FATAL_ERROR "rebuild: ${command}:\n${output}")
  endif()
endforeach()

foreach(path IN LISTS FILES)
  file(RELATIVE_PATH file "${BUILD}" "${path}")
  file(SHA256 "${path}" here)
  file(SHA256 "${copy}/build/${PRESET}/${file}" there)
  if(NOT here STREQUAL there)
    message(FATAL_ERROR "rebuild: ${file}: ${here} here, ${there} in another folder")
  endif()
  message(STATUS "${file} ${here}")
endforeach()
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${SOURCE}/.dev/known")
file(APPEND "${known}" "${key}\n")
