/* SPDX-License-Identifier: Apache-2.0 */
#include "app/console_xcp.h"

#include <stddef.h>

#include "hal/serial.h"

enum { DISCONNECT = 0xFE /* comms/xcp.h */ };

void console_xcp_init(console_xcp_t *xcp)
{
    const console_xcp_t fresh = {.use = CONSOLE_TEXT};
    *xcp = fresh;
}

bool console_xcp_open(console_xcp_t *xcp, uint32_t now_ms)
{
    console_xcp_init(xcp);
    sxi_init(&xcp->sxi, now_ms);
    xcp->use = CONSOLE_LAST_TEXT;
    return true;
}

bool console_xcp_has_line(const console_xcp_t *xcp)
{
    return xcp->use != CONSOLE_TEXT;
}

bool console_xcp_lets_text(const console_xcp_t *xcp)
{
    return xcp->use == CONSOLE_TEXT || xcp->use == CONSOLE_LAST_TEXT;
}

static void send_answer(console_xcp_t *xcp)
{
    const uint32_t left = (uint32_t)xcp->answer_bytes - xcp->answer_sent;
    if (left > 0) {
        const char *bytes = (const char *)&xcp->answer[xcp->answer_sent];
        xcp->answer_sent = (uint8_t)(xcp->answer_sent + serial_write(bytes, left));
    } else if (xcp->use == CONSOLE_LAST_ANSWER) {
        xcp->use = CONSOLE_TEXT;
    }
}

void console_xcp_pump(console_xcp_t *xcp, uint32_t now_ms, bool text_has_left)
{
    if (xcp->use == CONSOLE_TEXT) {
        return;
    }
    if (xcp->use == CONSOLE_LAST_TEXT) {
        xcp->use = text_has_left ? CONSOLE_XCP : CONSOLE_LAST_TEXT;
    } else {
        send_answer(xcp);
    }
    uint8_t byte;
    while (xcp->use != CONSOLE_TEXT && xcp->command_bytes == 0 && serial_read(&byte)) {
        xcp->command_bytes = (uint8_t)sxi_receive(&xcp->sxi, byte, now_ms);
    }
    if (xcp->use != CONSOLE_TEXT && sxi_is_silent(&xcp->sxi, now_ms)) {
        xcp->use = CONSOLE_TEXT;
        xcp->ended = true;
    }
}

const uint8_t *console_xcp_packet(console_xcp_t *xcp, uint32_t *length)
{
    if (xcp->use == CONSOLE_TEXT || xcp->answer_sent < xcp->answer_bytes) {
        return NULL;
    }
    *length = xcp->command_bytes;
    xcp->command_bytes = 0;
    return *length > 0 ? &xcp->sxi.frame[SXI_HEADER_BYTES] : NULL;
}

void console_xcp_answer(console_xcp_t *xcp, const uint8_t *packet, uint32_t length)
{
    const bool ends = xcp->sxi.frame[SXI_HEADER_BYTES] == DISCONNECT;
    if (xcp->use == CONSOLE_TEXT) {
        return;
    }
    xcp->answer_bytes = (uint8_t)sxi_frame(&xcp->sxi, packet, length, xcp->answer);
    xcp->answer_sent = 0;
    xcp->use = ends ? CONSOLE_LAST_ANSWER : xcp->use;
}

bool console_xcp_has_ended(console_xcp_t *xcp)
{
    const bool ended = xcp->ended;
    xcp->ended = false;
    return ended;
}
