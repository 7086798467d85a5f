/* SPDX-License-Identifier: Apache-2.0 */
#include "app/energy.h"

#include "core/q15.h"

enum { PERCENT = 100, STEPS_A_Wh = 360 /* of 10 J */ };
static const uint64_t STEP_nJ = 10000000000;

void energy_init(energy_t *energy, const uint32_t before_10J[ENERGY_KINDS])
{
    const energy_t empty = {.slow_steps = 0};
    *energy = empty;
    for (uint32_t kind = 0; kind < ENERGY_KINDS; kind++) {
        energy->life_10J[kind] = before_10J[kind];
        energy->before_10J[kind] = before_10J[kind];
    }
}

static void add(energy_t *energy, uint32_t kind, uint64_t energy_nJ)
{
    energy->rest_nJ[kind] += energy_nJ;
    if (energy->rest_nJ[kind] >= STEP_nJ) {
        const uint64_t steps = energy->rest_nJ[kind] / STEP_nJ;
        const uint64_t life_10J = energy->life_10J[kind] + steps;
        energy->rest_nJ[kind] -= steps * STEP_nJ;
        energy->life_10J[kind] = life_10J < UINT32_MAX ? (uint32_t)life_10J : UINT32_MAX;
    }
}

/* In nJ a millisecond: 1 mV mA and 1 mN m mrad/s are 1 uW. */
static void add_signed(energy_t *energy, uint32_t positive, uint32_t negative, int64_t power_uW,
                       uint16_t milliseconds)
{
    if (power_uW >= 0) {
        add(energy, positive, (uint64_t)power_uW * milliseconds);
    } else {
        add(energy, negative, (uint64_t)-power_uW * milliseconds);
    }
}

void energy_step(energy_t *energy, const slow_output_t *output, uint16_t slow_steps)
{
    const uint16_t milliseconds = (uint16_t)(slow_steps - energy->slow_steps);
    const int64_t speed_mrad_s = output->speed_mrad_s;
    const int64_t braking_uW = -output->motor_torque_estimate_mNm * speed_mrad_s;
    energy->slow_steps = slow_steps;
    add_signed(energy, ENERGY_DRAWN, ENERGY_RETURNED,
               (int64_t)output->bus_voltage_mV * output->bus_current_mA, milliseconds);
    if (braking_uW > 0) {
        add(energy, ENERGY_MOTOR_BRAKING, (uint64_t)braking_uW * milliseconds);
    }
    if (output->hydraulic_valid) {
        const int64_t magnitude_mrad_s = speed_mrad_s < 0 ? -speed_mrad_s : speed_mrad_s;
        add(energy, ENERGY_FRICTION,
            (uint64_t)(q_max(output->hydraulic_torque_mNm, 0) * magnitude_mrad_s) * milliseconds);
    }
}

static uint32_t counted_10J(const energy_t *energy, uint32_t kind, bool for_life)
{
    return energy->life_10J[kind] - (for_life ? 0U : energy->before_10J[kind]);
}

messages_energy_t energy_report(const energy_t *energy, bool for_life)
{
    const uint64_t friction = counted_10J(energy, ENERGY_FRICTION, for_life);
    const uint64_t work = friction + counted_10J(energy, ENERGY_MOTOR_BRAKING, for_life);
    const messages_energy_t out = {
        .drawn_10J = counted_10J(energy, ENERGY_DRAWN, for_life),
        .returned_10J = counted_10J(energy, ENERGY_RETURNED, for_life),
        .friction_percent = (uint8_t)(work > 0 ? (PERCENT * friction + work / 2U) / work
                                               : (uint64_t)MESSAGES_NO_SHARE),
    };
    return out;
}

bool energy_line(const energy_t *energy, uint32_t number, text_t *line)
{
    const messages_energy_t report = energy_report(energy, number > 0);
    text_add(line, number > 0 ? "energy for life: drawn " : "energy since the start: drawn ");
    text_add_integer(line, (int32_t)(report.drawn_10J / STEPS_A_Wh));
    text_add(line, " Wh, returned ");
    text_add_integer(line, (int32_t)(report.returned_10J / STEPS_A_Wh));
    text_add(line, " Wh");
    if (report.friction_percent != MESSAGES_NO_SHARE) {
        text_add(line, ", friction ");
        text_add_integer(line, report.friction_percent);
        text_add(line, " % of the braking work");
    }
    return number < 2U;
}
