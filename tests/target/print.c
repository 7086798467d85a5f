/* SPDX-License-Identifier: Apache-2.0 */
#include "print.h"

static void print_number(uint32_t value, uint32_t base)
{
    char digits[12] = {0};
    int at = 11;
    do {
        digits[--at] = "0123456789ABCDEF"[value % base];
        value /= base;
    } while (value > 0);
    print(&digits[at]);
}

void print_trace(uint32_t crc, const char *name, const uint32_t mode_steps[PRINT_MODES])
{
    print_number(crc, 16);
    print("  ");
    print(name);
    for (int mode = 0; mode < PRINT_MODES; mode++) {
        if (mode_steps[mode] > 0) {
            print(", ");
            print(operating_mode_text((operating_mode_t)mode));
            print(" ");
            print_number(mode_steps[mode], 10);
        }
    }
    print("\n");
}
