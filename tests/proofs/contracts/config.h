/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of config, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* config/demand_age.h */
POST(demand_is_lost, age_ms > 1000 ? result : (age_ms > 4 || !result))

POST(demand_needs_transmission, !result || config->driver.no_other_brake == 0)
POST(demand_needs_transmission, !result || config->pedals.brake_channels == 0)
POST(demand_needs_transmission, !result || config->brake.max_hydraulic_torque_mNm > 0)

/* config/finding_times.h */
POST(finding_times, finding_times_hold(times))
