/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_speed.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/isqrt.h"
#include "core/q15.h"

enum {
    MOST_CURRENT_mA = 10000000,
    FAST_mrad_s = 1000000, /* no halls stop from there within a sector */
    SEVEN_SECTORS = 7330   /* 7 pi/3, of mrad^2/s^2 to urad/s in a millisecond */
};

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* What a vehicle loses in a millisecond, at the wheel. */
static int64_t fall_urad_s(const config_t *config, int32_t deceleration_mm_s2)
{
    return (int64_t)(deceleration_mm_s2 * 100000 / q_divisor(config->vehicle.wheel_radius_um)) * 10;
}

/* More than the current sensors' errors can make together. */
static bool flows(const config_t *config, bool offsets_known, int64_t square_mA2)
{
    const int32_t unknown_pu = offsets_known ? 0 : 2 * 16 * config->monitor.offset_tolerance_codes;
    const int64_t silence_mA =
        bases_current_mA(config, config->monitor.current_sum_pu_q15 + unknown_pu);
    return square_mA2 > silence_mA * silence_mA;
}

static int64_t square_mA2(const measured_t *now)
{
    const int64_t d_mA = q_limit(now->latest_i_d_mA, MOST_CURRENT_mA);
    const int64_t q_mA = q_limit(now->latest_i_q_mA, MOST_CURRENT_mA);
    return d_mA * d_mA + q_mA * q_mA;
}

/* A quarter turn each so many periods, electrical, is 2 pi / 4 * 1000 f / (pole pairs * periods)
 * mrad/s. */
static int32_t speed_of_mrad_s(const config_t *config, int32_t quarters, int32_t periods)
{
    const int64_t turned = INT64_C(15708) * quarters * config->drive.pwm_frequency_Hz;
    return q_saturate64(turned / (INT64_C(10) * periods * q_divisor(config->motor.pole_pairs)));
}

/* Is a short's current no more than twice what this speed drives? Twice, because a decaying direct
 * current must not pass for a turning one: of the method, not of a vehicle. */
static bool fits(const config_t *config, int32_t speed_mrad_s, int32_t peak_mA)
{
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, speed_mrad_s);
    const int64_t emf_mV = divide_by_billion(w_mrad_s * config->motor.flux_linkage_nWb);
    const int64_t x_uOhm =
        q_saturate64(divide_by_million(w_mrad_s * config->motor.d_inductance_nH));
    const int64_t r_uOhm = config->motor.phase_resistance_uOhm;
    return divide_by_million((x_uOhm > r_uOhm ? x_uOhm : r_uOhm) * peak_mA) <= 2 * emf_mV;
}

static int32_t window_result_mrad_s(const monitor_speed_state_t *state, const config_t *config,
                                    const measured_t *now, int32_t quarters)
{
    const bool full = quarters >= MONITOR_SPEED_WINDOW_QUARTERS;
    const uint16_t end = full ? now->report->quadrant_step : now->report->sequence;
    const int32_t periods = (uint16_t)(end - state->window_periods);
    if (periods == 0) {
        return MONITOR_SPEED_UNKNOWN;
    }
    if (!flows(config, now->report->offsets_done, state->peak_square_mA2)) {
        return 0;
    }
    const int32_t speed_mrad_s = speed_of_mrad_s(config, full ? quarters : quarters + 1, periods);
    const int32_t peak_mA = (int32_t)isqrt64((uint64_t)state->peak_square_mA2);
    return fits(config, speed_mrad_s, peak_mA) ? speed_mrad_s : MONITOR_SPEED_UNKNOWN;
}

static void begin_window(monitor_speed_state_t *state, const measured_t *now, uint16_t at_step)
{
    state->window_steps = 0;
    state->peak_square_mA2 = 0;
    state->window_quarters = now->report->quadrant_transitions;
    state->window_periods = at_step;
}

/* Speed from the short-circuit currents. */
static void measure_short_circuit(monitor_speed_state_t *state, const config_t *config,
                                  const measured_t *now)
{
    state->peak_square_mA2 = larger(state->peak_square_mA2, square_mA2(now));
    state->window_steps++;
    const int32_t turned =
        (int16_t)(uint16_t)(now->report->quadrant_transitions - state->window_quarters);
    if (q_abs(turned) < MONITOR_SPEED_WINDOW_QUARTERS &&
        state->window_steps < MONITOR_SPEED_WINDOW_STEPS) {
        return;
    }
    state->window_mrad_s[1] = state->window_mrad_s[0];
    state->window_mrad_s[0] = window_result_mrad_s(state, config, now, q_abs(turned));
    state->windows = q_min(state->windows + 1, 2);
    begin_window(state, now,
                 q_abs(turned) >= MONITOR_SPEED_WINDOW_QUARTERS ? now->report->quadrant_step
                                                                : now->report->sequence);
}

/* The latest window, unless it is more than an eighth below the one before: then that one. An
 * eighth is two of a window's sixteen transitions. */
static int32_t measured(const monitor_speed_state_t *state)
{
    const int32_t latest_mrad_s = state->window_mrad_s[0];
    const int32_t before_mrad_s = state->window_mrad_s[1];
    if (state->windows < 2 || q_min(latest_mrad_s, before_mrad_s) == MONITOR_SPEED_UNKNOWN) {
        return MONITOR_SPEED_UNKNOWN;
    }
    return latest_mrad_s >= before_mrad_s - before_mrad_s / 8 ? latest_mrad_s : before_mrad_s;
}

static void leave_short(monitor_speed_state_t *state, const measured_t *now)
{
    state->windows = 0;
    begin_window(state, now, now->report->sequence);
}

/* The rectified EMF's current, or the bus beyond its trip: with a bridge that is off, at least the
 * bus is reached. */
static bool emf_shows(monitor_speed_state_t *state, const config_t *config, const measured_t *now)
{
    const bool over = now->bus_voltage_mV > config->battery.overvoltage_trip_mV;
    const bool off = now->report->bridge == BRIDGE_OFF;
    const bool no_sensor_speed =
        !now->angle_valid || q_abs(now->speed_mrad_s) < config->brake.blend_out_end_mrad_s;
    const int32_t qualified = config->monitor.diode_fault_time_ms;
    if (off && no_sensor_speed) {
        const int32_t up = flows(config, now->report->offsets_done, square_mA2(now)) ? 1 : -1;
        state->diode_steps = q_clamp(state->diode_steps + up, 0, qualified);
    } else {
        state->diode_steps = 0;
    }
    const bool first_over = off && no_sensor_speed && over && !state->overvoltage_used;
    state->overvoltage_used = over && (state->overvoltage_used || first_over);
    return first_over || state->diode_steps == qualified;
}

/* w = v / (sqrt(3) psi), mechanical, and 2 % more, so that it is beyond the limit after all
 * roundings. */
static int64_t speed_of_bus_urad_s(const config_t *config, int32_t bus_voltage_mV)
{
    const int64_t w_mrad_s =
        INT64_C(588897275) * bus_voltage_mV / q_divisor(config->motor.flux_linkage_nWb);
    return w_mrad_s * 1000 / q_divisor(config->motor.pole_pairs);
}

/* A speed that halls show until a wheel braked by tyre grip stands inside a sector: below
 * sqrt(7 a s), DERIVATIONS.md, Standstill. With the sector s = 2 pi/(6 p), p w^2 <= 7 a pi/3. */
static bool halls_hold(const config_t *config, int64_t speed_urad_s, int64_t grip_urad_s)
{
    const int64_t size_mrad_s = q_min(q_saturate64(divide_by_thousand(speed_urad_s)), FAST_mrad_s);
    return config->rotor.sensor == CONFIG_ROTOR_HALL &&
           config->motor.pole_pairs * size_mrad_s * size_mrad_s <= SEVEN_SECTORS * grip_urad_s;
}

/* A sensor that falls by the hand-over speed below what tyre grip allows has stopped counting, or
 * its wheel is locked; below the hand-over speed a sensor may fall to zero at once. One that has
 * not moved for long enough is still being acquired, as after a start at speed; one that has was
 * not stopped before. */
static void watch_sensor(monitor_speed_state_t *state, const config_t *config,
                         const measured_t *now, int64_t sensor_urad_s)
{
    const int64_t low_urad_s = INT64_C(1000) * config->brake.blend_out_end_mrad_s;
    const int64_t grip_urad_s = fall_urad_s(config, config->monitor.tyre_grip_mm_s2);
    const bool moves = now->angle_valid && sensor_urad_s > low_urad_s;
    const bool moved = state->moving_steps >= MONITOR_SPEED_MOVING_STEPS;
    state->moving_steps = (uint16_t)(moves ? q_min(state->moving_steps + 1, UINT16_MAX) : 0);
    if (sensor_urad_s >= state->rest_urad_s || state->moving_steps >= MONITOR_SPEED_MOVING_STEPS) {
        state->stopped = false;
    } else if (now->angle_valid && sensor_urad_s < state->rest_urad_s - grip_urad_s - low_urad_s) {
        const bool sudden = moved && state->rest_urad_s > MONITOR_SPEED_SUDDEN * low_urad_s &&
                            !halls_hold(config, state->rest_urad_s, grip_urad_s);
        state->sudden_stops = (uint16_t)(state->sudden_stops + (sudden ? 1 : 0));
        state->stopped = true;
    }
}

/* The bound again, without the trust in a sensor that has stopped. */
static void hold_rest(monitor_speed_state_t *state, const config_t *config, const measured_t *now,
                      int64_t sensor_urad_s)
{
    watch_sensor(state, config, now, sensor_urad_s);
    const bool measuring = measured(state) != MONITOR_SPEED_UNKNOWN;
    const bool too_early = bridge_is_short(now->report->bridge) && state->windows < 2;
    if (measuring || !state->stopped) {
        state->rest_urad_s = state->bound_urad_s;
    } else if (!too_early) {
        state->rest_urad_s =
            larger(state->rest_urad_s - fall_urad_s(config, config->monitor.coasting_mm_s2),
                   state->bound_urad_s);
    }
}

int32_t monitor_speed_step(monitor_speed_state_t *state, const config_t *config,
                           const measured_t *now)
{
    const int64_t sensor_urad_s = INT64_C(1000) * q_abs(now->speed_mrad_s);
    if (bridge_is_short(now->report->bridge)) {
        measure_short_circuit(state, config, now);
    } else {
        leave_short(state, now);
    }
    const int32_t measured_mrad_s = measured(state);
    if (measured_mrad_s != MONITOR_SPEED_UNKNOWN) {
        state->bound_urad_s =
            larger(INT64_C(1000) * measured_mrad_s, now->angle_valid ? sensor_urad_s : 0);
    } else {
        const bool too_early = bridge_is_short(now->report->bridge) && state->windows < 2;
        const int32_t deceleration_mm_s2 =
            now->angle_valid ? config->monitor.tyre_grip_mm_s2 : config->monitor.coasting_mm_s2;
        const int64_t fall = too_early ? 0 : fall_urad_s(config, deceleration_mm_s2);
        state->bound_urad_s = larger(state->bound_urad_s - fall, sensor_urad_s);
    }
    if (emf_shows(state, config, now)) {
        state->bound_urad_s =
            larger(state->bound_urad_s, speed_of_bus_urad_s(config, now->bus_voltage_mV));
    }
    hold_rest(state, config, now, sensor_urad_s);
    return q_saturate64(divide_by_thousand(state->bound_urad_s));
}
