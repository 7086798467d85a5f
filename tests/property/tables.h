/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tables.h: what the slow loop makes of the tables in a configuration, in plain C types that C++
 * may include.
 */
#ifndef PROPERTY_TABLES_H
#define PROPERTY_TABLES_H

#include <stdint.h>

#include "config/config.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const config_t CONFIG_EBIKE36V;
extern const config_t CONFIG_IPM400V;
extern const config_t CONFIG_LU2013;
extern const config_t CONFIG_SCOOTER48V;

typedef struct {
    int32_t d_mA, q_mA; /* terminal, peak phase */
} tables_current_t;

/* Airgap torque that returns the most, magnitude, unclamped. */
int32_t tables_best_braking_mNm(const config_t *config, int32_t speed_mrad_s,
                                int32_t winding_temperature_cC);

/* The currents with which the controller makes a signed airgap torque, no limit in its way. */
tables_current_t tables_currents(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC, int32_t airgap_torque_mNm);

typedef struct {
    int32_t lowest_mNm, highest_mNm; /* airgap, signed */
    int32_t weakest_d_mA;            /* the least i_d that field weakening reaches */
} tables_voltage_t;

/* Between which airgap torques the controller stays with a largest phase voltage. */
tables_voltage_t tables_voltage_limit(const config_t *config, int32_t speed_mrad_s,
                                      int32_t winding_temperature_cC, int32_t phase_voltage_mV);

#ifdef __cplusplus
}
#endif

#endif
