/* SPDX-License-Identifier: Apache-2.0 */
/* A port without XCP: the serial line is the shell's. */
#include <stddef.h>

#include "app/console_xcp.h"

void console_xcp_init(console_xcp_t *xcp)
{
    (void)xcp;
}

bool console_xcp_open(console_xcp_t *xcp, uint32_t now_ms)
{
    (void)xcp;
    (void)now_ms;
    return false;
}

bool console_xcp_has_line(const console_xcp_t *xcp)
{
    (void)xcp;
    return false;
}

bool console_xcp_lets_text(const console_xcp_t *xcp)
{
    (void)xcp;
    return true;
}

void console_xcp_pump(console_xcp_t *xcp, uint32_t now_ms, bool text_has_left)
{
    (void)xcp;
    (void)now_ms;
    (void)text_has_left;
}

const uint8_t *console_xcp_packet(console_xcp_t *xcp, uint32_t *length)
{
    (void)xcp;
    (void)length;
    return NULL;
}

void console_xcp_answer(console_xcp_t *xcp, const uint8_t *packet, uint32_t length)
{
    (void)xcp;
    (void)packet;
    (void)length;
}

bool console_xcp_has_ended(console_xcp_t *xcp)
{
    (void)xcp;
    return false;
}
