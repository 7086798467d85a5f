/* SPDX-License-Identifier: Apache-2.0 */
#include "loop.h"

#include <stdlib.h>

#include "config/bases.h"
#include "controller/operating_point.h"
#include "current_controller.h"
#include "field_weakening.h"
#include "foc/foc.h"

struct loop_s {
    config_t config;
    foc_state_t foc;
    fast_setpoint_t setpoint;
    operating_point_state_t operating_point;
    int32_t periods_to_slow_step;
    int32_t winding_temperature_cC;
};

loop_t *loop_new(const config_t *config)
{
    loop_t *loop = calloc(1, sizeof(*loop));
    if (loop == NULL) {
        abort();
    }
    loop->config = *config;
    foc_init(&loop->foc, &loop->config, BASES_MODEL_TIMER_Hz);
    operating_point_init(&loop->operating_point, &loop->config, BASES_MODEL_TIMER_Hz);
    operating_point_initial_setpoint(&loop->config, BASES_MODEL_TIMER_Hz, &loop->setpoint);
    loop->winding_temperature_cC = config->motor.reference_temperature_cC;
    return loop;
}

void loop_free(loop_t *loop)
{
    free(loop);
}

void loop_set_reference(loop_t *loop, int32_t i_d_pu, int32_t i_q_pu)
{
    loop->setpoint.i_reference_pu.d = i_d_pu;
    loop->setpoint.i_reference_pu.q = i_q_pu;
    loop->setpoint.sequence++;
}

void loop_set_winding_temperature(loop_t *loop, int32_t winding_temperature_cC)
{
    loop->winding_temperature_cC = winding_temperature_cC;
}

void loop_calibrate_offsets(loop_t *loop, bool calibrate)
{
    loop->setpoint.calibrate_offsets = calibrate;
}

loop_output_t loop_step(loop_t *loop, const loop_input_t *in, bool run)
{
    const foc_input_t sampled = {
        .phase_current_code = {in->phase_code[0], in->phase_code[1], in->phase_code[2]},
        .bus_voltage_code = in->bus_code,
        .rotor_angle_turn = in->rotor_angle_turn,
        .hall_state = in->hall_state,
    };
    if (run) {
        foc_step(&loop->foc, &loop->config, &loop->setpoint, &sampled);
    } else {
        foc_idle_step(&loop->foc, &loop->config, &loop->setpoint, &sampled);
    }
    if (--loop->periods_to_slow_step <= 0) {
        loop->periods_to_slow_step = loop->config.drive.pwm_frequency_Hz / 1000;
        fast_report_t report;
        foc_report_copy(&loop->foc, &report);
        foc_report_complete(&report);
        const rotor_speed_t speed = {
            .turn_q32 = report.speed_q32,
            .wheel_mrad_s = bases_speed_mrad_s(&loop->config, report.speed_q32),
        };
        measured_t now = {.report = &report};
        operating_point_of(&loop->operating_point, &loop->config, speed,
                           loop->winding_temperature_cC, &now);
        const dq_t reference_pu = loop->setpoint.i_reference_pu;
        operating_point_setpoint(&loop->operating_point, &loop->config, 0, 0, &loop->setpoint);
        loop->setpoint.i_reference_pu = reference_pu;
        loop->setpoint.sequence++;
    }
    const foc_period_t *period = foc_latest(&loop->foc);
    const voltage_out_t *voltage = &period->voltage;
    const dq_t i = dq_of(period->i_pu);
    const dq_t u = dq_of(voltage->applied);
    const dq_t unsaturated = voltage_unsaturated(voltage);
    const loop_output_t out = {
        .compare_counts = {(uint16_t)(loop->foc.current.on_q16[0] >> 16),
                           (uint16_t)(loop->foc.current.on_q16[1] >> 16),
                           (uint16_t)(loop->foc.current.on_q16[2] >> 16)},
        .i_d_pu = i.d,
        .i_q_pu = i.q,
        .reference_d_pu = dq_of(period->i_reference_pu).d,
        .reference_q_pu = dq_of(period->i_reference_pu).q,
        .u_d_pu = u.d,
        .u_q_pu = u.q,
        .weakening_pu = field_weakening_current_pu(&loop->foc.weakening),
        .power_pu = loop->operating_point.power_pu,
        .modulation_limit_q15 = foc_modulation_limit_q15(&loop->config, BASES_MODEL_TIMER_Hz),
        .speed_q32 = period->rotor.speed_q32,
        .theta_turn = period->rotor.theta_turn,
        .limited = unsaturated.d != u.d || unsaturated.q != u.q,
        .sensor_valid = period->rotor.valid,
    };
    return out;
}
