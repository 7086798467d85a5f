/* SPDX-License-Identifier: Apache-2.0 */
/*
 * core MEMORY: this machine's processor in the place of the emulated one: executes the requests of
 * the bench (host_sim/pil), compiled with other options than the engine. Ends with the process that
 * started it.
 */
#define _GNU_SOURCE /* syscall() */

#include <fcntl.h>
#include <stdio.h>
#include <sys/mman.h>

#include "serve.h"
#include "wait.h"

int main(int count, char **arguments)
{
    const int file = count == 2 ? open(arguments[1], O_RDWR) : -1;
    pil_memory_t *memory =
        file < 0 ? MAP_FAILED
                 : mmap(NULL, PIL_FILE_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) {
        perror("core");
        return 1;
    }
    const pid_t starter = getppid();
    pil_ready(memory);
    while (getppid() == starter) {
        const uint32_t done = atomic_load(&memory->done);
        if (pil_wait(&memory->posted, done, &memory->core_sleeps)) {
            pil_serve();
            pil_wake(&memory->done, &memory->bench_sleeps);
        }
    }
    return 0;
}
