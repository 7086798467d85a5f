/* SPDX-License-Identifier: Apache-2.0 */
#include "provoke.h"

#include "hal/crash.h"
#include "hal/time.h"
#include "semihost.h"

enum { NONE, STACK, IMAGE, RAM_CODE, AT_ms = 300 };

extern uint32_t link_image_begin[];

static uint32_t wanted;
static volatile uint16_t code = 0x4770; /* bx lr */

void provoke_init(void)
{
    wanted = crash_record() == 0 ? semihost_option("crash", NONE) : (uint32_t)NONE;
}

void provoke_now(void)
{
    if (wanted == NONE || time_ms() < AT_ms) {
        return;
    }
    switch (wanted) {
    case STACK:
        __asm volatile("1: push {r0, r1, r2, r3}\n\tb 1b");
        break;
    case IMAGE:
        *(volatile uint32_t *)link_image_begin = 0;
        break;
    case RAM_CODE:
        __asm volatile("push {%0}\n\tpop {pc}" : : "r"((uintptr_t)&code | 1U));
        break;
    default:
        break;
    }
}
