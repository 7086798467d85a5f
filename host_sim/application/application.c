/* SPDX-License-Identifier: Apache-2.0 */
#include "application/application.h"

static board_t board;
static application_t application;

const application_t *application_entry(void)
{
    const application_t entry = {.sizes = APPLICATION_SIZES,
                                 .board = &board,
                                 .coupling = board_coupling(&board),
                                 .recording = recording(),
                                 .start = board_start,
                                 .can_send = host_can_send,
                                 .serial_take = host_serial_take,
                                 .serial_put = host_serial_put,
                                 .packet_send = host_packet_send,
                                 .packet_receive = host_packet_receive};
    application = entry;
    return &application;
}
