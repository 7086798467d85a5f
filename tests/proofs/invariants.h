/* SPDX-License-Identifier: Apache-2.0 */
/*
 * invariants.h: what holds of a state between two steps, where a contract needs it more than once:
 * a precondition and a postcondition of the step, and a postcondition of its init(). And the
 * relations between fields of a configuration that such a step needs (validate.c).
 */
#ifndef INVARIANTS_H
#define INVARIANTS_H

#include "contract.h"

#define battery_relations_hold(c)                                                                  \
    (is_within((c)->battery.max_voltage_mV - (c)->battery.min_voltage_mV, 1, 2000000) &&           \
     is_within((c)->battery.foldback_voltage_mV, (c)->battery.min_voltage_mV,                      \
               (c)->battery.max_voltage_mV) &&                                                     \
     is_within((c)->battery.discharge_foldback_voltage_mV, (c)->battery.min_voltage_mV,            \
               (c)->battery.max_voltage_mV))

#define derating_relations_hold(c)                                                                 \
    ((c)->motor.derate_winding_temperature_cC < (c)->motor.max_winding_temperature_cC &&           \
     (c)->drive.derate_switch_temperature_cC <= (c)->drive.max_switch_temperature_cC)

/* Shifts of what motor_constants_init() makes of any configuration. */
#define current_shift_holds(k) is_within((k)->current_shift, 1, 16)
#define model_shifts_hold(k)                                                                       \
    (is_within((k)->torque_shift, -30, 30) && current_shift_holds(k) &&                            \
     is_within((k)->flux_unit_shift, 1, 62) && is_within((k)->inductance_unit_shift, 1, 62))
#define motor_constants_hold(k)                                                                    \
    (model_shifts_hold(k) && is_within((k)->current_most_b, 0, MOTOR_MODEL_MOST_CURRENT_b) &&      \
     is_within((k)->weakening_most_b, 0, MOTOR_MODEL_MOST_CURRENT_b) &&                            \
     (k)->coulomb_step_q8_b >= 0 && (k)->viscous_b >= 0 &&                                         \
     is_within((k)->torque_factor_q24, 0, 2 * SCALED_ONE))

/* What motor_model_around() makes of them at any currents. */
#define motor_model_holds(m)                                                                       \
    (is_within((m)->friction_b, 0, 1 << 26) && is_within((m)->flux_b, 4, 1 << 26))

#define point_holds(at)                                                                            \
    (is_within((at).d_b, -MOTOR_MODEL_MOST_CURRENT_b, MOTOR_MODEL_MOST_CURRENT_b) &&               \
     is_within((at).x_b, -MOTOR_MODEL_MOST_CURRENT_b, MOTOR_MODEL_MOST_CURRENT_b))

#define is_a_sign(x) ((x) == 1 || (x) == -1)

/* A current vector per unit. */
#define vector_holds(i) (is_within((i).d, -32768, 32767) && is_within((i).q, -32768, 32767))

/* A line of the table: without a bound, or at most the motor's largest torque. */
#define is_unbounded_or_permitted(line, c)                                                         \
    ((line).torque_mNm == FEASIBLE_UNBOUNDED ||                                                    \
     is_within((line).torque_mNm, 0, (c)->motor.max_torque_mNm))

#define anti_lock_holds(s) (is_within((s)->abs_share_percent, 0, 100) && (s)->abs_hold_steps >= 0)

/* A limit that rises slowly. */
#define slow_rise_holds(s)                                                                         \
    ((s)->value >= 0 && is_within((s)->time_log2, SLOW_RISE_FIRST_LOG2, SLOW_RISE_LAST_LOG2))

#define battery_rises_hold(s)                                                                      \
    (slow_rise_holds(&(s)->charge_rise) && slow_rise_holds(&(s)->discharge_rise))

#define table_holds(t)                                                                             \
    (is_within((t)->current_missing_q15, 0, 16384) &&                                              \
     is_within((t)->winding_hotter_cC, -69400, 69400) && (t)->winding_lasting_mA >= 0 &&           \
     (t)->switch_lasting_mA >= 0 &&                                                                \
     every(i, TORQUE_LINE_COUNT,                                                                   \
           (t)->driving[i].torque_mNm >= 0 && (t)->braking[i].torque_mNm >= 0))

#define lines_hold(lines) every(i, TORQUE_LINE_COUNT, (lines)[i].torque_mNm >= 0)

/* None of the first n lines is tighter than this one, and each before it is wider. */
#define is_first_of_the_tightest(lines, n, line)                                                   \
    each(i, TORQUE_LINE_COUNT,                                                                     \
         i >= (int)(n) || (i < (int)(line) ? (lines)[i].torque_mNm > (lines)[line].torque_mNm      \
                                           : (lines)[i].torque_mNm >= (lines)[line].torque_mNm))

/* The first of the lines with a bound of at most a torque. */
#define is_first_at_most(lines, line, most_mNm)                                                    \
    (is_within(line, 0, TORQUE_LINE_COUNT - 1) && (lines)[line].torque_mNm <= (most_mNm) &&        \
     every(k, TORQUE_LINE_COUNT, k >= (line) || (lines)[k].torque_mNm > (most_mNm)))

#define ahead_holds(s)                                                                             \
    (table_holds(&(s)->table) && (s)->now.driving.torque_mNm >= 0 &&                               \
     (s)->now.braking.torque_mNm >= 0 && (s)->ahead.driving.torque_mNm >= 0 &&                     \
     (s)->ahead.braking.torque_mNm >= 0)

/* A low-pass of values below 2^23, and a magnitude. */
#define road_holds(s)                                                                              \
    (is_within((s)->torque_mNm, 1 - (1 << 23), (1 << 23) - 1) && (s)->shown_mrad_s >= 0 &&         \
     (s)->inertia_g_m2 >= 0 && is_within((s)->since_ms, 0, 1023) &&                                \
     is_within((s)->known_mNm_ms, -INT64_C(8388607) * (s)->since_ms,                               \
               INT64_C(8388607) * (s)->since_ms))

/* Of currents up to 2 kA. */
#define charge_trim_holds(s)                                                                       \
    (is_within((s)->most_mA, 0, 2000000) && is_within((s)->commanded_mA, -2000000, 2000000) &&     \
     is_within((s)->terminals_q8_mA, -(1 << 29), 1 << 29) &&                                       \
     is_within((s)->own.accumulator, -(1 << 23), 1 << 23) &&                                       \
     is_within((s)->pack.accumulator, 0, 1 << 28) &&                                               \
     is_within((s)->message_mA, -(1 << 23), 1 << 23) && (s)->speed_abs_mrad_s >= 0 &&              \
     is_within((s)->hold_ms, 0, CHARGE_TRIM_MESSAGE_ms))

#define torque_state_holds(s, c)                                                                   \
    (motor_constants_hold(&(s)->motor) && is_within((s)->demand.lift_off_mNm, 0, 100000000) &&     \
     is_within((s)->demand.brake_torque_mNm, 0, 100000000) &&                                      \
     is_within((s)->demand.received_brake_torque_mNm, 0, 100000000) && (s)->demand.lost_ms >= 0 && \
     anti_lock_holds(&(s)->limits) && is_within((s)->limits.charge.allowed_q24, 0, SCALED_ONE) &&  \
     is_within((s)->limits.discharge.allowed_q24, 0, SCALED_ONE) && table_holds(&(s)->table) &&    \
     battery_rises_hold(&(s)->limits) && road_holds(&(s)->road) &&                                 \
     charge_trim_holds(&(s)->trim) &&                                                              \
     is_within((s)->hold.torque_mNm, 0, (c)->driver.hold_torque_mNm) &&                            \
     is_within((s)->hold.release_ms, 0, (c)->driver.hold_release_ms) &&                            \
     is_within((s)->hold.rolls_ms, 0, HILL_HOLD_CAUGHT_ms) && (s)->hold.begun_mrad_s >= 0 &&       \
     (s)->lamp.speed_lp_q8_mrad_s >= 0 &&                                                          \
     is_within((s)->lamp.decel_lp_mm_s2.accumulator, -(1 << 30), 1 << 30) &&                       \
     is_within((s)->blending.hydraulic.next, 0, HYDRAULIC_MODEL_COMMANDS - 1) &&                   \
     is_within((s)->blending.feedback.between_ms, 1, HYDRAULIC_FEEDBACK_PAST_ms) &&                \
     ahead_holds(&(s)->ahead))

/* Values that grid_interpolate() takes. */
#define grid_values_hold(a, b)                                                                     \
    (is_within(a, 1 - (1 << 30), (1 << 30) - 1) && is_within(b, 1 - (1 << 30), (1 << 30) - 1))

/* Entries of a map that the validator accepts, and weights of four of them. */
#define MAP_ENTRY_MOST(name, count, lowest, highest, ...) (highest)
#define CURRENT_MAP_MOST_lsb (CONFIG_CURRENT_MAP_ARRAY(MAP_ENTRY_MOST))
#define entry_holds(x_lsb) is_within(x_lsb, -CURRENT_MAP_MOST_lsb, CURRENT_MAP_MOST_lsb)
#define grid_entries_hold(a, b, c, d)                                                              \
    (entry_holds(a) && entry_holds(b) && entry_holds(c) && entry_holds(d))
#define grid_lsb(w) (1 << (15 - (w).shift))
#define grid_weights_hold(w)                                                                       \
    (is_within((w).at_00, 0, 1 << 16) && is_within((w).at_10, 0, 1 << 16) &&                       \
     is_within((w).at_01, 0, 1 << 16) && is_within((w).at_11, 0, 1 << 16) &&                       \
     (w).at_00 + (w).at_10 + (w).at_01 + (w).at_11 == 1 << 16 && is_within((w).shift, 0, 15))

/* What loss_maps_row_at() makes: a row and the next one of the current map. */
enum { MOST_ROW_POINTS = 65 };
#define row_fits(row)                                                                              \
    (is_within((row).points, 3, MOST_ROW_POINTS) && (row).points % 2 == 1 &&                       \
     is_within((row).step_log2, 0, 20) &&                                                          \
     (row).zero_mNm == (row).points / 2 * (int32_t)(UINT32_C(1) << (row).step_log2))

#define vectors_hold(a, b)                                                                         \
    (is_within((a).d, -65536, 65536) && is_within((a).q, -65536, 65536) &&                         \
     is_within((b).d, -65536, 65536) && is_within((b).q, -65536, 65536))

#define window_bounds_hold(w)                                                                      \
    every(i, 2,                                                                                    \
          is_within((w)->lowest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST) &&                  \
              is_within((w)->highest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST))
#define window_counts_hold(w)                                                                      \
    ((w)->steps <= MONITOR_WINDOW_STEPS && (w)->level <= MONITOR_WINDOW_QUALIFY_STEPS)
#define monitor_window_holds(w) (window_bounds_hold(w) && window_counts_hold(w))

/* A window of the longest filter. */
#define MONITOR_GAIN_MOST_STEPS (MONITOR_GAIN_WINDOW * (10000 + MONITOR_GAIN_MESSAGE_ms))
#define monitor_gain_holds(s)                                                                      \
    (is_within((s)->steps, 0, MONITOR_GAIN_MOST_STEPS) &&                                          \
     is_within((s)->missing_q15, 0, MONITOR_GAIN_MOST_MISSING_Q15) &&                              \
     ((s)->wrong || (s)->missing_q15 == 0))

/* Qualify times, and what is left until PROGRAM_FLOW, of the fast monitor. */
#define fast_times_hold(s)                                                                         \
    ((s)->trip_periods > 0 && (s)->dead_periods > 0 && (s)->dead_periods <= INT16_MAX)
#define periods_left_hold(s)                                                                       \
    ((s)->periods_left >= 0 && (s)->periods_left <= (s)->stale_limit_periods)

#define monitor_emf_holds(s, c)                                                                    \
    ((s)->level <= MONITOR_EMF_SEEN * (c)->monitor.angle_fault_time_ms &&                          \
     is_within((s)->flux_level, -MONITOR_EMF_FLUX_STEPS, MONITOR_EMF_FLUX_STEPS) &&                \
     is_within((s)->missing_q20, 0, 1 << 19))

#define monitor_speed_holds(s, c)                                                                  \
    (is_within((s)->windows, 0, 2) &&                                                              \
     is_within((s)->diode_steps, 0, (c)->monitor.diode_fault_time_ms) && (s)->bound_urad_s >= 0 && \
     (s)->rest_urad_s >= (s)->bound_urad_s)

#define monitor_open_holds(s)                                                                      \
    every(i, 3,                                                                                    \
          is_within((s)->missing[i][0], 0, MONITOR_OPEN_STEPS) &&                                  \
              is_within((s)->missing[i][1], 0, MONITOR_OPEN_STEPS) &&                              \
              is_within((s)->zeros[i], 0, MONITOR_OPEN_STEPS) &&                                   \
              is_within((s)->turned[i], 0, MONITOR_OPEN_TURN))

#define monitor_stuck_holds(s)                                                                     \
    (((s)->side == BRIDGE_OFF || bridge_is_short((s)->side)) &&                                    \
     is_within((s)->steps, 0, MONITOR_STUCK_STEPS - 1) &&                                          \
     is_within((s)->good_steps, 0, (s)->steps) && is_within((s)->turned_mrad, -6283, 6283) &&      \
     is_within((s)->same_steps, 0, MONITOR_STUCK_LONGEST_STEPS) &&                                 \
     is_within((s)->release_steps, 0, MONITOR_STUCK_RELEASE_STEPS) && (s)->windows >= 0)

#define monitor_state_holds(s, c)                                                                  \
    (monitor_emf_holds(&(s)->emf, c) &&                                                            \
     is_within((s)->current.missing_pu, 0, (c)->monitor.current_missing_pu_q15) &&                 \
     monitor_window_holds(&(s)->contradiction) && monitor_gain_holds(&(s)->gain) &&                \
     monitor_stuck_holds(&(s)->stuck) && monitor_open_holds(&(s)->open) &&                         \
     monitor_speed_holds(&(s)->speed, c) && (s)->swing.swing_mV >= 0)

#define lumps_hold(row)                                                                            \
    (is_within((row)->inner_q16, -32700 * 65536, 32700 * 65536) &&                                 \
     is_within((row)->outer_q16, -32700 * 65536, 32700 * 65536) &&                                 \
     is_within((row)->ambient_q16, -32700 * 65536, 32700 * 65536) &&                               \
     is_within((row)->steady_mW_cK_q16, 0, 1 << 30) &&                                             \
     is_within((row)->outer_share_q15, 0, 1 << 30))

#define thermal_model_holds(s)                                                                     \
    (lumps_hold(&(s)->winding) && lumps_hold(&(s)->switches) &&                                    \
     (s)->steps < THERMAL_MODEL_STEP_MS && is_within((s)->square_per_mW, 0, 1 << 30) &&            \
     (s)->winding_lasting_mA >= 0 && (s)->switch_lasting_mA >= 0 && (s)->iron_mW >= 0)

#define temperature_offset_holds(offset_q16)                                                       \
    is_within(offset_q16, TEMPERATURES_COLDER_cC * 65536, TEMPERATURES_HOTTER_cC * 65536)

#define temperatures_hold(s)                                                                       \
    (thermal_model_holds(&(s)->model) && temperature_offset_holds((s)->winding_offset_q16) &&      \
     temperature_offset_holds((s)->switch_offset_q16))

/* findings.h: times of at least one step, those of checks with a filter of their own one; a row is
 * present as long as its debounce says; what is present is active. */
#define findings_bit_set(f, row)                                                                   \
    (((f)->present[(unsigned)(row) / 32U] >> ((unsigned)(row) % 32U) & 1U) != 0U)
#define finding_at_once(times, row)                                                                \
    ((times)[row].qualify_steps == 1U && (times)[row].heal_steps == 1U)
#define finding_times_hold(times)                                                                  \
    (every(i, FINDING_COUNT, (times)[i].qualify_steps >= 1U && (times)[i].heal_steps >= 1U) &&     \
     finding_at_once(times, FINDING_TRIP) && finding_at_once(times, FINDING_TRIP_PHASE_OPEN) &&    \
     finding_at_once(times, FINDING_BUS_JUMPED) && finding_at_once(times, FINDING_BATTERY_LEFT) && \
     finding_at_once(times, FINDING_BATTERY_UNKNOWN) &&                                            \
     finding_at_once(times, FINDING_CONFIGURATION) && finding_at_once(times, FINDING_FLUX_LOW) &&  \
     finding_at_once(times, FINDING_GAIN))
#define findings_hold(f)                                                                           \
    (finding_times_hold((f)->times) &&                                                             \
     every(i, FINDING_COUNT,                                                                       \
           findings_bit_set(f, i) == ((f)->debounce[i].left > 0U) &&                               \
               (f)->debounce[i].left <= ((f)->returns[i].heal_steps > (f)->times[i].heal_steps     \
                                             ? (f)->returns[i].heal_steps                          \
                                             : (f)->times[i].heal_steps)) &&                       \
     every(i, (int)FINDING_BUS_JUMPED, (f)->returns[i].heal_steps == 0U) &&                        \
     (!findings_bit_set(f, FINDING_TRIP) || (f)->trip != REASON_NONE) &&                           \
     ((f)->present[0] & ~(f)->active[0]) == 0U && ((f)->present[1] & ~(f)->active[1]) == 0U)
/* Of the first 32 rows those that modes sets. */
#define ROWS_OF_MODES                                                                              \
    (findings_bit(FINDING_STATE_DAMAGED) | findings_bit(FINDING_CONFIGURATION) |                   \
     findings_bit(FINDING_SELFTEST) | findings_bit(FINDING_OFFSETS_WRONG))
#define battery_is_lost(f)                                                                         \
    (findings_bit_set(f, FINDING_BUS_JUMPED) || findings_bit_set(f, FINDING_BATTERY_LEFT) ||       \
     findings_bit_set(f, FINDING_BATTERY_UNKNOWN))

#define measure_holds(m, c)                                                                        \
    (temperatures_hold(&(m)->temperatures) &&                                                      \
     is_within((m)->angle.agreed_steps, 0, (c)->monitor.rotor_warning_time_ms))

/* Of copies: the checker takes long to follow pointers to members of a large object. */
#define controller_slow_holds(s, c)                                                                \
    ({                                                                                             \
        const torque_state_t torque_copy = (s)->torque;                                            \
        const monitor_state_t monitor_copy = (s)->monitor;                                         \
        const measure_t measure_copy = (s)->measure;                                               \
        const findings_t findings_copy = (s)->findings;                                            \
        torque_state_holds(&torque_copy, c) && monitor_state_holds(&monitor_copy, c) &&            \
            measure_holds(&measure_copy, c) && findings_hold(&findings_copy) &&                    \
            (unsigned)(s)->modes.mode <= MODE_FAULT &&slow_rise_holds(&(s)->modes.braking) &&      \
            ((s)->modes.mode != MODE_FAULT || (s)->modes.fault != REASON_NONE) &&                  \
            is_within((s)->last.torque_command_mNm, -400000000, 400000000) &&                      \
            (s)->last.hydraulic_added_mNm >= 0 && (s)->last.hydraulic_apart_mNm >= 0 &&            \
            vector_holds((s)->last.reference_pu) &&                                                \
            is_within((s)->last.current_missing_q15, 0, MONITOR_GAIN_MOST_MISSING_Q15) &&          \
            is_within((s)->last.temperature.winding_cC, -34700, 34700);                            \
    })

#endif
