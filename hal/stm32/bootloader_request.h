/* SPDX-License-Identifier: Apache-2.0 */
/* bootloader_request.h: two words that a reset keeps (sections.ld), from power.c to startup.c. */
#ifndef STM32_BOOTLOADER_REQUEST_H
#define STM32_BOOTLOADER_REQUEST_H

#include <stdint.h>

extern volatile uint32_t link_bootloader_request[2]; /* the request and its inverse */

#define BOOTLOADER_REQUEST UINT32_C(0x544F4F42) /* "BOOT", little endian */

#endif
