/* SPDX-License-Identifier: Apache-2.0 */
#include "power.h"

#include "board.h"
#include "bootloader_request.h"
#include "hal/power.h"

#define DRIVE_PIN(port, number, level) gpio_make_output((pin_t){port, number}, level);

void power_start(void)
{
    gpio_init();
    if (pin_is_wired(BOARD_POWER_HOLD)) {
        gpio_make_output(BOARD_POWER_HOLD, true);
    }
    BOARD_CONSTANT_OUTPUTS(DRIVE_PIN)
}

bool power_off(void)
{
    if (!pin_is_wired(BOARD_POWER_HOLD)) {
        return false;
    }
    gpio_write(BOARD_POWER_HOLD, false);
    return true;
}

bool power_request_bootloader(void)
{
    link_bootloader_request[0] = BOOTLOADER_REQUEST;
    link_bootloader_request[1] = ~BOOTLOADER_REQUEST;
    return true;
}
