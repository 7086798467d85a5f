/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/cockpit.h"

#include <math.h>

enum { MILLI = 1000, CODES = 4096, STEPS_A_CODE = 8 /* of 32 768 */, ONE_q15 = 32768 };

cockpit_t cockpit_init(void)
{
    cockpit_t out = {.out = {.age_ms = UINT32_MAX}};
    pedals_init(&out.pedals);
    return out;
}

static int32_t converted_q15(double ratio)
{
    const double code = floor(ratio * CODES);
    return (int32_t)(code < CODES - 1 ? code : CODES - 1) * STEPS_A_CODE;
}

void cockpit_step(cockpit_t *cockpit, const config_t *config, const driver_params_t *driver,
                  const pedal_sensors_params_t *sensors, const wheel_demand_t *received,
                  double received_age_s)
{
    const pedal_sensors_t seen =
        pedal_sensors_read(sensors, driver->accelerator, driver->brake_pedal);
    const pedals_input_t in = {
        .ratio_q15 = {converted_q15(seen.accelerator_a), converted_q15(seen.accelerator_b),
                      converted_q15(seen.brake_a), converted_q15(seen.brake_b)},
        .received = *received,
        .received_age_ms = (uint32_t)lround(received_age_s * MILLI),
    };
    cockpit->out = pedals_step(&cockpit->pedals, config, &in);
}

double cockpit_brake_nm(const config_t *config, const driver_params_t *driver)
{
    const int32_t travel_q15 = (int32_t)lround(driver->brake_pedal * ONE_q15);
    return (double)pedals_brake_torque_mNm(&config->pedals, travel_q15) / MILLI;
}
