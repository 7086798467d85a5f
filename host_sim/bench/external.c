/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/external.h"

#include <math.h>

#include "bench/handle.h"
#include "config/bases.h"
#include "plant/numbers.h"

enum { CODES = 4096, MIDDLE = CODES / 2, MILLI = 1000 };

/* The top of the count: the sensors' view is kept for hubsim_external_read(). */
static fast_output_t period(void *context, const fast_input_t *in)
{
    external_wheel_t *wheel = context;
    wheel->sampled = *in;
    return wheel->given;
}

/* The millisecond: the bench reads the hydraulic demand only. */
static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    (void)in;
    const external_wheel_t *wheel = context;
    const slow_output_t out = {.mode = MODE_RUN,
                               .hydraulic_torque_mNm = (int32_t)lround(wheel->hydraulic_nm * MILLI),
                               .hydraulic_valid = true};
    return out;
}

int hubsim_external_wheels(const hubsim_t *sim)
{
    return sim->has_started ? sim->bench.wheels : 0;
}

int hubsim_external_take(hubsim_t *sim, int delay_periods)
{
    if (!sim->has_started || sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "hubsim_external_take: accepted: once, after hubsim_start");
    }
    if (sim->rear != NULL) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "hubsim_external_take: accepted: with front and rear drives that are "
                           "alike");
    }
    if (delay_periods < 0 || delay_periods > 1) {
        return handle_fail(sim, HUBSIM_BAD_VALUE, "delay_periods: %d, accepted: 0 or 1",
                           delay_periods);
    }
    external_t *external = &sim->external;
    external->at_work = true;
    external->delayed = delay_periods == 1;
    for (int k = 0; k < sim->bench.wheels; k++) {
        external_wheel_t *own = &external->wheel[k];
        own->given = sim->bench.wheel[k].next;
        own->hydraulic_nm = 0.0;
        external->coupling[k].context = own;
        external->coupling[k].period = period;
        external->coupling[k].millisecond = millisecond;
        sim->bench.wheel[k].coupling = &external->coupling[k];
    }
    bench_begin_period(&sim->bench);
    return HUBSIM_OK;
}

static bool is_acceptable(const hubsim_command_t *command)
{
    for (int i = 0; i < 3; i++) {
        if (!isfinite(command->duty[i])) {
            return false;
        }
    }
    return command->bridge >= HUBSIM_BRIDGE_OFF && command->bridge <= HUBSIM_BRIDGE_SHORT_HIGH &&
           command->hydraulic_nm >= 0.0 && command->hydraulic_nm <= 1e6;
}

static fast_output_t output_of(const hubsim_command_t *command, int32_t period_counts)
{
    fast_output_t out = {.bridge = (bridge_mode_t)command->bridge};
    for (int i = 0; i < 3; i++) {
        const double duty = plant_clamp(command->duty[i], 0.0, 1.0);
        out.compare_counts[i] = (uint16_t)lround(duty * period_counts);
    }
    return out;
}

int hubsim_external_step(hubsim_t *sim, const hubsim_command_t *commands)
{
    if (!sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_external_take comes first");
    }
    bench_t *bench = &sim->bench;
    for (int k = 0; k < bench->wheels; k++) {
        if (!is_acceptable(&commands[k])) {
            return handle_fail(sim, HUBSIM_BAD_VALUE,
                               "command of wheel %d: accepted: finite duties, bridge 0 to 2, "
                               "hydraulic_nm 0 to 1e6",
                               k);
        }
    }
    if (bench_has_ended(bench)) {
        return HUBSIM_ENDED;
    }
    for (int k = 0; k < bench->wheels; k++) {
        external_wheel_t *own = &sim->external.wheel[k];
        own->given =
            output_of(&commands[k], bases_pwm_period_counts(&bench->config, BASES_MODEL_TIMER_Hz));
        own->hydraulic_nm = commands[k].hydraulic_nm;
        if (!sim->external.delayed) {
            bench->wheel[k].active = own->given;
        }
    }
    bench_end_period(bench);
    const int status = handle_after_period(sim);
    if (status != HUBSIM_OK) {
        return status;
    }
    bench_begin_period(bench);
    return bench_has_ended(bench) ? HUBSIM_ENDED : HUBSIM_OK;
}

static hubsim_wheel_t wheel_now(const wheel_t *wheel, const external_wheel_t *own,
                                const sensors_params_t *sensors)
{
    const plant_abc_t wires = plant_inverse_clarke(wheel->rotor.terminal);
    const double amperes_per_code = sensors->current_full_scale_a / MIDDLE;
    hubsim_wheel_t out = {
        .phase_current_a = {wires.a, wires.b, wires.c},
        .rotor_turn = wheel->rotor.theta_turn,
        .speed_rad_s = wheel->motion.speed_rad_s,
        .motor_torque_nm = pmsm_torque_nm(&wheel->machine, wheel->rotor.i_t),
        .hydraulic_torque_nm = wheel->brake_capacity_nm,
        .winding_temperature_c = wheel->winding.temperature_c,
        .switch_temperature_c = wheel->switches.temperature_c,
        .hall_state = own->sampled.hall_state,
        .encoder_count = (int32_t)own->sampled.encoder.count,
    };
    for (int i = 0; i < 3; i++) {
        out.phase_current_measured_a[i] =
            ((double)own->sampled.phase_current_code[i] - MIDDLE) * amperes_per_code;
    }
    return out;
}

int hubsim_external_read(hubsim_t *sim, hubsim_vehicle_t *vehicle, hubsim_wheel_t *wheels)
{
    if (!sim->external.at_work) {
        return handle_fail(sim, HUBSIM_BAD_ORDER, "hubsim_external_take comes first");
    }
    const bench_t *bench = &sim->bench;
    const bench_params_t *params = &bench->params;
    const fast_input_t *sampled = &sim->external.wheel[0].sampled;
    const hubsim_vehicle_t out = {
        .time_s = bench->time_s,
        .speed_m_per_s = bench->vehicle.speed_m_per_s,
        .bus_voltage_v = bench->bus.voltage_v,
        .bus_voltage_measured_v =
            (double)sampled->bus_voltage_code * params->sensors.voltage_full_scale_v / CODES,
        .battery_voltage_v = bench->battery.terminal_v,
        .battery_current_a = bench->battery.current_a,
        .drive_demand_nm = bench->demand.drive_nm,
        .brake_demand_nm = bench->demand.brake_nm,
        .charge_limit_a = bench->limits.sent.charge_a,
        .discharge_limit_a = bench->limits.sent.discharge_a,
        .enable = params->driver.enable > 0.5,
        .anti_lock_at_work = params->driver.abs_active > 0.5 || bench->abs_unit.anti_lock.at_work,
    };
    *vehicle = out;
    for (int k = 0; k < bench->wheels; k++) {
        wheels[k] = wheel_now(&bench->wheel[k], &sim->external.wheel[k], &params->sensors);
    }
    return HUBSIM_OK;
}
