/* SPDX-License-Identifier: Apache-2.0 */
/* protected.h: for startup.c, which flash is never written: all but these eighths (link.ld).
 * Eighths of 128 KiB: the first holds the sectors 0 to 4. */
#ifndef STM32F405_PROTECTED_H
#define STM32F405_PROTECTED_H

#define PROTECTED_FLASH_LOG2 20U
#define PROTECTED_NOT_EIGHTHS 0x01U
#define PROTECTED_RAM_LOG2 17U

#endif
