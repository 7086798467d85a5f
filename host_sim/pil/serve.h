/* SPDX-License-Identifier: Apache-2.0 */
/* serve.h: executes the requests of the bench with the controllers as they are linked into the
 * firmware. For any core: target.c is the emulated one. */
#ifndef PIL_SERVE_H
#define PIL_SERVE_H

#include "message.h"

/* Once, with the memory that the bench shares. */
void pil_ready(pil_memory_t *shared);

/* Executes everything that has been posted. */
void pil_serve(void);

#endif
