/* SPDX-License-Identifier: Apache-2.0 */
/* wheel_address.h: a wheel's place on the bus with the base of the DBC. */
#ifndef WHEEL_ADDRESS_H
#define WHEEL_ADDRESS_H

#include "comms/messages.h"

static inline messages_address_t address_of(messages_wheel_t wheel)
{
    const messages_address_t address = {.base = MESSAGES_BASE, .wheel = wheel};
    return address;
}

#endif
