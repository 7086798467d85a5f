/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/thermal_model.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/isqrt.h"
#include "core/q15.h"
#include "core/scaled.h"

enum {
    STEP_US = THERMAL_MODEL_STEP_MS * 1000,
    STEP_LOG2 = 6,
    IRON_STEP = 0, /* of the next 64 */
    WINDING_STEP = 1,
    SWITCH_STEP = 2,
    LASTING_STEP = 3,
    LEAST_SHARE = 8,               /* a lasting current is never below this part of the largest */
    RISE_PER_WATT = 419430,        /* 64 ms 100/1000 2^16: over the capacity in mJ/K */
    MOST_q16 = 32700 << 16,        /* 327 degC */
    MOST_CURRENT_mA = 4000000,     /* the largest base of current */
    SQUARE_SHIFT = 12,             /* to 2^12 mA^2, so that any resistance's heat fits 64 bits */
    THREE_HALVES_NANO_q16 = 26388, /* 3/2 1e-9 2^12 2^16, 2^16: uOhm 2^12 mA^2 to mW */
    TWO_THIRDS_GIGA = 666666667,   /* mW/uOhm to mA^2 */
    MILLI_PER_CENTI = 10000        /* hundredths of a kelvin by mK/W to mW */
};

_Static_assert(1 << STEP_LOG2 == THERMAL_MODEL_STEP_MS, "a mean of a step is a shift");

/* h/(C R + h), the share of a difference that an implicit step of length h levels out, stable for
 * any C R. R 0: insulated. */
static int32_t share_q30(int32_t capacity_mJ_K, int64_t resistance_mK_W)
{
    return resistance_mK_W > 0
               ? scaled_constant(STEP_US, capacity_mJ_K * resistance_mK_W + STEP_US, 30)
               : 0;
}

static thermal_lumps_t row_of(int32_t inner_mJ_K, int32_t inner_mK_W, int32_t outer_mJ_K,
                              int32_t outer_mK_W)
{
    thermal_lumps_t out = {.known = inner_mJ_K > 0};
    if (!out.known) {
        return out;
    }
    const bool has_outer = outer_mJ_K > 0;
    /* Without an outer lump the inner one leads to the ambient through both resistances. */
    const int64_t across_mK_W = (int64_t)inner_mK_W + (has_outer ? 0 : outer_mK_W);
    out.inner_share_q30 = share_q30(inner_mJ_K, across_mK_W);
    const int32_t per_mW_q16 = scaled_constant(RISE_PER_WATT, inner_mJ_K, 16);
    out.inner_per_mW_q16 =
        (int32_t)(((int64_t)per_mW_q16 * ((1 << 30) - out.inner_share_q30)) >> 30);
    const int64_t whole_mK_W = (int64_t)inner_mK_W + outer_mK_W;
    const bool insulated = whole_mK_W == 0 || (has_outer && (inner_mK_W == 0 || outer_mK_W == 0));
    out.steady_mW_cK_q16 = insulated ? 0 : scaled_constant(MILLI_PER_CENTI, whole_mK_W, 16);
    out.outer_share_q15 = insulated || !has_outer ? 0 : scaled_constant(outer_mK_W, whole_mK_W, 15);
    if (has_outer) {
        out.outer_per_mW_q16 = scaled_constant(RISE_PER_WATT, outer_mJ_K, 16);
        out.outer_gain_q30 =
            inner_mK_W > 0 ? scaled_constant(STEP_US, (int64_t)outer_mJ_K * inner_mK_W, 30) : 0;
        out.ambient_share_q30 = share_q30(outer_mJ_K, outer_mK_W);
    }
    return out;
}

/* 3/2 R i^2. square: mean of i^2, 2^12 mA^2. */
static int32_t heat_mW(int64_t square, int32_t resistance_uOhm)
{
    const int32_t part = q_saturate64((square * resistance_uOhm) >> 16);
    return (int32_t)(((int64_t)part * THREE_HALVES_NANO_q16) >> 16); /* less than the part */
}

static int32_t bridge_mW(const config_t *config, int64_t square, int32_t length_mA)
{
    const config_drive_t *drive = &config->drive;
    const int64_t by_current_mW =
        divide_by_million((int64_t)drive->loss_per_ampere_uW_A * length_mA);
    return q_saturate64(by_current_mW + heat_mW(square, drive->loss_resistance_uOhm));
}

/* What a row leads away with its inner lump at limit_cC, less what is made in its outer one. */
static int32_t steady_mW(const thermal_lumps_t *row, int32_t limit_cC, int32_t ambient_cC,
                         int32_t outer_mW)
{
    const int64_t away_mW = ((int64_t)(limit_cC - ambient_cC) * row->steady_mW_cK_q16) >> 16;
    return q_saturate64(away_mW - (((int64_t)outer_mW * row->outer_share_q15) >> 15));
}

static int32_t least_lasting_mA(const config_t *config)
{
    return config->motor.max_phase_current_mA / LEAST_SHARE;
}

/* c1 i + 3/2 c2 i^2 = P, with the warmest ambient: i = 2 P/(c1 + sqrt(c1^2 + 6 c2 P)), the voltages
 * in 16 uV; c1 in uW/A is in uV, c2 P in uOhm mW in 1000 uV^2. */
static int32_t switch_lasting_mA(const config_t *config, const thermal_lumps_t *row)
{
    const config_drive_t *drive = &config->drive;
    const int64_t heat_mW = q_max(
        steady_mW(row, drive->max_switch_temperature_cC, config->monitor.warmest_ambient_cC, 0), 0);
    const int64_t threshold = drive->loss_per_ampere_uW_A >> 4;
    const int64_t by_resistance = 6000 * ((drive->loss_resistance_uOhm * heat_mW) >> 8);
    const int64_t sum = threshold + isqrt64((uint64_t)(threshold * threshold + by_resistance));
    const int32_t lasting_mA = scaled_constant(2000000 / 16 * heat_mW, sum + 1, 0);
    return q_max(q_min(lasting_mA, MOST_CURRENT_mA), least_lasting_mA(config));
}

void thermal_model_init(thermal_model_state_t *state, const config_t *config)
{
    const config_thermal_t *thermal = &config->thermal;
    const config_motor_t *motor = &config->motor;
    const thermal_model_state_t fresh = {
        .winding =
            row_of(thermal->winding_heat_capacity_mJ_K, thermal->winding_thermal_resistance_mK_W,
                   thermal->housing_heat_capacity_mJ_K, thermal->housing_thermal_resistance_mK_W),
        .switches =
            row_of(thermal->switch_heat_capacity_mJ_K, thermal->switch_thermal_resistance_mK_W,
                   thermal->heatsink_heat_capacity_mJ_K, thermal->heatsink_thermal_resistance_mK_W),
    };
    *state = fresh;
    const int32_t hot_uOhm = bases_at_winding_temperature(config, motor->phase_resistance_uOhm,
                                                          motor->max_winding_temperature_cC);
    state->square_per_mW = scaled_constant(TWO_THIRDS_GIGA, q_max(hot_uOhm, 1), 0);
    state->winding_lasting_mA = least_lasting_mA(config);
    state->switch_lasting_mA = switch_lasting_mA(config, &state->switches);
}

static int32_t in_q16(int32_t temperature_cC)
{
    return q_limit(temperature_cC, MOST_q16 >> 16) * (1 << 16);
}

static void start(thermal_lumps_t *row, int32_t temperature_cC, int32_t ambient_cC)
{
    row->inner_q16 = in_q16(temperature_cC);
    row->outer_q16 = row->outer_per_mW_q16 > 0 ? row->inner_q16 : in_q16(ambient_cC);
    row->ambient_q16 = in_q16(ambient_cC);
}

void thermal_model_start(thermal_model_state_t *state, const config_t *config, int32_t warmest_cC)
{
    const int32_t from_cC = q_max(warmest_cC, config->monitor.coldest_ambient_cC);
    const int32_t ambient_cC = q_min(from_cC, config->monitor.warmest_ambient_cC);
    start(&state->winding, from_cC, ambient_cC);
    start(&state->switches, from_cC, ambient_cC);
    state->started = true;
}

/* Part of a difference of temperature. */
static int64_t levelled_q16(int32_t warm_q16, int32_t cold_q16, int32_t share_of_q30)
{
    return (((int64_t)warm_q16 - cold_q16) * share_of_q30) >> 30;
}

static int32_t warmed_q16(int32_t from_q16, int32_t power_mW, int32_t per_mW_q16, int64_t flow_q16)
{
    const int64_t heat_q16 = ((int64_t)power_mW * per_mW_q16) >> 16;
    const int64_t now_q16 = from_q16 + heat_q16 + flow_q16;
    return now_q16 > MOST_q16 ? MOST_q16 : now_q16 < -MOST_q16 ? -MOST_q16 : (int32_t)now_q16;
}

/* The inner lump first, implicitly; the outer one takes what flows with its new temperature. */
static void advance(thermal_lumps_t *row, int32_t inner_mW, int32_t outer_mW)
{
    const int32_t inner_q16 = row->inner_q16;
    const int32_t outer_q16 = row->outer_q16; /* without an outer lump the ambient */
    row->inner_q16 = warmed_q16(inner_q16, inner_mW, row->inner_per_mW_q16,
                                -levelled_q16(inner_q16, outer_q16, row->inner_share_q30));
    row->outer_q16 =
        warmed_q16(outer_q16, outer_mW, row->outer_per_mW_q16,
                   levelled_q16(row->inner_q16, outer_q16, row->outer_gain_q30) -
                       levelled_q16(outer_q16, row->ambient_q16, row->ambient_share_q30));
}

static int32_t copper_mW(const config_t *config, int64_t square, int32_t winding_cC)
{
    return heat_mW(square, bases_at_winding_temperature(config, config->motor.phase_resistance_uOhm,
                                                        winding_cC));
}

/* 3/2 v^2 / R_i of one component of the voltage behind the resistance; v in mV, R_i in mOhm. */
static int64_t iron_part_mW(int64_t emf_mV, int32_t resistance_mOhm)
{
    const uint32_t most_mV = 1U << 23;
    const uint64_t magnitude_mV = (uint64_t)(emf_mV < 0 ? -emf_mV : emf_mV);
    const uint32_t v_mV = magnitude_mV < most_mV ? (uint32_t)magnitude_mV : most_mV;
    const uint32_t current_A_q8 = (v_mV << 8) / (uint32_t)resistance_mOhm;
    return (int64_t)(((uint64_t)current_A_q8 * v_mV) >> 8) * 3 / 2;
}

/* v = j w (psi + L i) at the present current. */
static int32_t iron_mW(const config_t *config, int32_t i_d_mA, int32_t i_q_mA, int32_t speed_mrad_s)
{
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, q_abs(speed_mrad_s));
    const int32_t resistance_mOhm =
        q_saturate64(motor->iron_loss_resistance_mOhm +
                     divide_by_billion(w_mrad_s * motor->iron_loss_resistance_slope_nOhm_s));
    if (resistance_mOhm <= 0) {
        return 0;
    }
    const int64_t d_nWb =
        motor->flux_linkage_nWb + divide_by_thousand((int64_t)i_d_mA * motor->d_inductance_nH);
    const int64_t q_nWb = divide_by_thousand((int64_t)i_q_mA * motor->q_inductance_nH);
    const int64_t part_mW =
        iron_part_mW(divide_by_billion(w_mrad_s * q_saturate64(d_nWb)), resistance_mOhm) +
        iron_part_mW(divide_by_billion(w_mrad_s * q_saturate64(q_nWb)), resistance_mOhm);
    return q_saturate64(part_mW);
}

/* Within 3 %. */
static int32_t length_mA(int32_t i_d_mA, int32_t i_q_mA)
{
    const int32_t large_mA = q_max(q_abs(i_d_mA), q_abs(i_q_mA));
    const int32_t small_mA = q_min(q_abs(i_d_mA), q_abs(i_q_mA));
    return q_max(large_mA, large_mA - (large_mA >> 3) + (small_mA >> 1));
}

/* 3/2 R i^2 = P, R at the winding's limit. */
static int32_t winding_lasting_mA(const thermal_model_state_t *state, const config_t *config)
{
    const thermal_lumps_t *row = &state->winding;
    const int32_t heat_mW = steady_mW(row, config->motor.max_winding_temperature_cC,
                                      row->ambient_q16 >> 16, state->iron_mW);
    const uint64_t square = (uint64_t)q_max(heat_mW, 0) * (uint64_t)state->square_per_mW;
    const uint32_t most_mA = MOST_CURRENT_mA;
    const uint32_t root_mA = isqrt64(square);
    return q_max((int32_t)(root_mA < most_mA ? root_mA : most_mA), least_lasting_mA(config));
}

/* One part of what the heat of the 64 ms before calls for. */
static void add_heat(thermal_model_state_t *state, const config_t *config, int32_t d_mA,
                     int32_t q_mA, int32_t speed_mrad_s)
{
    thermal_lumps_t *const winding = &state->winding;
    if (state->steps == IRON_STEP) {
        state->iron_mW = winding->known ? iron_mW(config, d_mA, q_mA, speed_mrad_s) : 0;
    } else if (state->steps == WINDING_STEP) {
        if (winding->known) {
            advance(winding, copper_mW(config, state->square, thermal_model_inner_cC(winding)),
                    state->iron_mW);
        }
    } else if (state->steps == SWITCH_STEP) {
        if (state->switches.known) {
            advance(&state->switches, bridge_mW(config, state->square, state->mean_mA), 0);
        }
    } else {
        state->winding_lasting_mA = winding_lasting_mA(state, config);
        state->heat_due = false;
    }
}

void thermal_model_step(thermal_model_state_t *state, const config_t *config, int32_t i_d_mA,
                        int32_t i_q_mA, int32_t speed_mrad_s)
{
    const int32_t d_mA = q_limit(i_d_mA, MOST_CURRENT_mA);
    const int32_t q_mA = q_limit(i_q_mA, MOST_CURRENT_mA);
    state->square_sum += (int64_t)d_mA * d_mA + (int64_t)q_mA * q_mA;
    state->length_sum += length_mA(d_mA, q_mA);
    if (state->heat_due) {
        add_heat(state, config, d_mA, q_mA, speed_mrad_s);
    }
    state->steps++;
    if (state->steps < THERMAL_MODEL_STEP_MS) {
        return;
    }
    state->square = state->square_sum >> (STEP_LOG2 + SQUARE_SHIFT);
    state->mean_mA = state->length_sum >> STEP_LOG2;
    state->steps = 0;
    state->square_sum = 0;
    state->length_sum = 0;
    state->heat_due = true;
}
