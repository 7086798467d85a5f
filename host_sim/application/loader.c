/* SPDX-License-Identifier: Apache-2.0 */
/* The whole application as the controller of every wheel: a copy of its library a wheel. */
#define _GNU_SOURCE /* memfd_create() */

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include "application/application.h"
#include "application/steps.h"
#include "bench/handle.h"
#include "comms/messages.h"
#include "config/validate.h"
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
    bool records;
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

/* Several wheels on one bus have an address each, counted from the front left as the bench counts
 * them; one wheel keeps its own. */
static config_t config_of(const config_t *config, int wheel, int wheels)
{
    config_t out = *config;
    if (wheels > 1 && wheel < CONFIG_WHEELS) {
        out.vehicle.wheel_position = wheel;
        out.crc32 = config_crc32(&out, (uint32_t)offsetof(config_t, crc32));
    }
    return out;
}

static const char *start(void *context, bench_t *bench)
{
    applications_t *all = context;
    for (int k = 0; k < bench->wheels; k++) {
        if (pedals_wired(bench_config_of(bench, k))) {
            return "accepted: a configuration without wired pedals, whose voltages it does not get";
        }
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
        const config_t own = config_of(bench_config_of(bench, k), k, bench->wheels);
        application->recording->on = all->records;
        application->start(application->board, &own);
        bench->wheel[k].coupling = &application->coupling;
    }
    return NULL;
}

static void close_all(void *context)
{
    applications_t *all = context;
    for (int k = 0; k < all->copies; k++) {
        free(all->copy[k].application->recording->step);
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

int hubsim_record(hubsim_t *sim)
{
    if (sim->has_started || !sim->has_application) {
        return handle_fail(
            sim, HUBSIM_BAD_ORDER,
            "hubsim_record: accepted: before hubsim_start, after hubsim_application");
    }
    ((applications_t *)sim->application.context)->records = true;
    return HUBSIM_OK;
}

int hubsim_record_end(hubsim_t *sim)
{
    if (sim->has_application) {
        const applications_t *all = sim->application.context;
        for (int k = 0; k < all->copies; k++) {
            all->copy[k].application->recording->on = false;
        }
    }
    return HUBSIM_OK;
}

/* NULL unless the wheel's application runs. */
static const application_t *application_of(const hubsim_t *sim, int wheel)
{
    const bool runs =
        sim->has_application && sim->has_started && wheel >= 0 && wheel < sim->bench.wheels;
    return runs ? ((const applications_t *)sim->application.context)->copy[wheel].application
                : NULL;
}

static int no_application(hubsim_t *sim)
{
    return handle_fail(sim, HUBSIM_BAD_ORDER,
                       "accepted: after hubsim_start with hubsim_application, a wheel of it");
}

int hubsim_bus_send(hubsim_t *sim, const hubsim_frame_t *frame)
{
    if (application_of(sim, 0) == NULL) {
        return no_application(sim);
    }
    can_frame_t sent = {.identifier = frame->identifier, .length = frame->length};
    memcpy(sent.data, frame->data, sizeof(sent.data));
    for (int k = 0; k < sim->bench.wheels; k++) {
        application_of(sim, k)->can_send(&sent);
    }
    return HUBSIM_OK;
}

/* A message for all wheels is on the bus once, although each wheel's side of it sends it. */
static bool is_for_all(const can_frame_t *frame, const vehicle_can_t *vehicle)
{
    return frame->identifier == messages_identifier(MESSAGES_BATTERY_LIMITS, vehicle->address) ||
           frame->identifier == messages_identifier(MESSAGES_BATTERY_PEAK, vehicle->address);
}

int hubsim_bus_read(hubsim_t *sim, hubsim_frame_t *frames, int capacity)
{
    if (application_of(sim, 0) == NULL) {
        return no_application(sim);
    }
    int count = 0;
    for (int k = 0; k < sim->bench.wheels; k++) {
        board_t *board = application_of(sim, k)->board;
        for (uint32_t i = 0; i < board->tapped_count && count < capacity; i++) {
            const can_frame_t *frame = &board->tapped[i];
            if (k == 0 || !is_for_all(frame, &board->vehicle)) {
                frames[count].identifier = frame->identifier;
                frames[count].length = frame->length;
                memcpy(frames[count].data, frame->data, sizeof(frames[count].data));
                count++;
            }
        }
        board->tapped_count = 0;
    }
    return count;
}

int hubsim_serial_take(hubsim_t *sim, int wheel, char *bytes, int size)
{
    const application_t *application = application_of(sim, wheel);
    return application == NULL ? no_application(sim)
                               : (int)application->serial_take(bytes, (uint32_t)size);
}

int hubsim_serial_type(hubsim_t *sim, int wheel, const char *bytes, int size)
{
    const application_t *application = application_of(sim, wheel);
    if (application == NULL) {
        return no_application(sim);
    }
    application->serial_put(bytes, (uint32_t)size);
    return HUBSIM_OK;
}

int hubsim_steps_read(hubsim_t *sim, int wheel, hubsim_step_t *steps, int capacity)
{
    const application_t *application = application_of(sim, wheel);
    if (application == NULL) {
        return no_application(sim);
    }
    recording_t *recording = application->recording;
    if (recording->lost) {
        return handle_fail(sim, HUBSIM_FAILED, "no memory for the steps of wheel %d", wheel);
    }
    const uint32_t space = (uint32_t)capacity;
    const uint32_t count = recording->count < space ? recording->count : space;
    if (count > 0) {
        recording->count -= count;
        memcpy(steps, recording->step, count * sizeof(*steps));
        memmove(recording->step, &recording->step[count], recording->count * sizeof(*steps));
    }
    return (int)count;
}

int hubsim_steps_config(hubsim_t *sim, int wheel, void *image, uint32_t size_bytes)
{
    const application_t *application = application_of(sim, wheel);
    if (application == NULL || size_bytes != sizeof(config_t)) {
        return no_application(sim);
    }
    memcpy(image, &application->recording->config, sizeof(config_t));
    return HUBSIM_OK;
}

int hubsim_packet_send(hubsim_t *sim, int wheel, const void *bytes, int length)
{
    const application_t *application = application_of(sim, wheel);
    packet_t packet;
    if (application == NULL) {
        return no_application(sim);
    }
    if (length < 1 || length > PACKET_BYTES) {
        return handle_fail(sim, HUBSIM_BAD_VALUE, "a packet of %d bytes: accepted: 1 to %d", length,
                           PACKET_BYTES);
    }
    packet.length = (uint8_t)length;
    memcpy(packet.bytes, bytes, (size_t)length);
    (void)application->packet_send(&packet);
    return HUBSIM_OK;
}

int hubsim_packets_take(hubsim_t *sim, int wheel, void *bytes, int size)
{
    const application_t *application = application_of(sim, wheel);
    unsigned char *to = bytes;
    int used = 0;
    packet_t packet;
    if (application == NULL) {
        return no_application(sim);
    }
    while (size - used > PACKET_BYTES && application->packet_receive(&packet)) {
        to[used] = packet.length;
        memcpy(&to[used + 1], packet.bytes, packet.length);
        used += 1 + packet.length;
    }
    return used;
}
