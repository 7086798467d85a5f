/* SPDX-License-Identifier: Apache-2.0 */
/* copies.h: processes that are copied from one in work, a few at the same time. */
#ifndef CHIP_COPIES_H
#define CHIP_COPIES_H

#include <stdint.h>

/* In a copy: its exit code. In the first process: a copy has ended so; -1: not by itself. */
typedef int copies_work_t(uint32_t number);
typedef void copies_ended_t(uint32_t number, int code);

/* Copies 0 to count - 1, each of the state that is now. */
void copies_run(uint32_t count, copies_work_t *work, copies_ended_t *ended);

#endif
