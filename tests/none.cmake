# SPDX-License-Identifier: Apache-2.0
# Stands for all tests where a build was configured without them, so that ctest cannot pass by
# running none.
message(FATAL_ERROR " This build has no tests (HUBFOC_TESTS=OFF): './tools/dev test' or "
  "'cmake --preset NAME' adds them.")
