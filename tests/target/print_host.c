/* SPDX-License-Identifier: Apache-2.0 */
#include "print.h"

#include <stdio.h>

void print(const char *text)
{
    (void)fputs(text, stdout);
}
