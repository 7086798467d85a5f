/* SPDX-License-Identifier: Apache-2.0 */
#include "copies.h"

#include <stdbool.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

enum { AT_A_TIME = 2 };

typedef struct {
    pid_t process; /* 0: none */
    uint32_t number;
} job_t;
static job_t jobs[AT_A_TIME];

static void collect(copies_ended_t *ended)
{
    int status = 0;
    const pid_t process = wait(&status);
    for (int j = 0; j < AT_A_TIME; j++) {
        if (jobs[j].process == process && process > 0) {
            jobs[j].process = 0;
            ended(jobs[j].number, WIFEXITED(status) ? WEXITSTATUS(status) : -1);
        }
    }
}

/* NULL: as many are at work as may be. */
static job_t *free_job(void)
{
    for (int j = 0; j < AT_A_TIME; j++) {
        if (jobs[j].process == 0) {
            return &jobs[j];
        }
    }
    return NULL;
}

static bool any_at_work(void)
{
    bool any = false;
    for (int j = 0; j < AT_A_TIME; j++) {
        any = any || jobs[j].process != 0;
    }
    return any;
}

void copies_run(uint32_t count, copies_work_t *work, copies_ended_t *ended)
{
    for (uint32_t number = 0; number < count; number++) {
        while (free_job() == NULL) {
            collect(ended);
        }
        (void)fflush(stdout);
        const pid_t process = fork();
        if (process == 0) {
            const int code = work(number);
            (void)fflush(stdout);
            _exit(code);
        }
        if (process < 0) {
            ended(number, -1);
            continue;
        }
        job_t *job = free_job();
        job->process = process;
        job->number = number;
    }
    while (any_at_work()) {
        collect(ended);
    }
}
