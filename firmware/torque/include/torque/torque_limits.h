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
#include "core/torque_enable.h"
#include "torque/feasible_torque.h"
#include "torque/foldback.h"
#include "torque/limit.h"
#include "torque/loss_braking.h"

/* X(identifier, deferrable: transferred to the hydraulic brake as fast as its torque rises) */
#define TORQUE_LINES(X)                                                                            \
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
    X(ENABLE, false)                                                                               \
    X(LOSS_OPTIMUM, true)                                                                          \
    X(ELECTRIC_RATED, true)                                                                        \
    X(BLEND_OUT, true)                                                                             \
    X(ELECTRIC_SHARE, true)                                                                        \
    X(ABS, false)

#define TORQUE_LINE_ENUM(name, deferrable) TORQUE_LINE_##name,
typedef enum { TORQUE_LINES(TORQUE_LINE_ENUM) TORQUE_LINE_COUNT } torque_line_t;
#undef TORQUE_LINE_ENUM

typedef struct {
    side_t demanded;          /* the other side is solved in turns; SIDE_BOTH: both in every step */
    int32_t brake_demand_mNm; /* magnitude; a parallel brake takes a share of it */
    int32_t bus_voltage_mV;
    int32_t battery_voltage_mV;       /* where it contradicts the bus voltage; 0: it does not */
    int32_t bus_current_mA;           /* of this motor, positive out of the battery */
    int32_t bms_charge_current_mA;    /* whole pack, magnitude; negative counts as 0 */
    int32_t bms_discharge_current_mA; /* whole pack, magnitude */
    int32_t bms_charge_peak_mA;       /* whole pack, for a short time; 0: not given */
    int32_t switch_temperature_cC;
    bool rotor_valid;
    bool abs_active;
    uint8_t abs_share_percent; /* of the demand, for the motor meanwhile */
    torque_enable_t torque_enable;
} torque_limits_input_t;

enum { TORQUE_LIMITS_TURN_steps = 8 };

/* The side without a demand between its two steps of a turn. */
typedef struct {
    uint32_t step; /* of the turn */
    side_t side;   /* of the cap; SIDE_BOTH: none */
    motor_point_t cap;
} torque_limits_turn_t;

typedef struct {
    foldback_state_t charge, discharge;
    torque_limits_turn_t turn;
    int32_t abs_hold_steps; /* remaining slow steps with the bound of the intervention */
    int32_t abs_share_percent;
} torque_limits_state_t;

typedef struct {
    /* Torque in the direction of rotation, or from standstill. */
    limit_t driving[TORQUE_LINE_COUNT];
    /* Torque against the direction of rotation. */
    limit_t braking[TORQUE_LINE_COUNT];
    loss_braking_t losses; /* for the current setpoint */
    int32_t drawn_b;       /* feasible_power_b() of the discharge current */
} torque_limits_t;

/* @post every(i, TORQUE_LINE_COUNT, table->driving[i].torque_mNm == FEASIBLE_UNBOUNDED &&
 * table->braking[i].torque_mNm == FEASIBLE_UNBOUNDED)
 *
 * @post state->charge.allowed_q24 == SCALED_ONE && state->discharge.allowed_q24 == SCALED_ONE
 *
 * @post state->abs_hold_steps == 0 && state->abs_share_percent == 0 && table->drawn_b == 0
 */
void torque_limits_init(torque_limits_state_t *state, torque_limits_t *table);

/* table: from torque_limits_init(); lines that the strategy or the direction does not use stay
 * unbounded. Slow loop, once per step.
 *
 * All lines of the demanded side are of this step. Of the other one, which bounds no torque, the
 * solved ones (PHASE_CURRENT, VOLTAGE, DRAWN, RETURNED) come once in a turn, so that they are up to
 * TORQUE_LIMITS_TURN_steps old; the cap that the latter two begin with, two steps more.
 *
 * @pre is_within(set->model->config->battery.max_voltage_mV -
 * set->model->config->battery.min_voltage_mV, 1, 2000000)
 *
 * @pre is_within(set->model->config->battery.foldback_voltage_mV,
 * set->model->config->battery.min_voltage_mV, set->model->config->battery.max_voltage_mV) &&
 * is_within(set->model->config->battery.discharge_foldback_voltage_mV,
 * set->model->config->battery.min_voltage_mV, set->model->config->battery.max_voltage_mV)
 *
 * @pre is_within(state->abs_share_percent, 0, 100) && state->abs_hold_steps >= 0
 *
 * @pre is_within(state->charge.allowed_q24, 0, SCALED_ONE) &&
 * is_within(state->discharge.allowed_q24, 0, SCALED_ONE)
 *
 * @post is_within(state->charge.allowed_q24, 0, SCALED_ONE) &&
 * is_within(state->discharge.allowed_q24, 0, SCALED_ONE)
 *
 * @pre is_within(set->model->constants->torque_shift, -30, 30) &&
 * is_within(set->model->constants->current_shift, 1, 16)
 *
 * @post is_within(state->abs_share_percent, 0, 100) && state->abs_hold_steps >= 0
 *
 * @pre every(i, TORQUE_LINE_COUNT, table->driving[i].torque_mNm >= 0 &&
 * table->braking[i].torque_mNm >= 0)
 *
 * @post every(i, TORQUE_LINE_COUNT, table->driving[i].torque_mNm >= 0 &&
 * table->braking[i].torque_mNm >= 0)
 *
 * @post table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
 * set->model->config->motor.max_torque_mNm && table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
 * set->model->config->motor.max_torque_mNm
 *
 * @post in->rotor_valid || (table->driving[TORQUE_LINE_ROTOR].torque_mNm == 0 &&
 * table->braking[TORQUE_LINE_ROTOR].torque_mNm == 0)
 *
 * @post in->torque_enable.drive_q15 > 0 || table->driving[TORQUE_LINE_ENABLE].torque_mNm == 0
 *
 * @post in->torque_enable.brake_q15 > 0 || table->braking[TORQUE_LINE_ENABLE].torque_mNm == 0
 *
 * @post !in->abs_active || table->braking[TORQUE_LINE_ABS].torque_mNm <=
 * q_max(in->brake_demand_mNm, 0)
 *
 * @post q_abs(set->model->speed_mrad_s) > set->model->config->brake.blend_out_end_mrad_s ||
 * table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm == 0
 */
void torque_limits_step(torque_limits_state_t *state, const feasible_set_t *set,
                        const torque_limits_input_t *in, torque_limits_t *table);

/* The lines of the braking strategy, LOSS_OPTIMUM to ELECTRIC_SHARE. optimum_mNm: shaft torque that
 * returns the most energy now, below 0 counts as 0; demand_mNm: of both brakes together, >= 0.
 *
 * @pre demand_mNm >= 0 && every(i, TORQUE_LINE_COUNT, line[i].torque_mNm >= 0)
 *
 * @post every(i, TORQUE_LINE_COUNT, line[i].torque_mNm >= 0)
 *
 * @post line[TORQUE_LINE_ABS].torque_mNm == old(line[TORQUE_LINE_ABS].torque_mNm) &&
 * line[TORQUE_LINE_ENABLE].torque_mNm == old(line[TORQUE_LINE_ENABLE].torque_mNm)
 *
 * @post line[TORQUE_LINE_MAX_TORQUE].torque_mNm == old(line[TORQUE_LINE_MAX_TORQUE].torque_mNm) &&
 * line[TORQUE_LINE_ROTOR].torque_mNm == old(line[TORQUE_LINE_ROTOR].torque_mNm)
 *
 * @post config->brake.strategy == CONFIG_STRATEGY_SERIES_OPTIMAL ?
 * line[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm == q_max(optimum_mNm, 0) :
 * line[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm == FEASIBLE_UNBOUNDED
 *
 * @post config->brake.strategy == CONFIG_STRATEGY_PARALLEL_RATIO ?
 * line[TORQUE_LINE_ELECTRIC_SHARE].torque_mNm <= demand_mNm :
 * line[TORQUE_LINE_ELECTRIC_SHARE].torque_mNm == FEASIBLE_UNBOUNDED
 *
 * @post q_abs(speed_mrad_s) > config->brake.blend_out_end_mrad_s ||
 * line[TORQUE_LINE_BLEND_OUT].torque_mNm == 0
 */
void torque_limits_strategy(limit_t line[TORQUE_LINE_COUNT], const config_t *config,
                            int32_t speed_mrad_s, int32_t optimum_mNm, int32_t demand_mNm);

/* The line BLEND_OUT at a speed; without a bound above the blend-out speeds.
 *
 * @post result.torque_mNm >= 0 && result.reason == REASON_BLEND_OUT
 *
 * @post result.torque_mNm <= 20000000 || result.torque_mNm == FEASIBLE_UNBOUNDED
 *
 * @post q_abs(speed_mrad_s) > config->brake.blend_out_end_mrad_s || result.torque_mNm == 0
 *
 * @post q_abs(speed_mrad_s) < q_max(config->brake.blend_out_start_mrad_s,
 * config->brake.blend_out_end_mrad_s + 1) || result.torque_mNm == FEASIBLE_UNBOUNDED
 */
limit_t torque_limits_blend_out(const config_t *config, int32_t speed_mrad_s);

/* The lines of temperatures and, driving, of the highest speed.
 *
 * @pre config->motor.derate_winding_temperature_cC < config->motor.max_winding_temperature_cC
 *
 * @post result.torque_mNm == FEASIBLE_UNBOUNDED || is_within(result.torque_mNm, 0,
 * config->motor.max_torque_mNm)
 *
 * @post temperature_cC < config->motor.max_winding_temperature_cC || result.torque_mNm == 0
 *
 * @post temperature_cC > config->motor.derate_winding_temperature_cC || result.torque_mNm ==
 * FEASIBLE_UNBOUNDED
 *
 * @post result.reason == REASON_WINDING_TEMPERATURE
 */
limit_t torque_limits_winding(const config_t *config, int32_t temperature_cC);

/* @pre config->drive.derate_switch_temperature_cC <= config->drive.max_switch_temperature_cC
 *
 * @post result.torque_mNm == FEASIBLE_UNBOUNDED || is_within(result.torque_mNm, 0,
 * config->motor.max_torque_mNm)
 *
 * @post temperature_cC <= config->drive.max_switch_temperature_cC || result.torque_mNm == 0
 *
 * @post temperature_cC > config->drive.derate_switch_temperature_cC || result.torque_mNm ==
 * FEASIBLE_UNBOUNDED
 *
 * @post result.reason == REASON_SWITCH_TEMPERATURE
 */
limit_t torque_limits_switch(const config_t *config, int32_t temperature_cC);

/* @post result.torque_mNm == FEASIBLE_UNBOUNDED || is_within(result.torque_mNm, 0,
 * config->motor.max_torque_mNm)
 *
 * @post q_abs(speed_mrad_s) <= config->motor.max_speed_mrad_s || result.torque_mNm == 0
 *
 * @post result.reason == REASON_MAX_SPEED
 */
limit_t torque_limits_max_speed(const config_t *config, int32_t speed_mrad_s);

/* The line ABS: while the anti-lock system intervenes and for brake.abs_hold_ms afterwards, the
 * share of in->brake_demand_mNm that it leaves to the motor, in the end its last one. Slow loop,
 * once per step.
 *
 * @pre is_within(state->abs_share_percent, 0, 100) && state->abs_hold_steps >= 0
 *
 * @post is_within(state->abs_share_percent, 0, 100) && state->abs_hold_steps >= 0
 *
 * @post state->charge.allowed_q24 == old(state->charge.allowed_q24) &&
 * state->discharge.allowed_q24 == old(state->discharge.allowed_q24)
 *
 * @post result.torque_mNm >= 0 && result.reason == REASON_ABS
 *
 * @post !in->abs_active || result.torque_mNm <= q_max(in->brake_demand_mNm, 0)
 *
 * @post in->abs_active || state->abs_hold_steps > 0 || result.torque_mNm == FEASIBLE_UNBOUNDED
 *
 * @post in->abs_active ? state->abs_hold_steps == config->brake.abs_hold_ms :
 * state->abs_hold_steps <= old(state->abs_hold_steps)
 */
limit_t torque_limits_anti_lock(torque_limits_state_t *state, const config_t *config,
                                const torque_limits_input_t *in);

/* The tightest of the lines from `begin` to the one before `end`; on a tie the first.
 *
 * @pre begin == 0 && (end == TORQUE_LINE_LOSS_OPTIMUM || end == TORQUE_LINE_COUNT)
 *
 * @post every(i, TORQUE_LINE_COUNT, i >= (int)end || result.torque_mNm <= lines[i].torque_mNm)
 *
 * @post some(i, TORQUE_LINE_COUNT, i < (int)end && result.torque_mNm == lines[i].torque_mNm &&
 * result.reason == lines[i].reason)
 */
limit_t torque_limits_tightest(const limit_t *lines, torque_line_t begin, torque_line_t end);

/* The first line with a bound of at most torque_mNm, which one of them must have.
 *
 * @pre some(i, TORQUE_LINE_COUNT, lines[i].torque_mNm <= torque_mNm)
 *
 * @post result.torque_mNm <= torque_mNm
 *
 * @post each(i, TORQUE_LINE_COUNT, !is_first_at_most(lines, i, torque_mNm) || (result.torque_mNm ==
 * lines[i].torque_mNm && result.reason == lines[i].reason))
 */
limit_t torque_limits_at_most(const limit_t *lines, int32_t torque_mNm);

/* Tightest bounds of the braking side by class, mN m. */
typedef struct {
    int32_t hard_mNm;       /* applies at once */
    int32_t deferrable_mNm; /* handed over, without ELECTRIC_SHARE, which follows the demand */
} torque_limits_classes_t;

/* @post every(i, TORQUE_LINE_LOSS_OPTIMUM, result.hard_mNm <= braking[i].torque_mNm ||
 * result.deferrable_mNm <= braking[i].torque_mNm)
 *
 * @post result.hard_mNm <= braking[TORQUE_LINE_ENABLE].torque_mNm && result.hard_mNm <=
 * braking[TORQUE_LINE_ABS].torque_mNm && result.hard_mNm <=
 * braking[TORQUE_LINE_PHASE_CURRENT].torque_mNm && result.hard_mNm <=
 * braking[TORQUE_LINE_VOLTAGE].torque_mNm
 *
 * @post result.deferrable_mNm <= braking[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm &&
 * result.deferrable_mNm <= braking[TORQUE_LINE_RETURNED].torque_mNm && result.deferrable_mNm <=
 * braking[TORQUE_LINE_BLEND_OUT].torque_mNm
 *
 * @post some(i, TORQUE_LINE_COUNT, i != TORQUE_LINE_ELECTRIC_SHARE && braking[i].torque_mNm <=
 * q_min(result.hard_mNm, result.deferrable_mNm))
 *
 * @post !every(i, TORQUE_LINE_COUNT, braking[i].torque_mNm >= 0) || (result.hard_mNm >= 0 &&
 * result.deferrable_mNm >= 0)
 */
torque_limits_classes_t torque_limits_classes(const limit_t braking[TORQUE_LINE_COUNT]);

/* The same without the lines of the strategy, for a motor that makes up for a hydraulic brake.
 *
 * @post every(i, TORQUE_LINE_LOSS_OPTIMUM, result.hard_mNm <= braking[i].torque_mNm ||
 * result.deferrable_mNm <= braking[i].torque_mNm)
 *
 * @post result.hard_mNm <= braking[TORQUE_LINE_ENABLE].torque_mNm && result.hard_mNm <=
 * braking[TORQUE_LINE_ABS].torque_mNm && result.hard_mNm <=
 * braking[TORQUE_LINE_PHASE_CURRENT].torque_mNm && result.hard_mNm <=
 * braking[TORQUE_LINE_VOLTAGE].torque_mNm
 *
 * @post !every(i, TORQUE_LINE_COUNT, braking[i].torque_mNm >= 0) || (result.hard_mNm >= 0 &&
 * result.deferrable_mNm >= 0)
 */
torque_limits_classes_t torque_limits_beyond_strategy(const limit_t braking[TORQUE_LINE_COUNT]);

/* The line of the tightest bound; on a tie the first. For display of the table.
 *
 * @post is_within((int)result, 0, TORQUE_LINE_COUNT - 1)
 *
 * @post is_first_of_the_tightest(lines, TORQUE_LINE_COUNT, result)
 */
torque_line_t torque_limits_tightest_line(const limit_t lines[TORQUE_LINE_COUNT]);

/* "MAX_TORQUE" and so on; "unknown line" for a number not in the list. Never NULL.
 *
 * @pre (int)line >= 0
 *
 * @post result != 0 && (line < TORQUE_LINE_COUNT) == (result[0] != 'u')
 */
const char *torque_limits_line_text(torque_line_t line);

/* True if the motor torque above this line falls only as fast as the hydraulic brake replaces it;
 * false if it falls at once.
 *
 * @pre (int)line >= 0
 *
 * @post line < TORQUE_LINE_COUNT || !result
 *
 * @post !result || (line != TORQUE_LINE_PHASE_CURRENT && line != TORQUE_LINE_VOLTAGE && line !=
 * TORQUE_LINE_ENABLE && line != TORQUE_LINE_ABS)
 */
bool torque_limits_deferrable(torque_line_t line);

#endif
