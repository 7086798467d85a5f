/* SPDX-License-Identifier: Apache-2.0 */
/*
 * provoke.h: what the memory protection unit must catch, for tests, once: not after the restart
 * that follows.
 *
 *     crash=1   on the command line: the background's stack overflows
 *
 *     crash=2   the program's image is written
 *
 *     crash=3   data is executed
 */
#ifndef QEMU_MPS2_PROVOKE_H
#define QEMU_MPS2_PROVOKE_H

void provoke_init(void);

/* Background, every pass; acts 300 ms after the start. */
void provoke_now(void);

#endif
