/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/torque_limits.h"

#include <stddef.h>

#include "config/pack_share.h"
#include "core/fade.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "motor/flux_map.h"
#include "motor/loss_maps.h"
#include "motor/observer_error.h"

enum { WHOLE_PERCENT = 100 };

void torque_limits_init(torque_limits_state_t *state, torque_limits_t *table)
{
    const torque_limits_state_t fresh = {.charge = {.allowed_q24 = SCALED_ONE},
                                         .discharge = {.allowed_q24 = SCALED_ONE},
                                         .charge_rise = slow_rise_init(),
                                         .discharge_rise = slow_rise_init(),
                                         .abs_hold_steps = 0};
    *state = fresh;
    torque_limits_clear(table);
}

void torque_limits_clear(torque_limits_t *table)
{
    const loss_braking_t no_losses = {.by_map_mNm = FEASIBLE_UNBOUNDED};
    table->losses = no_losses;
    table->drawn_b = 0;
    table->winding_lasting_mA = 0;
    table->switch_lasting_mA = 0;
    const wheel_temperatures_t unknown = {.winding_cC = 0, .switch_cC = 0};
    table->sensed = unknown;
    table->winding_hotter_cC = 0;
    table->current_missing_q15 = 0;
    table->optimum_mNm = FEASIBLE_UNBOUNDED;
    const torque_limits_currents_t none = {.returned = {.d_mA = 0, .q_mA = 0}};
    table->at = none;
    for (torque_line_t line = 0; line < TORQUE_LINE_COUNT; line++) {
        table->driving[line] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
        table->braking[line] = table->driving[line];
    }
}

bool torque_limits_deferrable(torque_line_t line)
{
    static const bool DEFERRABLE[TORQUE_LINE_COUNT] = {
#define TORQUE_LINE_CLASS(name, deferrable) [TORQUE_LINE_##name] = (deferrable),
        TORQUE_LINES(TORQUE_LINE_CLASS)
#undef TORQUE_LINE_CLASS
    };
    return line < TORQUE_LINE_COUNT && DEFERRABLE[line];
}

limit_t torque_limits_at_most(const limit_t *lines, int32_t torque_mNm)
{
    while (lines->torque_mNm > torque_mNm) {
        lines++;
    }
    return *lines;
}

limit_t torque_limits_tightest(const limit_t *lines, torque_line_t begin, torque_line_t end)
{
    const limit_t *tightest = &lines[begin];
    int32_t least_mNm = tightest->torque_mNm;
    for (const limit_t *line = tightest + 1; line < &lines[end]; line++) {
        if (line->torque_mNm < least_mNm) {
            least_mNm = line->torque_mNm;
            tightest = line;
        }
    }
    return *tightest;
}

static inline void sort_line(torque_limits_classes_t *out, torque_line_t line, bool deferrable,
                             int32_t torque_mNm)
{
    if (line != TORQUE_LINE_ELECTRIC_SHARE) {
        int32_t *const class_mNm = deferrable ? &out->deferrable_mNm : &out->hard_mNm;
        *class_mNm = q_min(*class_mNm, torque_mNm);
    }
}

torque_limits_classes_t torque_limits_classes(const limit_t braking[TORQUE_LINE_COUNT])
{
    torque_limits_classes_t out = {.hard_mNm = FEASIBLE_UNBOUNDED,
                                   .deferrable_mNm = FEASIBLE_UNBOUNDED};
#define TORQUE_LINE_SORT(name, deferrable)                                                         \
    sort_line(&out, TORQUE_LINE_##name, (deferrable), braking[TORQUE_LINE_##name].torque_mNm);
    TORQUE_LINES(TORQUE_LINE_SORT)
#undef TORQUE_LINE_SORT
    return out;
}

torque_line_t torque_limits_tightest_line(const limit_t lines[TORQUE_LINE_COUNT])
{
    torque_line_t out = (torque_line_t)0;
    for (torque_line_t line = 1; line < TORQUE_LINE_COUNT; line++) {
        if (lines[line].torque_mNm < lines[out].torque_mNm) {
            out = line;
        }
    }
    return out;
}

const char *torque_limits_line_text(torque_line_t line)
{
    static const char *const TEXTS[TORQUE_LINE_COUNT] = {
#define TORQUE_LINE_TEXT(name, deferrable) [TORQUE_LINE_##name] = #name,
        TORQUE_LINES(TORQUE_LINE_TEXT)
#undef TORQUE_LINE_TEXT
    };
    return line < TORQUE_LINE_COUNT ? TEXTS[line] : "unknown line";
}

/* A share of the motor's largest torque; a share of one or more is no bound. */
static limit_t share_line(const config_t *config, int32_t share_q15, reason_t reason)
{
    const int32_t part_mNm = (int32_t)(((int64_t)config->motor.max_torque_mNm * share_q15) >> 15);
    return limit_init(share_q15 < Q15_ONE ? part_mNm : FEASIBLE_UNBOUNDED, reason);
}

static int32_t winding_share_q15(const config_t *config, int32_t temperature_cC)
{
    const config_motor_t *motor = &config->motor;
    return fade_q15(temperature_cC, motor->derate_winding_temperature_cC,
                    motor->max_winding_temperature_cC);
}

static int32_t switch_share_q15(const config_t *config, int32_t temperature_cC)
{
    const config_drive_t *drive = &config->drive;
    return fade_q15(temperature_cC, drive->derate_switch_temperature_cC,
                    drive->max_switch_temperature_cC);
}

limit_t torque_limits_winding(const config_t *config, int32_t temperature_cC)
{
    return share_line(config, winding_share_q15(config, temperature_cC),
                      REASON_WINDING_TEMPERATURE);
}

limit_t torque_limits_switch(const config_t *config, int32_t temperature_cC)
{
    return share_line(config, switch_share_q15(config, temperature_cC), REASON_SWITCH_TEMPERATURE);
}

limit_t torque_limits_max_speed(const config_t *config, int32_t speed_mrad_s)
{
    const int32_t top_mrad_s = config->motor.max_speed_mrad_s;
    const int32_t fade_mrad_s =
        q15_share_of(top_mrad_s, (int16_t)config->motor.speed_fade_share_q15);
    return share_line(config, fade_q15(q_abs(speed_mrad_s), top_mrad_s - fade_mrad_s, top_mrad_s),
                      REASON_MAX_SPEED);
}

/* mW / (mrad/s) = N m; the quotient of two 32-bit numbers in thousandths. */
static int32_t power_torque_mNm(const config_t *config, int32_t speed_abs_mrad_s)
{
    const uint32_t power_mW = (uint32_t)config->motor.max_power_mW;
    const uint32_t speed = (uint32_t)speed_abs_mrad_s;
    if (speed == 0U || power_mW / speed >= 2000000U) {
        return FEASIBLE_UNBOUNDED;
    }
    const uint32_t rest_mW = power_mW % speed;
    const uint32_t part_mNm =
        speed < 4000000U ? rest_mW * 1000U / speed : rest_mW / (speed / 1000U);
    return (int32_t)(power_mW / speed * 1000U + part_mNm);
}

/* A current limit of the battery for this motor, and its reason. */
typedef struct {
    int32_t current_mA, peak_mA;       /* lasting; for a short time, >= current_mA */
    int32_t margin_mA, peak_margin_mA; /* of the management's limit beyond these */
    reason_t reason, peak_reason;
} battery_limit_t;

/* How far a current of this motor moves the battery's voltage: mA uOhm / 10^6, by way of 2^20. */
static int32_t pack_rise_mV(const config_battery_t *battery, int32_t current_mA)
{
    static const int32_t BINARY_TO_DECIMAL_q24 = 17592186; /* 2^20 / 10^6 */
    const int64_t product = ((int64_t)current_mA * battery->resistance_uOhm) >> 20;
    return scaled_multiply(q_saturate64(product), BINARY_TO_DECIMAL_q24);
}

/* This motor's share of what the management allows. One that comes and goes comes back slowly,
 * unless there is no other brake to have the rest. */
static int32_t by_management_mA(slow_rise_t *rise, const config_t *config, int32_t pack_mA,
                                int32_t most_mA)
{
    const int32_t share_mA = q_min(pack_share_mA(&config->battery, q_max(pack_mA, 0)), most_mA);
    return config->driver.no_other_brake != 0 ? share_mA : slow_rise_step(rise, share_mA, most_mA);
}

/* beyond_mA: that flows beyond what the model says. */
static battery_limit_t battery_limit(foldback_state_t *state, const config_battery_t *battery,
                                     int32_t most_mA, int32_t share_mA, int32_t pack_peak_mA,
                                     int32_t beyond_mA, int32_t width_mV, int32_t inside_mV,
                                     int32_t flowing_mA, const reason_t reasons[2])
{
    const int32_t span_mV = battery->max_voltage_mV - battery->min_voltage_mV;
    const foldback_t foldback = {
        .most_mA = most_mA,
        .width_mV = width_mV,
        .span_mV = span_mV,
        .rise_mV = q_min(pack_rise_mV(battery, most_mA), 4 * span_mV),
    };
    const int32_t by_voltage_mA = foldback_step(state, &foldback, inside_mV, flowing_mA);
    const int32_t by_bms_mA = share_mA - q_max(beyond_mA, 0);
    const int32_t by_peak_mA =
        q_clamp(pack_share_mA(battery, pack_peak_mA), share_mA, q_max(most_mA, share_mA)) -
        q_max(beyond_mA, 0);
    const battery_limit_t out = {
        .current_mA = q_min(by_voltage_mA, by_bms_mA),
        .peak_mA = q_min(by_voltage_mA, by_peak_mA),
        .margin_mA = q_max(by_bms_mA - by_voltage_mA, 0),
        .peak_margin_mA = q_max(by_peak_mA - by_voltage_mA, 0),
        .reason = by_voltage_mA < by_bms_mA ? reasons[1] : reasons[0],
        .peak_reason = by_voltage_mA < by_peak_mA ? reasons[1] : reasons[0],
    };
    return out;
}

/* The braking torque that an estimate of a temperature does not take away: what the current makes
 * that the part bears for ever, and the hydraulic brake has the rest; all of it where there is no
 * other brake. A sensor may take it. */
static int32_t least_hot_mNm(const motor_model_t *model, int32_t lasting_mA, limit_t sensed)
{
    const motor_constants_t *k = model->constants;
    const motor_point_t lasting = {
        .d_b = 0, .x_b = -q_min(motor_model_current_b(k, lasting_mA), k->current_most_b)};
    const int32_t lasting_mNm =
        q_min(q_abs(motor_model_torque_mNm(model, lasting)), model->config->motor.max_torque_mNm);
    const bool alone = model->config->driver.no_other_brake != 0;
    return alone ? sensed.torque_mNm : q_min(sensed.torque_mNm, lasting_mNm);
}

limit_t torque_limits_braking_hot(limit_t driving, int32_t least_mNm)
{
    return limit_init(q_max(driving.torque_mNm, least_mNm), driving.reason);
}

/* What a torque looks like where a share of the current is not seen. */
static int32_t seen_mNm(int32_t torque_mNm, int32_t missing_q15)
{
    return torque_mNm - q15_product(torque_mNm, missing_q15);
}

/* What the lines before it leave, of a current that is larger than it looks. */
static limit_t gain_line(const limit_t *lines, int32_t missing_q15)
{
    limit_t out = limit_init(FEASIBLE_UNBOUNDED, REASON_CURRENT_GAIN);
    if (missing_q15 > 0) {
        const limit_t before = torque_limits_tightest(lines, 0, TORQUE_LINE_CURRENT_GAIN);
        out.torque_mNm = seen_mNm(before.torque_mNm, missing_q15);
    }
    return out;
}

static void set_both(torque_limits_t *table, torque_line_t line, limit_t limit)
{
    table->driving[line] = limit;
    table->braking[line] = limit;
}

/* Below zero: the motor draws at least that. */
static feasible_returned_t returned_at(const motor_model_t *model, int32_t current_mA,
                                       int32_t margin_mA, int32_t bus_mV)
{
    const int32_t power_b = feasible_power_b(model, q_abs(current_mA), bus_mV);
    const feasible_returned_t out = {
        .power_b = current_mA < 0 ? -power_b : power_b,
        .margin_b = margin_mA > 0 ? feasible_power_b(model, margin_mA, bus_mV) : 0,
    };
    return out;
}

/* Zero at and below the end speed, even where the range has no width or ends at standstill. */
static int32_t blend_out_share_q15(const config_brake_t *brake, int32_t speed_abs_mrad_s)
{
    const int32_t end_mrad_s = brake->blend_out_end_mrad_s;
    return fade_q15(speed_abs_mrad_s, q_max(brake->blend_out_start_mrad_s, end_mrad_s + 1),
                    end_mrad_s);
}

/* A torque reduced by the blend-out, with that reason; `whole` without it. */
static limit_t faded(int32_t torque_mNm, int32_t share_q15, int32_t whole_mNm, reason_t reason)
{
    return share_q15 < Q15_ONE
               ? limit_init(q15_share_of(torque_mNm, (int16_t)share_q15), REASON_BLEND_OUT)
               : limit_init(whole_mNm, reason);
}

static limit_t blend_out_line(const config_t *config, int32_t share_q15)
{
    const config_brake_t *brake = &config->brake;
    const bool series = brake->strategy == CONFIG_STRATEGY_SERIES_OPTIMAL;
    return faded(series ? config->motor.max_torque_mNm : brake->electric_rated_torque_mNm,
                 share_q15, FEASIBLE_UNBOUNDED, REASON_BLEND_OUT);
}

limit_t torque_limits_blend_out(const config_t *config, int32_t speed_mrad_s)
{
    return blend_out_line(config, blend_out_share_q15(&config->brake, q_abs(speed_mrad_s)));
}

/* The lines of the strategy and their blend-out: a rating or a share is scaled; the loss optimum
 * applies until the blend-out of max_torque falls below it. */
void torque_limits_strategy(limit_t line[TORQUE_LINE_COUNT], const config_t *config,
                            int32_t speed_mrad_s, int32_t optimum_mNm, int32_t brake_torque_mNm)
{
    const config_brake_t *brake = &config->brake;
    const int32_t share_q15 = blend_out_share_q15(brake, q_abs(speed_mrad_s));
    const bool series = brake->strategy == CONFIG_STRATEGY_SERIES_OPTIMAL;
    line[TORQUE_LINE_LOSS_OPTIMUM] =
        limit_init(series ? optimum_mNm : FEASIBLE_UNBOUNDED, REASON_LOSS_OPTIMUM);
    const int32_t rated_mNm = brake->electric_rated_torque_mNm;
    line[TORQUE_LINE_ELECTRIC_RATED] =
        limit_init(series ? FEASIBLE_UNBOUNDED : rated_mNm, REASON_ELECTRIC_RATED);
    line[TORQUE_LINE_BLEND_OUT] = blend_out_line(config, share_q15);
    const int32_t part_mNm =
        q15_share_of(brake_torque_mNm, (int16_t)brake->parallel_electric_share_q15);
    line[TORQUE_LINE_ELECTRIC_SHARE] =
        brake->strategy == CONFIG_STRATEGY_PARALLEL_RATIO
            ? faded(part_mNm, share_q15, part_mNm, REASON_ELECTRIC_SHARE)
            : limit_init(FEASIBLE_UNBOUNDED, REASON_ELECTRIC_SHARE);
}

limit_t torque_limits_anti_lock(torque_limits_state_t *state, const config_t *config,
                                const wheel_demand_t *wheel, int32_t brake_torque_mNm)
{
    if (wheel->abs_active) {
        state->abs_hold_steps = config->brake.abs_hold_ms;
        state->abs_share_percent = q_min(wheel->abs_motor_share_percent, WHOLE_PERCENT);
    } else if (state->abs_hold_steps > 0) {
        state->abs_hold_steps--;
    }
    if (!wheel->abs_active && state->abs_hold_steps <= 0) {
        return limit_init(FEASIBLE_UNBOUNDED, REASON_ABS);
    }
    const int32_t left_mNm =
        q_scale(q_max(brake_torque_mNm, 0), state->abs_share_percent, WHOLE_PERCENT);
    return limit_init(left_mNm, REASON_ABS);
}

void torque_limits_plain(torque_limits_t *table, const motor_model_t *model,
                         int32_t switch_temperature_cC, int32_t brake_torque_mNm)
{
    const config_t *config = model->config;
    const int32_t winding_q15 =
        winding_share_q15(config, model->winding_temperature_cC + table->winding_hotter_cC);
    const int32_t switch_q15 = switch_share_q15(config, switch_temperature_cC);
    set_both(table, TORQUE_LINE_MAX_POWER,
             limit_init(power_torque_mNm(config, q_abs(model->speed_mrad_s)), REASON_MAX_POWER));
    const limit_t winding = share_line(config, winding_q15, REASON_WINDING_TEMPERATURE);
    const limit_t switches = share_line(config, switch_q15, REASON_SWITCH_TEMPERATURE);
    set_both(table, TORQUE_LINE_WINDING, winding);
    set_both(table, TORQUE_LINE_SWITCH, switches);
    if (winding.torque_mNm != FEASIBLE_UNBOUNDED) {
        const limit_t sensed = torque_limits_winding(config, table->sensed.winding_cC);
        table->braking[TORQUE_LINE_WINDING] = torque_limits_braking_hot(
            winding, least_hot_mNm(model, table->winding_lasting_mA, sensed));
    }
    if (switches.torque_mNm != FEASIBLE_UNBOUNDED) {
        const limit_t sensed = torque_limits_switch(config, table->sensed.switch_cC);
        table->braking[TORQUE_LINE_SWITCH] = torque_limits_braking_hot(
            switches, least_hot_mNm(model, table->switch_lasting_mA, sensed));
    }
    table->driving[TORQUE_LINE_MAX_SPEED] = torque_limits_max_speed(config, model->speed_mrad_s);
    const int32_t optimum_mNm =
        loss_maps_torque_mNm(config, model->speed_mrad_s, model->winding_temperature_cC) +
        scaled_shift(model->friction_b, -model->constants->torque_shift);
    table->optimum_mNm = seen_mNm(optimum_mNm, table->current_missing_q15);
    torque_limits_strategy(table->braking, config, model->speed_mrad_s, table->optimum_mNm,
                           q_max(brake_torque_mNm, 0));
    table->losses = loss_braking_at(model, table->losses.returned, q_min(winding_q15, switch_q15));
}

feasible_side_t torque_limits_ends(torque_limits_t *table, motor_model_t *model,
                                   feasible_set_t *set, side_t sign, feasible_circle_t *circle)
{
    const int32_t cap_mNm = q_min(table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm,
                                  table->driving[TORQUE_LINE_MAX_POWER].torque_mNm);
    const bool drives = sign == SIDE_DRIVING;
    limit_t *line = drives ? table->driving : table->braking;
    motor_current_t *end = drives ? &table->at.driving.end : &table->at.braking.end;
    if (flux_map_present(model->config)) {
        feasible_set_around(set, model, *end);
        circle->known = false;
    }
    feasible_side_t side = feasible_side_at(set, sign, cap_mNm);
    const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, circle);
    line[TORQUE_LINE_PHASE_CURRENT] = limit_init(ends.current_mNm, REASON_PHASE_CURRENT);
    line[TORQUE_LINE_VOLTAGE] = limit_init(ends.voltage_mNm, REASON_VOLTAGE);
    if (flux_map_present(model->config)) {
        *end = motor_model_current(model, side.cap);
    }
    return side;
}

/* A power that bounds at the end of the side, solved again around the bound's own currents, those
 * of the step before: returned, or drawn. Afterwards the set is that of the end again. */
static int32_t solved_again_mNm(motor_model_t *model, feasible_set_t *set,
                                const feasible_side_t *side, const feasible_returned_t *returned,
                                int32_t drawn_b, motor_current_t end, motor_current_t *own,
                                int32_t by_end_mNm)
{
    motor_point_t at = side->cap;
    int32_t out_mNm = by_end_mNm;
    if (by_end_mNm != FEASIBLE_UNBOUNDED) {
        feasible_set_around(set, model, *own);
        const feasible_cap_power_t cap = feasible_cap_power(side);
        out_mNm = returned != NULL ? feasible_by_returned_at(side, &cap, *returned, &at)
                                   : feasible_by_drawn_at(side, &cap, drawn_b, &at);
    }
    *own = motor_model_current(model, at);
    feasible_set_around(set, model, end);
    return out_mNm == FEASIBLE_UNBOUNDED ? by_end_mNm : out_mNm;
}

void torque_limits_drawn(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                         const feasible_side_t *side, const feasible_cap_power_t *cap)
{
    const bool drives = side->sign == (int32_t)SIDE_DRIVING;
    limit_t *line = drives ? table->driving : table->braking;
    motor_point_t found;
    int32_t bound_mNm = feasible_by_drawn_at(side, cap, table->drawn_b, &found);
    if (flux_map_present(model->config)) {
        torque_limits_side_currents_t *at = drives ? &table->at.driving : &table->at.braking;
        bound_mNm = solved_again_mNm(model, set, side, NULL, table->drawn_b, at->end, &at->drawn,
                                     bound_mNm);
    }
    line[TORQUE_LINE_DRAWN].torque_mNm = bound_mNm;
}

static int32_t returned_mNm(motor_model_t *model, feasible_set_t *set, const feasible_side_t *side,
                            const feasible_cap_power_t *cap, const feasible_returned_t *returned,
                            motor_current_t end, motor_current_t *own)
{
    motor_point_t found;
    const int32_t bound_mNm = feasible_by_returned_at(side, cap, *returned, &found);
    return flux_map_present(model->config)
               ? solved_again_mNm(model, set, side, returned, 0, end, own, bound_mNm)
               : bound_mNm;
}

void torque_limits_returned(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                            const feasible_side_t *side, const feasible_cap_power_t *cap)
{
    limit_t *line = table->braking;
    const int32_t by_map_mNm = returned_mNm(model, set, side, cap, &table->losses.returned,
                                            table->at.braking.end, &table->at.returned);
    feasible_set_around(set, model, table->at.losses);
    line[TORQUE_LINE_RETURNED].torque_mNm =
        loss_braking_torque_mNm(side, &table->losses, by_map_mNm);
    line[TORQUE_LINE_RETURNED_PEAK] = line[TORQUE_LINE_RETURNED];
    if (flux_map_present(model->config)) {
        table->at.losses = motor_model_current(model, table->losses.at);
        feasible_set_around(set, model, table->at.braking.end);
    }
}

/* What the battery permits, in the table, for the parts that follow. */
static void permit(torque_limits_t *table, const motor_model_t *model,
                   const battery_limit_t *discharge, const battery_limit_t *charge,
                   int32_t beyond_mA, int32_t bus_mV)
{
    table->drawn_b = feasible_power_b(model, discharge->current_mA, bus_mV);
    table->losses.returned = returned_at(model, charge->current_mA, charge->margin_mA, bus_mV);
    table->losses.returned.drawn_b =
        beyond_mA < 0 ? feasible_power_b(model, -beyond_mA, bus_mV) : 0;
    table->driving[TORQUE_LINE_DRAWN].reason = discharge->reason;
    table->braking[TORQUE_LINE_DRAWN].reason = discharge->reason;
    table->braking[TORQUE_LINE_RETURNED].reason = charge->reason;
}

/* The short-time charge current, never less than the lasting one. */
static void raise_peak(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                       const feasible_side_t *side, const feasible_cap_power_t *cap,
                       const battery_limit_t *charge, int32_t bus_mV)
{
    const feasible_returned_t peak =
        returned_at(model, charge->peak_mA, charge->peak_margin_mA, bus_mV);
    const int32_t most_mNm =
        returned_mNm(model, set, side, cap, &peak, table->at.braking.end, &table->at.peak);
    table->braking[TORQUE_LINE_RETURNED_PEAK] = limit_init(
        q_max(most_mNm, table->braking[TORQUE_LINE_RETURNED].torque_mNm), charge->peak_reason);
}

/* Zero without an angle; with the observer's, what keeps L_q from turning it too far. */
static limit_t rotor_line(const measured_t *now, const feasible_side_t *side)
{
    const bool observed = now->angle_valid && now->angle_by == ANGLE_BY_OBSERVER;
    const int32_t sensed_mNm = now->angle_valid ? FEASIBLE_UNBOUNDED : 0;
    return limit_init(observed ? observer_error_torque_mNm(side) : sensed_mNm,
                      REASON_ROTOR_UNCERTAIN);
}

/* What is solved of the driving side. Returns the line ROTOR. */
static limit_t solve_driving(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                             const measured_t *now, feasible_circle_t *circle)
{
    const feasible_side_t side = torque_limits_ends(table, model, set, SIDE_DRIVING, circle);
    const feasible_cap_power_t cap = feasible_cap_power(&side);
    torque_limits_drawn(table, model, set, &side, &cap);
    return rotor_line(now, &side);
}

/* What is solved of the braking side. Returns the line ROTOR. */
static limit_t solve_braking(torque_limits_t *table, motor_model_t *model, feasible_set_t *set,
                             const measured_t *now, feasible_circle_t *circle,
                             const battery_limit_t *charge, int32_t bus_mV)
{
    const feasible_side_t side = torque_limits_ends(table, model, set, SIDE_BRAKING, circle);
    feasible_cap_power_t cap = feasible_cap_power(&side);
    torque_limits_drawn(table, model, set, &side, &cap);
    const limit_t rotor = rotor_line(now, &side);
    if (flux_map_present(model->config)) { /* the set is now around the new end */
        cap = feasible_cap_power(&side);
    }
    torque_limits_returned(table, model, set, &side, &cap);
    if (charge->peak_mA != charge->current_mA) {
        raise_peak(table, model, set, &side, &cap, charge, bus_mV);
    }
    return rotor;
}

void torque_limits_step(torque_limits_state_t *state, motor_model_t *model, feasible_set_t *set,
                        const measured_t *now, const torque_enable_t *enable,
                        const torque_limits_input_t *in, torque_limits_t *table)
{
    static const reason_t DISCHARGE[2] = {REASON_DISCHARGE_CURRENT, REASON_BUS_VOLTAGE_LOW};
    static const reason_t CHARGE[2] = {REASON_CHARGE_CURRENT, REASON_BUS_VOLTAGE_HIGH};
    const config_t *config = model->config;
    const config_battery_t *battery = &config->battery;
    const int32_t sensor_mV = q_clamp(now->bus_voltage_mV, 0, 2 * battery->overvoltage_trip_mV);
    const int32_t highest_mV =
        q_clamp(in->battery_voltage_mV, sensor_mV, 2 * battery->overvoltage_trip_mV);
    /* The lowest: least power for a current, first to be empty. */
    const int32_t bus_mV =
        in->battery_voltage_mV > 0 ? q_min(sensor_mV, in->battery_voltage_mV) : sensor_mV;
    const int32_t drawn_mA = q_max(now->bus_current_mA, -INT32_MAX);
    const int32_t discharge_mA =
        by_management_mA(&state->discharge_rise, config, now->battery->discharge_current_mA,
                         battery->max_discharge_current_mA);
    const battery_limit_t discharge =
        battery_limit(&state->discharge, battery, battery->max_discharge_current_mA, discharge_mA,
                      0, 0, battery->discharge_foldback_voltage_mV - battery->min_voltage_mV,
                      bus_mV - battery->min_voltage_mV, drawn_mA, DISCHARGE);
    const int32_t charge_mA =
        by_management_mA(&state->charge_rise, config, now->battery->charge_current_mA,
                         battery->max_charge_current_mA);
    const battery_limit_t charge =
        battery_limit(&state->charge, battery, battery->max_charge_current_mA, charge_mA,
                      now->battery->charge_peak_current_mA, in->charge_beyond_mA,
                      battery->max_voltage_mV - battery->foldback_voltage_mV,
                      battery->max_voltage_mV - highest_mV, -drawn_mA, CHARGE);

    set_both(table, TORQUE_LINE_MAX_TORQUE,
             limit_init(config->motor.max_torque_mNm, REASON_MAX_TORQUE));
    permit(table, model, &discharge, &charge, in->charge_beyond_mA, bus_mV);
    table->winding_lasting_mA = now->winding_lasting_mA;
    table->switch_lasting_mA = now->switch_lasting_mA;
    table->sensed = now->sensed;
    table->winding_hotter_cC = now->winding_hotter_cC;
    table->current_missing_q15 = in->current_missing_q15;
    torque_limits_plain(table, model, now->switch_temperature_cC, in->brake_torque_mNm);
    feasible_circle_t circle = {.known = false};
    const limit_t driving_rotor = solve_driving(table, model, set, now, &circle);
    const limit_t braking_rotor = solve_braking(table, model, set, now, &circle, &charge, bus_mV);
    table->driving[TORQUE_LINE_ROTOR] = driving_rotor;
    table->braking[TORQUE_LINE_ROTOR] = braking_rotor;
    table->driving[TORQUE_LINE_ENABLE] = share_line(config, enable->drive_q15, enable->reason);
    table->braking[TORQUE_LINE_ENABLE] = share_line(config, enable->brake_q15, enable->reason);
    table->driving[TORQUE_LINE_CURRENT_GAIN] = gain_line(table->driving, in->current_missing_q15);
    table->braking[TORQUE_LINE_CURRENT_GAIN] = gain_line(table->braking, in->current_missing_q15);
    table->braking[TORQUE_LINE_ABS] =
        torque_limits_anti_lock(state, config, &now->in->demand, in->brake_torque_mNm);
}
