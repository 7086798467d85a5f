/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board's CAN, serial line and watchdog. */
#include <string.h>
#include <sys/random.h>

#include "board.h"
#include "hal/can.h"
#include "hal/random.h"
#include "hal/serial.h"
#include "hal/watchdog.h"
#include "host/port.h"

enum { ACCEPTED_MAX = 14 };

typedef struct {
    can_frame_t frame[HOST_CAN_FRAMES];
    uint32_t first, count;
} queue_t;

/* A frame of the controller's: until the vehicle takes it, and until the controller has asked. */
typedef struct {
    can_frame_t frame;
    bool pending, sent;
} place_t;

static struct {
    queue_t to_controller;
    place_t place[HOST_CAN_FRAMES];
    uint16_t accepted[ACCEPTED_MAX];
    uint32_t accepted_count;
    char output[HOST_SERIAL_BYTES];
    uint32_t output_bytes;
    char typed[HOST_SERIAL_BYTES];
    uint32_t typed_bytes, read_bytes;
    uint32_t watchdog_timeout_ms, watchdog_left_ms;
    bool watchdog_bit;
    reset_cause_t reset_cause;
} lines;

void board_reset_lines(void)
{
    memset(&lines, 0, sizeof lines);
}

/* The serial line is the reader's: what was written stays. */
void board_restart_lines(reset_cause_t cause)
{
    memset(&lines.to_controller, 0, sizeof lines.to_controller);
    memset(lines.place, 0, sizeof lines.place);
    lines.accepted_count = 0;
    lines.read_bytes = lines.typed_bytes;
    lines.watchdog_timeout_ms = 0;
    lines.watchdog_bit = false;
    lines.reset_cause = cause;
}

static bool push(queue_t *queue, const can_frame_t *frame)
{
    if (queue->count == HOST_CAN_FRAMES) {
        return false;
    }
    queue->frame[(queue->first + queue->count) % HOST_CAN_FRAMES] = *frame;
    queue->count++;
    return true;
}

static bool pop(queue_t *queue, can_frame_t *frame)
{
    if (queue->count == 0) {
        return false;
    }
    *frame = queue->frame[queue->first];
    queue->first = (queue->first + 1U) % HOST_CAN_FRAMES;
    queue->count--;
    return true;
}

void host_can_send(const can_frame_t *frame)
{
    for (uint32_t i = 0; i < lines.accepted_count; i++) {
        if (lines.accepted[i] == frame->identifier) {
            (void)push(&lines.to_controller, frame);
        }
    }
}

static place_t *place_of(uint32_t identifier)
{
    place_t *found = NULL;
    for (uint32_t i = 0; i < HOST_CAN_FRAMES; i++) {
        place_t *place = &lines.place[i];
        if ((place->pending || place->sent) && place->frame.identifier == identifier) {
            found = place;
        }
    }
    return found;
}

static place_t *free_place(void)
{
    uint32_t i = 0;
    while (i < HOST_CAN_FRAMES && (lines.place[i].pending || lines.place[i].sent)) {
        i++;
    }
    return i < HOST_CAN_FRAMES ? &lines.place[i] : NULL;
}

static bool places_are_free(void)
{
    uint32_t i = 0;
    while (i < HOST_CAN_FRAMES && !lines.place[i].pending && !lines.place[i].sent) {
        i++;
    }
    return i == HOST_CAN_FRAMES;
}

bool host_can_receive(can_frame_t *frame)
{
    place_t *urgent = NULL;
    for (uint32_t i = 0; i < HOST_CAN_FRAMES; i++) {
        place_t *place = &lines.place[i];
        if (place->pending &&
            (urgent == NULL || place->frame.identifier < urgent->frame.identifier)) {
            urgent = place;
        }
    }
    if (urgent == NULL) {
        return false;
    }
    *frame = urgent->frame;
    urgent->pending = false;
    urgent->sent = true;
    return true;
}

bool can_init(const uint16_t *accepted_identifiers, uint32_t count)
{
    if (count == 0 || count > ACCEPTED_MAX) {
        return false;
    }
    memcpy(lines.accepted, accepted_identifiers, count * sizeof accepted_identifiers[0]);
    lines.accepted_count = count;
    return true;
}

bool can_receive(can_frame_t *frame)
{
    return pop(&lines.to_controller, frame);
}

bool can_transmit(const can_frame_t *frame)
{
    place_t *place = place_of(frame->identifier);
    if (place == NULL && (frame->identifier < CAN_EXTENDED || places_are_free())) {
        place = free_place();
    }
    if (place == NULL || place->sent) {
        return false;
    }
    place->frame = *frame;
    place->pending = true;
    return true;
}

can_progress_t can_progress(uint32_t identifier)
{
    place_t *place = place_of(identifier);
    if (place == NULL) {
        return CAN_ABORTED;
    }
    if (place->pending) {
        return CAN_PENDING;
    }
    place->sent = false;
    return CAN_SENT;
}

/* The operating system's; nothing of a simulation depends on it. */
bool random_draw(uint64_t *bits)
{
    return getrandom(bits, sizeof *bits, GRND_NONBLOCK) == (ssize_t)sizeof *bits;
}

bool can_bus_off(void)
{
    return false;
}

const char *host_serial_output(void)
{
    return lines.output;
}

uint32_t host_serial_take(char *bytes, uint32_t size)
{
    const uint32_t taken = size < lines.output_bytes ? size : lines.output_bytes;
    memcpy(bytes, lines.output, taken);
    lines.output_bytes -= taken;
    memmove(lines.output, &lines.output[taken], lines.output_bytes);
    lines.output[lines.output_bytes] = 0;
    return taken;
}

void host_serial_put(const char *bytes, uint32_t size)
{
    lines.typed_bytes -= lines.read_bytes;
    memmove(lines.typed, &lines.typed[lines.read_bytes], lines.typed_bytes);
    lines.read_bytes = 0;
    const uint32_t space = (uint32_t)sizeof lines.typed - lines.typed_bytes;
    memcpy(&lines.typed[lines.typed_bytes], bytes, size < space ? size : space);
    lines.typed_bytes += size < space ? size : space;
}

void host_serial_type(const char *text)
{
    host_serial_put(text, (uint32_t)strlen(text));
}

void serial_init(uint32_t bit_rate)
{
    (void)bit_rate;
}

uint32_t serial_write(const char *bytes, uint32_t size)
{
    const uint32_t space = (uint32_t)sizeof lines.output - 1U - lines.output_bytes;
    const uint32_t accepted = size < space ? size : space;
    memcpy(&lines.output[lines.output_bytes], bytes, accepted);
    lines.output_bytes += accepted;
    return accepted;
}

bool serial_read(uint8_t *byte)
{
    if (lines.read_bytes == lines.typed_bytes) {
        return false;
    }
    *byte = (uint8_t)lines.typed[lines.read_bytes];
    lines.read_bytes++;
    return true;
}

void watchdog_start(uint32_t timeout_ms)
{
    lines.watchdog_timeout_ms = timeout_ms;
    lines.watchdog_left_ms = timeout_ms;
}

void watchdog_feed(void)
{
    lines.watchdog_left_ms = lines.watchdog_timeout_ms;
}

reset_cause_t watchdog_reset_cause(void)
{
    return lines.reset_cause; /* 0: unknown */
}

void board_watchdog_tick(void)
{
    if (lines.watchdog_timeout_ms == 0) {
        return;
    }
    if (lines.watchdog_left_ms > 0) {
        lines.watchdog_left_ms--;
    } else {
        lines.watchdog_bit = true;
    }
}

bool host_watchdog_bit(void)
{
    return lines.watchdog_bit;
}
