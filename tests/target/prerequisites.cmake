# SPDX-License-Identifier: Apache-2.0
# cmake -DMISSING="ruby;cc" -P prerequisites.cmake: the test that stands for those that could not be
# built.
if(MISSING)
  message(FATAL_ERROR "these tests need what was not found when this build was configured: "
    "${MISSING}; ./tools/dev setup installs it")
endif()
