# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=<repository> -DOUTPUT=<header> -P commit.cmake
#
# Writes the header that tells the firmware its commit: twelve digits, "+" behind them where tracked
# files were changed, or "unknown". HUBFOC_COMMIT in the environment comes first, then what git
# says, then what `git archive` wrote into archived_commit. The Python packages find the same out
# by themselves (tools/regen_table/installation.py). A header that is right is left untouched, so
# that nothing is compiled for it.
cmake_minimum_required(VERSION 3.25)

set(commit "$ENV{HUBFOC_COMMIT}")
if(commit STREQUAL "" AND EXISTS "${SOURCE}/.git")
  find_program(git git)
  if(git)
    execute_process(COMMAND "${git}" -C "${SOURCE}" --no-optional-locks describe --always --dirty=+
      --exclude=* --abbrev=40
      OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
endif()
if(commit STREQUAL "" AND NOT EXISTS "${SOURCE}/.git")
  file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/archived_commit" commit)
endif()
if(commit MATCHES "^([0-9a-f]+)(\\+?)$")
  string(SUBSTRING "${CMAKE_MATCH_1}" 0 12 digits)
  set(commit "${digits}${CMAKE_MATCH_2}")
else()
  set(commit "unknown")
endif()

string(CONCAT text "/* SPDX-License-Identifier: Apache-2.0 */\n"
  "/* Written by tools/cmake/commit.cmake. */\n"
  "#define HUBFOC_COMMIT \"${commit}\"\n")
set(before "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" before)
endif()
if(NOT before STREQUAL text)
  file(WRITE "${OUTPUT}" "${text}")
endif()
