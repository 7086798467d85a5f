/* SPDX-License-Identifier: Apache-2.0 */
/* The program of the emulated core. */
#include "serve.h"

/* The emulator's plugin (plugin.c) stops the core here until there is a request. */
__attribute__((noinline, noclone)) void pil_sync(void);
void pil_sync(void)
{
    __asm volatile("" ::: "memory");
}

int main(void)
{
    pil_ready((pil_memory_t *)PIL_ADDRESS);
    for (;;) {
        pil_sync();
        pil_serve();
    }
}
