/* SPDX-License-Identifier: Apache-2.0 */
/* protected.h: for startup.c, which flash is never written: all but these eighths (link.ld).
 * Eighths of 16 KiB: the last two hold the end of the image and the pages of the
 * application. */
#ifndef STM32G431_PROTECTED_H
#define STM32G431_PROTECTED_H

#define PROTECTED_FLASH_LOG2 17U
#define PROTECTED_NOT_EIGHTHS 0xC0U
#define PROTECTED_RAM_LOG2 15U

#endif
