# SPDX-License-Identifier: Apache-2.0
# hubfoc_warnings: what every C target of this project is compiled with. Generated
# third-party-shaped code (mocks, runners) does not link it.
add_library(hubfoc_warnings INTERFACE)
target_compile_options(hubfoc_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:C>:-Wall -Wextra -Wconversion -Wshadow -Wundef -Wswitch-enum
  -Wmissing-prototypes
    -Wstrict-prototypes -Wcast-align>
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -Wundef>
  $<$<BOOL:${HUBFOC_WERROR}>:-Werror>)

if(HUBFOC_SANITIZE)
  add_compile_options(-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined,float-cast-overflow)
endif()
if(HUBFOC_COVERAGE)
  # Not atomic: no C test has threads, and counting atomically takes several times as long.
  add_compile_options(--coverage)
  add_link_options(--coverage)
endif()
if(HUBFOC_MCDC)
  # Its warnings stay errors: one of them is a decision that it cannot measure. The tests take the
  # mean of counts in floating point.
  add_compile_options(-Wno-error=enum-float-conversion
    $<$<COMPILE_LANGUAGE:C>:-fprofile-instr-generate>
    $<$<COMPILE_LANGUAGE:C>:-fcoverage-mapping> $<$<COMPILE_LANGUAGE:C>:-fcoverage-mcdc>)
  add_link_options($<$<LINK_LANGUAGE:C>:-fprofile-instr-generate>)
endif()
