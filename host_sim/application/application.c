/* SPDX-License-Identifier: Apache-2.0 */
#include "application/application.h"

static board_t board;
static application_t application;

const application_t *application_entry(void)
{
    const application_t entry = {.sizes = APPLICATION_SIZES,
                                 .board = &board,
                                 .coupling = board_coupling(&board),
                                 .start = board_start};
    application = entry;
    return &application;
}
