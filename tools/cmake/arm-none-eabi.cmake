# SPDX-License-Identifier: Apache-2.0
# Toolchain for the bare-metal ports. HUBFOC_CPU chooses the core; the port's own CMakeLists adds
# linker script and specs.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
find_program(HUBFOC_ARM_GCC arm-none-eabi-gcc)
if(NOT HUBFOC_ARM_GCC)
  message(FATAL_ERROR " arm-none-eabi-gcc was not found: './tools/dev setup arm' installs it.")
endif()
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
set(CMAKE_OBJCOPY arm-none-eabi-objcopy CACHE STRING "")
set(CMAKE_SIZE arm-none-eabi-size CACHE STRING "")
set(CMAKE_NM arm-none-eabi-nm CACHE STRING "")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

set(HUBFOC_CPU "cortex-m4" CACHE STRING "cortex-m4, cortex-m3 or cortex-m0plus")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES HUBFOC_CPU)
set(HUBFOC_CPU_FLAGS "-mcpu=${HUBFOC_CPU} -mthumb")
if(HUBFOC_CPU STREQUAL "cortex-m4")
  string(APPEND HUBFOC_CPU_FLAGS " -mfpu=fpv4-sp-d16 -mfloat-abi=hard")
endif()
string(CONCAT CMAKE_C_FLAGS_INIT
  "${HUBFOC_CPU_FLAGS} -ffunction-sections -fdata-sections -fno-common "
  "-include \"${CMAKE_CURRENT_LIST_DIR}/../../hal/cortex_m/saturate.h\"")
set(CMAKE_ASM_FLAGS_INIT "${HUBFOC_CPU_FLAGS}")
set(CMAKE_EXE_LINKER_FLAGS_INIT "${HUBFOC_CPU_FLAGS} -Wl,--gc-sections -Wl,--fatal-warnings")
set(CMAKE_C_FLAGS_RELEASE_INIT "-O2 -g")
set(CMAKE_C_FLAGS_RELEASE "-O2 -g" CACHE STRING "")

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
