/* SPDX-License-Identifier: Apache-2.0 */
/*
 * semihost.h: the few requests to the emulator that this port needs (Arm semihosting 2.0). QEMU
 * must be started with -semihosting-config enable=on,target=native: without it the first request
 * aborts the emulator.
 */
#ifndef QEMU_MPS2_SEMIHOST_H
#define QEMU_MPS2_SEMIHOST_H

#include <stdbool.h>
#include <stdint.h>

/* Ends the emulator; its exit status is 0 for success and 1 otherwise. */
_Noreturn void semihost_exit(bool success);

/* Writes to the emulator's console; for what must be seen even if the serial line cannot be used.
 */
void semihost_print(const char *text);

/* The value of "name=NUMBER" on the emulated program's command line (arg= of -semihosting-config),
 * else `otherwise`. */
uint32_t semihost_option(const char *name, uint32_t otherwise);

#endif
