/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_limits.h: every limit of the motor torque, as one line each of one ordered table. 1 kHz.
 *
 * A line is a bound in mN m at the shaft, for driving and for braking, with its reason. Lines are
 * independent of each other; the tightest applies, on a tie the earlier one, and its reason is the
 * one shown. Shares (derating, speed, torque enable) are of motor.max_torque. The table: README,
 * Torque limits.
 */
#ifndef TORQUE_TORQUE_LIMITS_H
#define TORQUE_TORQUE_LIMITS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/measured.h"
#include "core/slow_rise.h"
#include "core/torque_enable.h"
#include "motor/feasible_torque.h"
#include "motor/loss_braking.h"
#include "torque/foldback.h"
#include "torque/limit.h"

/* X(identifier, deferrable: transferred to the hydraulic brake as fast as its torque rises) */
#define TORQUE_LINES(X)                                                                            \
    X(ENABLE, false)                                                                               \
    X(MAX_TORQUE, false)                                                                           \
    X(MAX_POWER, false)                                                                            \
    X(PHASE_CURRENT, false)                                                                        \
    X(VOLTAGE, false)                                                                              \
    X(DRAWN, true)                                                                                 \
    X(RETURNED, true)                                                                              \
    X(RETURNED_PEAK, false)                                                                        \
    X(MAX_SPEED, true)                                                                             \
    X(WINDING, true)                                                                               \
    X(SWITCH, true)                                                                                \
    X(ROTOR, false)                                                                                \
    X(CURRENT_GAIN, true)                                                                          \
    X(LOSS_OPTIMUM, true)                                                                          \
    X(ELECTRIC_RATED, true)                                                                        \
    X(BLEND_OUT, true)                                                                             \
    X(ELECTRIC_SHARE, true)                                                                        \
    X(ABS, false)

#define TORQUE_LINE_ENUM(name, deferrable) TORQUE_LINE_##name,
typedef enum { TORQUE_LINES(TORQUE_LINE_ENUM) TORQUE_LINE_COUNT } torque_line_t;
#undef TORQUE_LINE_ENUM

typedef struct {
    int32_t brake_torque_mNm;    /* demanded, magnitude; a parallel brake takes a share of it */
    int32_t battery_voltage_mV;  /* where it contradicts the bus voltage: each limit takes the more
                                    dangerous of both; 0: it does not */
    int32_t charge_beyond_mA;    /* charge_trim.h: by how much this motor charges the
                                    battery beyond its model */
    int32_t current_missing_q15; /* share of the current that its sensors do not show, below
                                    32 768; the line CURRENT_GAIN */
} torque_limits_input_t;

typedef struct {
    foldback_state_t charge, discharge;
    slow_rise_t charge_rise, discharge_rise; /* of the management's limits for this motor, mA */
    int32_t abs_hold_steps; /* remaining slow steps with the bound of the intervention */
    int32_t abs_share_percent;
} torque_limits_state_t;

/* Currents of bounds, terminal, i_q along the rotation: a motor with a flux map is solved around
 * those of the step before. Those of a power that bounds nothing are the end's. */
typedef struct {
    motor_current_t end; /* of the tightest of voltage, phase current, largest torque and power */
    motor_current_t drawn;
} torque_limits_side_currents_t;

typedef struct {
    torque_limits_side_currents_t driving, braking;
    motor_current_t returned, peak;
    motor_current_t losses; /* of loss braking on the current circle */
} torque_limits_currents_t;

typedef struct {
    /* Torque in the direction of rotation, or from standstill. */
    limit_t driving[TORQUE_LINE_COUNT];
    /* Torque against the direction of rotation. */
    limit_t braking[TORQUE_LINE_COUNT];
    loss_braking_t losses;                         /* for the current setpoint */
    int32_t drawn_b;                               /* feasible_power_b() of the discharge current */
    int32_t winding_lasting_mA, switch_lasting_mA; /* measured_t; the lines WINDING and SWITCH fall
                                                      no lower than their torque, braking, while
                                                      only an estimate is hot */
    wheel_temperatures_t sensed;                   /* measured_t */
    int32_t winding_hotter_cC;                     /* measured_t */
    int32_t current_missing_q15;                   /* torque_limits_input_t */
    int32_t optimum_mNm;                           /* braking torque that returns the most energy */
    torque_limits_currents_t at;                   /* read in the next step */
} torque_limits_t;

/* No bounds, whole battery currents. */
void torque_limits_init(torque_limits_state_t *state, torque_limits_t *table);

/* A table without bounds. */
void torque_limits_clear(torque_limits_t *table);

/* Slow loop, once per step. now: bus voltage (clamped to 0 .. twice the over-voltage trip),
 * temperatures and the battery's limits, of any value. table: from torque_limits_init(); all lines
 * of both sides are of this step. All bounds are >= 0, lines that the strategy or the direction
 * does not use stay FEASIBLE_UNBOUNDED. model: that of the set; with a flux map both are exact
 * at other currents afterwards. */
void torque_limits_step(torque_limits_state_t *state, motor_model_t *model, feasible_set_t *set,
                        const measured_t *now, const torque_enable_t *enable,
                        const torque_limits_input_t *in, torque_limits_t *table);

/* ---- the table as a function ----
 * Its parts in the order of a step, for this step and for a later one (available_ahead.h): of the
 * motor at a speed, winding temperature and voltage, and of what the table holds: of a battery
 * drawn_b, losses.returned, and the reasons of DRAWN and RETURNED; lasting currents, temperatures,
 * current_missing_q15. */

/* MAX_POWER, MAX_SPEED, WINDING, SWITCH and the lines of the strategy; the current of the losses.
 */
void torque_limits_plain(torque_limits_t *table, const motor_model_t *model,
                         int32_t switch_temperature_cC, int32_t brake_torque_mNm);

/* PHASE_CURRENT and VOLTAGE of a side, up to MAX_TORQUE and MAX_POWER. circle: one for both sides
 * of a set. Returns the side up to the tightest of the four. */
feasible_side_t torque_limits_ends(torque_limits_t *table, motor_model_t *model,
                                   feasible_set_t *set, side_t sign, feasible_circle_t *circle);

/* DRAWN of a side of torque_limits_ends(). cap: its feasible_cap_power() with the set as it is. */
void torque_limits_drawn(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                         const feasible_side_t *side, const feasible_cap_power_t *cap);

/* RETURNED of its braking side, and RETURNED_PEAK like it. */
void torque_limits_returned(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                            const feasible_side_t *side, const feasible_cap_power_t *cap);

/* The lines of the braking strategy, LOSS_OPTIMUM to ELECTRIC_SHARE. optimum_mNm: shaft torque that
 * returns the most energy now, below 0 counts as 0; brake_torque_mNm: of both brakes together, >=
 * 0. */
void torque_limits_strategy(limit_t line[TORQUE_LINE_COUNT], const config_t *config,
                            int32_t speed_mrad_s, int32_t optimum_mNm, int32_t brake_torque_mNm);

/* The line BLEND_OUT at a mechanical speed, signed; zero up to brake.blend_out_end, without a bound
 * from brake.blend_out_start on. */
limit_t torque_limits_blend_out(const config_t *config, int32_t speed_mrad_s);

/* The lines of temperatures and, driving, of the highest speed: without a bound up to the begin of
 * the derating, zero from its end on. */
limit_t torque_limits_winding(const config_t *config, int32_t temperature_cC);

limit_t torque_limits_switch(const config_t *config, int32_t temperature_cC);

/* The same line braking. least_mNm: what the lasting current makes. */
limit_t torque_limits_braking_hot(limit_t driving, int32_t least_mNm);

limit_t torque_limits_max_speed(const config_t *config, int32_t speed_mrad_s);

/* The line ABS: while the anti-lock system intervenes and for brake.abs_hold_ms afterwards, the
 * share of the demanded brake torque that it leaves to the motor, in the end its last one. Slow
 * loop, once per step. */
limit_t torque_limits_anti_lock(torque_limits_state_t *state, const config_t *config,
                                const wheel_demand_t *wheel, int32_t brake_torque_mNm);

/* The tightest of the lines from `begin` to the one before `end`; on a tie the first. */
limit_t torque_limits_tightest(const limit_t *lines, torque_line_t begin, torque_line_t end);

/* The first line with a bound of at most torque_mNm, which one of them must have. */
limit_t torque_limits_at_most(const limit_t *lines, int32_t torque_mNm);

/* Tightest bounds of the braking side by class, mN m. */
typedef struct {
    int32_t hard_mNm;       /* applies at once */
    int32_t deferrable_mNm; /* handed over, without ELECTRIC_SHARE, which follows the demand */
} torque_limits_classes_t;

torque_limits_classes_t torque_limits_classes(const limit_t braking[TORQUE_LINE_COUNT]);

/* The line of the tightest bound; on a tie the first. For display of the table. */
torque_line_t torque_limits_tightest_line(const limit_t lines[TORQUE_LINE_COUNT]);

/* "MAX_TORQUE" and so on; "unknown line" for a number not in the list. Never NULL. */
const char *torque_limits_line_text(torque_line_t line);

/* True if the motor torque above this line falls only as fast as the hydraulic brake replaces it;
 * false if it falls at once. */
bool torque_limits_deferrable(torque_line_t line);

#endif
