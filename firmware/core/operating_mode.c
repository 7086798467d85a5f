/* SPDX-License-Identifier: Apache-2.0 */
#include "core/operating_mode.h"

const char *operating_mode_text(operating_mode_t mode)
{
    switch (mode) {
    case MODE_BOOT:
        return "BOOT";
    case MODE_SELFTEST:
        return "SELFTEST";
    case MODE_OFFSET_CAL:
        return "OFFSET_CAL";
    case MODE_READY:
        return "READY";
    case MODE_RUN:
        return "RUN";
    case MODE_LIMP:
        return "LIMP";
    case MODE_FAULT:
        return "FAULT";
    }
    return "unknown mode";
}
