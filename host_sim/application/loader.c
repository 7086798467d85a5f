/* SPDX-License-Identifier: Apache-2.0 */
/* The whole application as the controller of every wheel: a copy of its library a wheel. */
#define _GNU_SOURCE /* memfd_create() */

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include "application/application.h"
#include "bench/handle.h"
#include "pedals/pedals.h"

enum { NAME_BYTES = 32 };

typedef struct {
    int file; /* stays open: its number is the name by which the linker knows the copy */
    void *library;
    const application_t *application;
} copy_t;

typedef struct {
    int library;
    int copies;
    copy_t copy[BENCH_WHEELS_MAX];
} applications_t;

/* A file of its own, in memory: the linker tells libraries apart by their files. -1 with errno. */
static int copy_file(int library)
{
    struct stat status;
    const int copy = memfd_create("hubfoc_application", MFD_CLOEXEC);
    bool good = copy >= 0 && fstat(library, &status) == 0;
    for (off_t at = 0; good && at < status.st_size;) {
        good = sendfile(copy, library, &at, (size_t)(status.st_size - at)) > 0;
    }
    if (!good && copy >= 0) {
        const int error = errno;
        (void)close(copy);
        errno = error;
    }
    return good ? copy : -1;
}

static bool fits(const application_t *application)
{
    const application_sizes_t own = APPLICATION_SIZES;
    return memcmp(&application->sizes, &own, sizeof(own)) == 0;
}

/* NULL, or what is wrong with the library. */
static const char *load(copy_t *copy, int library)
{
    char name[NAME_BYTES];
    copy->file = copy_file(library);
    if (copy->file < 0) {
        return strerror(errno);
    }
    (void)snprintf(name, sizeof(name), "/proc/self/fd/%d", copy->file);
    copy->library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (copy->library == NULL) {
        (void)close(copy->file);
        return "not a library that this machine can load";
    }
    const application_t *(*entry)(void) = NULL;
    void *const symbol = dlsym(copy->library, "application_entry");
    memcpy(&entry, &symbol, sizeof(entry)); /* ISO C has no conversion between the two */
    if (entry != NULL) {
        copy->application = entry();
        if (fits(copy->application)) {
            return NULL;
        }
    }
    (void)dlclose(copy->library);
    (void)close(copy->file);
    return "not an application of the sources of this engine";
}

static const char *start(void *context, bench_t *bench)
{
    applications_t *all = context;
    if (pedals_wired(&bench->config)) {
        return "accepted: a configuration without wired pedals, whose voltages it does not get";
    }
    while (all->copies < bench->wheels) {
        const char *objection = load(&all->copy[all->copies], all->library);
        if (objection != NULL) {
            return objection;
        }
        all->copies++;
    }
    for (int k = 0; k < bench->wheels; k++) {
        const application_t *application = all->copy[k].application;
        application->start(application->board, &bench->config);
        bench->wheel[k].coupling = &application->coupling;
    }
    return NULL;
}

static void close_all(void *context)
{
    applications_t *all = context;
    for (int k = 0; k < all->copies; k++) {
        (void)dlclose(all->copy[k].library);
        (void)close(all->copy[k].file);
    }
    (void)close(all->library);
    free(all);
}

int hubsim_application(hubsim_t *sim, const char *path)
{
    if (sim->has_started || sim->has_processor || sim->has_application) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "hubsim_application: accepted: once, before hubsim_start, without "
                           "hubsim_processor");
    }
    applications_t *all = calloc(1, sizeof(*all));
    if (all == NULL) {
        return handle_fail(sim, HUBSIM_FAILED, "no memory for the application");
    }
    all->library = open(path, O_RDONLY | O_CLOEXEC);
    if (all->library < 0) {
        free(all);
        return handle_fail(sim, HUBSIM_BAD_VALUE, "%s: %s", path, strerror(errno));
    }
    const application_link_t application = {.context = all, .start = start, .close = close_all};
    sim->application = application;
    sim->has_application = true;
    return HUBSIM_OK;
}
