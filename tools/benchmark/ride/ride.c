/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ride.c: the program whose steps are counted. The firmware's two steps in a closed loop with
 * motor.h: started up, enabled, then a ride through standstill, both directions and into the
 * voltage limit, with demands for driving and braking that change every 50 ms. begin_measuring()
 * marks where counting begins; the last line says where the ride went. Option "rotor": another
 * rotor sensor than the configuration's, by its number there.
 */
#include <stddef.h>

#include "config/bases.h"
#include "config_image.h"
#include "motor.h"
#include "semihost.h"

enum { START_ms = 300, RIDE_ms = 1200, DEMAND_ms = 50, ENCODER_COUNTS = 4096 };

void begin_measuring(void);

/* The plugin waits for this address; the empty statement keeps the call from vanishing. */
__attribute__((noinline, noclone)) void begin_measuring(void)
{
    __asm volatile("");
}

/* Mechanical speed, rad/s: rest, forward to the highest speed, back, and as far the other way. */
static double speed_at(const config_t *config, int ms)
{
    const double most = 1e-3 * config->motor.max_speed_mrad_s;
    const double part = (double)(ms - START_ms) / RIDE_ms;
    if (part < 0.05) {
        return 0.0;
    }
    if (part < 0.35) {
        return most * (part - 0.05) / 0.3;
    }
    if (part < 0.45) {
        return most;
    }
    return part < 0.95 ? most - 2.0 * most * (part - 0.45) / 0.5 : -most;
}

static slow_input_t input_at(const config_t *config, int ms, uint32_t *random)
{
    static int32_t share_of_256;
    if (ms % DEMAND_ms == 0) {
        *random = *random * 1664525U + 1013904223U;
        share_of_256 = (int32_t)(*random >> 23) - 256;
    }
    const int32_t most = config->motor.max_torque_mNm;
    const slow_input_t in = {
        .demand = {.drive_torque_mNm = share_of_256 > 0 ? most / 256 * share_of_256 : 0,
                   .brake_torque_mNm = share_of_256 < 0 ? most / 256 * -share_of_256 * 2 : 0,
                   .direction = DRIVE_DIRECTION_FORWARD,
                   .enable = ms > START_ms / 2},
        .bms = {config->battery.max_charge_current_mA * config->battery.driven_wheels,
                config->battery.max_discharge_current_mA * config->battery.driven_wheels},
        .temperature = {.winding_cC = 2500 + 4 * ms, .switch_cC = 2500 + 2 * ms},
        .selftest_passed = true,
        .config_accepted = true,
    };
    return in;
}

/* The configuration with the rotor sensor that was asked for. */
static const config_t *configuration(void)
{
    static config_t config;
    config = CONFIG_IMAGE;
    config.rotor.sensor = (int32_t)semihost_option("rotor", (uint32_t)config.rotor.sensor);
    if (config.rotor.sensor == CONFIG_ROTOR_ENCODER) {
        config.rotor.encoder_counts = ENCODER_COUNTS;
    }
    return &config;
}

int main(void)
{
    const config_t *config = configuration();
    static controller_t controller;
    controller_init(&controller, config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t fast_setpoint = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
    motor_t motor = {.turns = -1, .random = 1}; /* an index pulse first */
    fast_output_t active = {.bridge = BRIDGE_OFF};
    uint32_t random = 7;
    int running_ms = 0;
    const int fast = config->drive.pwm_frequency_Hz / CONTROLLER_SLOW_RATE_HZ;
    const double bus_V = 0.95e-3 * config->battery.foldback_voltage_mV;
    for (int ms = 0; ms < START_ms + RIDE_ms; ms++) {
        if (ms == START_ms) {
            begin_measuring();
        }
        const double w_rad_s = speed_at(config, ms) * config->motor.pole_pairs;
        for (int i = 0; i < fast; i++) {
            const fast_input_t in = motor_sample(&motor, config, bus_V);
            const fast_output_t next =
                *controller_fast_step(&controller.fast, config, &fast_setpoint, &in);
            motor_step(&motor, config, &active, bus_V, w_rad_s);
            active = next;
        }
        fast_report_t fast_report;
        controller_fast_report(&controller.fast, &fast_report);
        const slow_input_t in = input_at(config, ms, &random);
        const slow_output_t out =
            controller_slow_step(&controller.slow, config, &fast_report, &in, &fast_setpoint);
        if (ms >= START_ms && (out.mode == MODE_RUN || out.mode == MODE_LIMP)) {
            running_ms++;
        }
        if (out.fault_reason != REASON_NONE) {
            semihost_print("ride: ended in a fault: ");
            semihost_print(reason_text(out.fault_reason));
            semihost_print("\n");
            return 1;
        }
    }
    semihost_print(running_ms == RIDE_ms ? "ride: running all the way\n"
                                         : "ride: not running all the way\n");
    return running_ms == RIDE_ms ? 0 : 1;
}
