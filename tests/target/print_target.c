/* SPDX-License-Identifier: Apache-2.0 */
#include "print.h"

#include "semihost.h"

void print(const char *text)
{
    semihost_print(text);
}
