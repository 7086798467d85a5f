/* SPDX-License-Identifier: Apache-2.0 */
/*
 * board_check.h: whether a configuration is one for this board. One for another would control with
 * wrong currents and voltages.
 */
#ifndef APP_BOARD_CHECK_H
#define APP_BOARD_CHECK_H

#include "config/validate.h"

/* config_validate(), then full scales within 5 % of the board's, the divider of its switches'
 * sensor, a dead time that its switches need and a sampling window that is long enough for it. At
 * start, and before a configuration is installed. */
config_result_t board_check_config(const config_t *config, uint32_t size_bytes);

#endif
