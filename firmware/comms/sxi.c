/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/sxi.h"

void sxi_init(sxi_t *sxi, uint32_t now_ms)
{
    const sxi_t fresh = {.latest_ms = now_ms};
    *sxi = fresh;
}

static uint8_t sum_of(const uint8_t *bytes, uint32_t count)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        sum += bytes[i];
    }
    return (uint8_t)sum;
}

uint32_t sxi_receive(sxi_t *sxi, uint8_t byte, uint32_t now_ms)
{
    if (now_ms - sxi->latest_ms >= SXI_GAP_ms) {
        sxi->received = 0;
        sxi->skips = false;
    }
    sxi->latest_ms = now_ms;
    if (sxi->skips) {
        return 0;
    }
    sxi->frame[sxi->received] = byte;
    sxi->received++;
    const uint32_t length = sxi->frame[0];
    if (length == 0 || length > XCP_PACKET_BYTES) {
        sxi->skips = true;
        return 0;
    }
    if (sxi->received <= SXI_HEADER_BYTES + length) {
        return 0;
    }
    sxi->received = 0;
    sxi->skips = sum_of(sxi->frame, SXI_HEADER_BYTES + length) != byte;
    return sxi->skips ? 0 : length;
}

uint32_t sxi_frame(sxi_t *sxi, const uint8_t *packet, uint32_t length,
                   uint8_t frame[SXI_FRAME_BYTES])
{
    frame[0] = (uint8_t)length;
    frame[1] = sxi->counter;
    for (uint32_t i = 0; i < length; i++) {
        frame[SXI_HEADER_BYTES + i] = packet[i];
    }
    frame[SXI_HEADER_BYTES + length] = sum_of(frame, SXI_HEADER_BYTES + length);
    sxi->counter++;
    return SXI_HEADER_BYTES + length + 1U;
}

bool sxi_is_silent(const sxi_t *sxi, uint32_t now_ms)
{
    return now_ms - sxi->latest_ms >= SXI_SILENCE_ms;
}
