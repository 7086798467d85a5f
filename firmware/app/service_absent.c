/* SPDX-License-Identifier: Apache-2.0 */
/* A port without XCP: service_t is not used. */
#include "app/service.h"

void service_init(service_t *service, const config_t *config, const service_link_t *link)
{
    (void)service;
    (void)config;
    (void)link;
}

void service_slow_step(service_t *service, const slow_output_t *output, const slow_input_t *input)
{
    (void)service;
    (void)output;
    (void)input;
}

void service_fast_step(scope_t *recording, const controller_fast_t *fast)
{
    (void)recording;
    (void)fast;
}

bool service_accepts(const service_t *service, uint16_t *identifier)
{
    (void)service;
    *identifier = 0;
    return false;
}

void service_receive(service_t *service, const service_view_t *view, const can_frame_t *frame,
                     uint32_t now_ms)
{
    (void)service;
    (void)view;
    (void)frame;
    (void)now_ms;
}

void service_receive_serial(service_t *service, const service_view_t *view, const uint8_t *packet,
                            uint32_t length, uint32_t now_ms)
{
    (void)service;
    (void)view;
    (void)packet;
    (void)length;
    (void)now_ms;
}

uint32_t service_serial_answer(service_t *service, const uint8_t **packet)
{
    (void)service;
    (void)packet;
    return 0;
}

void service_end_serial(service_t *service, const service_view_t *view, uint32_t now_ms)
{
    (void)service;
    (void)view;
    (void)now_ms;
}

void service_step(service_t *service, const service_view_t *view, uint32_t now_ms)
{
    (void)service;
    (void)view;
    (void)now_ms;
}

bool service_wants_store(const service_t *service)
{
    (void)service;
    return false;
}

void service_store(service_t *service, xcp_error_t error, uint32_t now_ms)
{
    (void)service;
    (void)error;
    (void)now_ms;
}

bool service_store_is_due(service_t *service, uint32_t now_ms)
{
    (void)service;
    (void)now_ms;
    return false;
}
