/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board's line for packets. */
#include "hal/packets.h"

#include <string.h>

#include "board.h"
#include "host/port.h"

enum { QUEUE = 512 };

typedef struct {
    packet_t packet[QUEUE];
    uint32_t first, count;
} queue_t;

static struct {
    queue_t to_controller, from_controller;
} line;

void board_reset_packets(void)
{
    memset(&line, 0, sizeof line);
}

static bool push(queue_t *queue, const packet_t *packet)
{
    if (queue->count == QUEUE) {
        return false;
    }
    queue->packet[(queue->first + queue->count) % QUEUE] = *packet;
    queue->count++;
    return true;
}

static bool pop(queue_t *queue, packet_t *packet)
{
    if (queue->count == 0) {
        return false;
    }
    *packet = queue->packet[queue->first];
    queue->first = (queue->first + 1U) % QUEUE;
    queue->count--;
    return true;
}

bool host_packet_send(const packet_t *packet)
{
    return push(&line.to_controller, packet);
}

bool host_packet_receive(packet_t *packet)
{
    return pop(&line.from_controller, packet);
}

bool packets_receive(packet_t *packet)
{
    return pop(&line.to_controller, packet);
}

bool packets_send(const packet_t *packet)
{
    return push(&line.from_controller, packet);
}
