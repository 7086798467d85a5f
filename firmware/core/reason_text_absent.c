/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reason.h"

const char *reason_text(reason_t reason)
{
    return reason_name(reason);
}
