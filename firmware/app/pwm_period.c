/* SPDX-License-Identifier: Apache-2.0 */
#include "app/pwm_period.h"

#include "hal/analog.h"
#include "hal/inverter.h"
#include "hal/rotor_sensor.h"

_Static_assert((int)INVERTER_MODE_OFF == (int)BRIDGE_OFF &&
                   (int)INVERTER_MODE_PWM == (int)BRIDGE_PWM &&
                   (int)INVERTER_MODE_SHORT == (int)BRIDGE_SHORT &&
                   (int)INVERTER_MODE_SHORT_HIGH == (int)BRIDGE_SHORT_HIGH,
               "the same numbers");

static inverter_mode_t inverter_mode(bridge_mode_t bridge)
{
    return (inverter_mode_t)((uint32_t)bridge & 3U);
}

static void read_rotor_sensor(const config_t *config, fast_input_t *in)
{
    if (config->rotor.sensor == CONFIG_ROTOR_HALL) {
        in->hall_state = rotor_sensor_hall_state();
    } else if (config->rotor.sensor == CONFIG_ROTOR_ENCODER) {
        const rotor_sensor_encoder_t encoder = rotor_sensor_encoder();
        in->encoder.count = encoder.count;
        in->encoder.index_count = encoder.index_count;
        in->encoder.index = encoder.index;
    } else { /* CONFIG_ROTOR_ANGLE; config_validate() refuses other values */
        in->rotor_angle_turn = rotor_sensor_angle_turn();
    }
}

static void read_inputs(const config_t *config, fast_input_t *in)
{
    analog_sample_t sample;
    analog_read(&sample);
    in->phase_current_code[0] = sample.phase_current_code[0];
    in->phase_current_code[1] = sample.phase_current_code[1];
    in->phase_current_code[2] = sample.phase_current_code[2];
    in->bus_voltage_code = sample.bus_voltage_code;
    in->power_stage_fault = inverter_fault();
    read_rotor_sensor(config, in);
}

const fast_output_t *pwm_period_step(controller_fast_t *fast, const config_t *config,
                                     const fast_setpoint_t *setpoint, fast_input_t *in)
{
    read_inputs(config, in);
    const fast_output_t *out = controller_fast_step(fast, config, setpoint, in);
    inverter_set(inverter_mode(out->bridge), out->compare_counts);
    return out;
}
