/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the battery gives and takes, in whole milliamperes: four wheels, 50 A of charge and 62.5 A
 * of discharge current a motor. A current is known by its power, feasible_power_b(), and a
 * power by the lines of a table that has it as its only limit.
 */
#include "torque_limits_rig.h"
#include "unity.h"

enum { SPEED_mrad_s = 30000, CHARGE_mA = 50000, DISCHARGE_mA = 62500, BUS_mV = 53000 };

void setUp(void)
{
    rig_up(paper_vehicle_without_i_d());
    TEST_ASSERT_EQUAL_INT32(CHARGE_mA, config.battery.max_charge_current_mA);
    TEST_ASSERT_EQUAL_INT32(DISCHARGE_mA, config.battery.max_discharge_current_mA);
    TEST_ASSERT_EQUAL_INT32(4, config.battery.driven_wheels);
}

void tearDown(void) {}

static int32_t power_of(int32_t current_mA, int32_t bus_mV)
{
    const motor_model_t model = model_at(&config, SPEED_mrad_s, winding_temperature_cC);
    return feasible_power_b(&model, current_mA, bus_mV);
}

/* ---- the management's limit ---- */

void test_a_motor_has_its_share_of_the_management_s_limit_up_to_its_own(void)
{
    static const int32_t PACK_mA[] = {INT32_MIN, -1,     0,      3,      4,        7,
                                      8,         199996, 199999, 200000, INT32_MAX};
    static const int32_t SHARE_mA[] = {0, 0, 0, 0, 1, 1, 2, 49999, 49999, 50000, CHARGE_mA};
    for (int k = 0; k < 11; k++) {
        conditions.bms_charge_current_mA = PACK_mA[k];
        (void)at_speed(SPEED_mrad_s);
        TEST_ASSERT_EQUAL_INT32(power_of(SHARE_mA[k], BUS_mV), table.losses.returned.power_b);
        TEST_ASSERT_EQUAL_INT32(0, table.losses.returned.margin_b);
        conditions.bms_discharge_current_mA = PACK_mA[k];
        (void)at_speed(SPEED_mrad_s);
        const int32_t drawn_mA = PACK_mA[k] > 200000 ? DISCHARGE_mA : SHARE_mA[k];
        TEST_ASSERT_EQUAL_INT32(power_of(drawn_mA, BUS_mV), table.drawn_b);
    }
    TEST_ASSERT_NOT_EQUAL_INT32(power_of(49999, BUS_mV), power_of(50000, BUS_mV));
    config.battery.driven_wheels = 1;
    conditions.bms_charge_current_mA = 0;
    (void)at_speed(SPEED_mrad_s);
    TEST_ASSERT_EQUAL_INT32(0, table.losses.returned.power_b);
    TEST_ASSERT_NOT_EQUAL_INT32(0, power_of(1, BUS_mV));
}

/* A quarter of the pack's 120 A by an equal share, an eighth by one of its own. */
void test_a_motor_with_a_share_of_its_own_has_that_of_limit_and_peak(void)
{
    conditions.bms_charge_current_mA = 120000;
    conditions.bms_charge_peak_mA = 160000;
    conditions.bms_discharge_current_mA = 120000;
    config.battery.pack_share_q15 = 4096;
    (void)at_speed(SPEED_mrad_s);
    TEST_ASSERT_EQUAL_INT32(power_of(15000, BUS_mV), table.losses.returned.power_b);
    TEST_ASSERT_EQUAL_INT32(power_of(15000, BUS_mV), table.drawn_b);
    const limit_t peak = table.braking[TORQUE_LINE_RETURNED_PEAK];
    config.battery.pack_share_q15 = 0;
    conditions.bms_charge_peak_mA = 80000;
    conditions.bms_charge_current_mA = 60000;
    (void)at_speed(SPEED_mrad_s);
    TEST_ASSERT_EQUAL_INT32(table.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm, peak.torque_mNm);
}

/* The line of a peak is that of a lasting limit of the same size; a peak below the lasting limit
 * is that limit. */
void test_a_peak_of_the_charge_current_has_a_line_of_its_own(void)
{
    static const int32_t PEAK_mA[] = {INT32_MIN, 0,      39999,  40000,  40004,
                                      80000,     199996, 200000, 200004, INT32_MAX};
    for (int k = 0; k < 10; k++) {
        conditions.bms_charge_current_mA = PEAK_mA[k] > 40000 ? PEAK_mA[k] : 40000;
        conditions.bms_charge_peak_mA = 0;
        (void)at_speed(SPEED_mrad_s);
        const limit_t expected = table.braking[TORQUE_LINE_RETURNED];
        TEST_ASSERT_EQUAL_INT32(expected.torque_mNm,
                                table.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm);
        conditions.bms_charge_current_mA = 40000;
        (void)at_speed(SPEED_mrad_s);
        const int32_t lasting_mNm = table.braking[TORQUE_LINE_RETURNED].torque_mNm;
        conditions.bms_charge_peak_mA = PEAK_mA[k];
        (void)at_speed(SPEED_mrad_s);
        TEST_ASSERT_EQUAL_INT32(lasting_mNm, table.braking[TORQUE_LINE_RETURNED].torque_mNm);
        const limit_t peak = table.braking[TORQUE_LINE_RETURNED_PEAK];
        TEST_ASSERT_EQUAL_INT32(expected.torque_mNm, peak.torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_CHARGE_CURRENT, peak.reason);
    }
}

/* ---- the fold-back's limit ---- */

/* One step from a share that a voltage has settled at; then the share's current. */
static int32_t folded_mA(const foldback_state_t *foldback, int32_t most_mA)
{
    const motor_model_t model = model_at(&config, SPEED_mrad_s, winding_temperature_cC);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    torque_limits_case_step(&state, &set, &conditions, &table);
    return scaled_multiply(most_mA, foldback->allowed_q24);
}

/* The middle of the fold-back: 25 A of 50 A. A limit of the management's beyond it is a margin;
 * on a tie the management's is the reason. */
void test_what_the_fold_back_leaves_of_the_charge_current_is_exact(void)
{
    const int32_t middle_mV =
        (config.battery.foldback_voltage_mV + config.battery.max_voltage_mV) / 2;
    conditions.bus_voltage_mV = middle_mV;
    settle_foldback(20000);
    const torque_limits_state_t settled = state;
    const int32_t by_voltage_mA = folded_mA(&state.charge, CHARGE_mA);
    TEST_ASSERT_INT32_WITHIN(50, CHARGE_mA / 2, by_voltage_mA);
    int32_t lasting_mNm = 0;
    for (int32_t beyond_mA = -1; beyond_mA <= 1; beyond_mA++) {
        for (int peak = 0; peak < 2; peak++) {
            state = settled;
            const int32_t pack_mA = 4 * (by_voltage_mA + beyond_mA);
            conditions.bms_charge_current_mA = peak != 0 ? 4000 : pack_mA;
            conditions.bms_charge_peak_mA = peak != 0 ? pack_mA : 0;
            TEST_ASSERT_EQUAL_INT32(by_voltage_mA, folded_mA(&state.charge, CHARGE_mA));
            const limit_t line =
                table.braking[peak != 0 ? TORQUE_LINE_RETURNED_PEAK : TORQUE_LINE_RETURNED];
            TEST_ASSERT_EQUAL_INT(beyond_mA > 0 ? REASON_BUS_VOLTAGE_HIGH : REASON_CHARGE_CURRENT,
                                  line.reason);
            lasting_mNm = peak == 0 ? line.torque_mNm : lasting_mNm;
            TEST_ASSERT_EQUAL_INT32(lasting_mNm, line.torque_mNm);
            if (peak == 0) {
                const int32_t least_mA = by_voltage_mA + (beyond_mA < 0 ? -1 : 0);
                TEST_ASSERT_EQUAL_INT32(power_of(least_mA, middle_mV),
                                        table.losses.returned.power_b);
                TEST_ASSERT_EQUAL_INT32(beyond_mA > 0 ? power_of(1, middle_mV) : 0,
                                        table.losses.returned.margin_b);
            }
        }
    }
    state = settled;
    conditions.bms_charge_peak_mA = 0;
    conditions.bms_charge_current_mA = 160000;
    TEST_ASSERT_EQUAL_INT32(by_voltage_mA, folded_mA(&state.charge, CHARGE_mA));
    TEST_ASSERT_EQUAL_INT32(power_of(40000 - by_voltage_mA, middle_mV),
                            table.losses.returned.margin_b);
}

void test_what_the_fold_back_leaves_of_the_discharge_current_is_exact(void)
{
    const int32_t middle_mV =
        (config.battery.min_voltage_mV + config.battery.discharge_foldback_voltage_mV) / 2;
    conditions.bus_voltage_mV = middle_mV;
    settle_foldback(20000);
    const torque_limits_state_t settled = state;
    const int32_t by_voltage_mA = folded_mA(&state.discharge, DISCHARGE_mA);
    TEST_ASSERT_INT32_WITHIN(60, DISCHARGE_mA / 2, by_voltage_mA);
    for (int32_t beyond_mA = -1; beyond_mA <= 1; beyond_mA++) {
        state = settled;
        conditions.bms_discharge_current_mA = 4 * (by_voltage_mA + beyond_mA);
        TEST_ASSERT_EQUAL_INT32(by_voltage_mA, folded_mA(&state.discharge, DISCHARGE_mA));
        TEST_ASSERT_EQUAL_INT(beyond_mA > 0 ? REASON_BUS_VOLTAGE_LOW : REASON_DISCHARGE_CURRENT,
                              table.driving[TORQUE_LINE_DRAWN].reason);
        TEST_ASSERT_EQUAL_INT32(power_of(by_voltage_mA + (beyond_mA < 0 ? -1 : 0), middle_mV),
                                table.drawn_b);
    }
}

/* ---- two voltages ---- */

/* The lower one has less power for a current; 0: there is one only. */
void test_a_current_has_the_power_of_the_lower_voltage(void)
{
    static const int32_t BATTERY_mV[] = {0, 50000, 53000, 55000};
    static const int32_t LOWER_mV[] = {53000, 50000, 53000, 53000};
    for (int k = 0; k < 4; k++) {
        conditions.battery_voltage_mV = BATTERY_mV[k];
        (void)at_speed(SPEED_mrad_s);
        TEST_ASSERT_EQUAL_INT32(power_of(DISCHARGE_mA, LOWER_mV[k]), table.drawn_b);
        TEST_ASSERT_EQUAL_INT32(power_of(CHARGE_mA, LOWER_mV[k]), table.losses.returned.power_b);
    }
    conditions.battery_voltage_mV = 0; /* up to twice the trip's voltage */
    conditions.bus_voltage_mV = 2 * config.battery.overvoltage_trip_mV + 1000;
    (void)at_speed(SPEED_mrad_s);
    TEST_ASSERT_EQUAL_INT32(power_of(DISCHARGE_mA, 2 * config.battery.overvoltage_trip_mV),
                            table.drawn_b);
    conditions.bus_voltage_mV = BUS_mV;
    conditions.battery_voltage_mV = 1; /* empty */
    (void)at_speed(SPEED_mrad_s);
    TEST_ASSERT_EQUAL_INT32(0, table.drawn_b);
}

/* What a voltage has left of the currents. */
static torque_limits_state_t settled_at(int32_t bus_mV)
{
    conditions.bus_voltage_mV = bus_mV;
    settle_foldback(20000);
    return state;
}

/* One step of the fold-back at a voltage. */
static int32_t charge_share_at(int32_t bus_mV, int32_t battery_mV,
                               const torque_limits_state_t *from)
{
    state = *from;
    conditions.bus_voltage_mV = bus_mV;
    conditions.battery_voltage_mV = battery_mV;
    (void)folded_mA(&state.charge, CHARGE_mA);
    return state.charge.allowed_q24;
}

/* From a tenth of the charge current. Up to twice the trip's voltage count. */
void test_charging_folds_back_at_the_higher_voltage(void)
{
    const int32_t most_mV = 2 * config.battery.overvoltage_trip_mV;
    config.battery.max_voltage_mV = most_mV; /* at which the fold-back ends */
    config.battery.foldback_voltage_mV = most_mV - 1000;
    const torque_limits_state_t tenth = settled_at(most_mV - 100);
    TEST_ASSERT_INT32_WITHIN(SCALED_ONE / 1000, SCALED_ONE / 10, tenth.charge.allowed_q24);
    const int32_t at_55_V = charge_share_at(55000, 0, &tenth);
    TEST_ASSERT_EQUAL_INT32(at_55_V, charge_share_at(50000, 55000, &tenth));
    TEST_ASSERT_EQUAL_INT32(at_55_V, charge_share_at(55000, 50000, &tenth));
    TEST_ASSERT_TRUE(charge_share_at(50000, 0, &tenth) > at_55_V);
    TEST_ASSERT_EQUAL_INT32(charge_share_at(0, 0, &tenth), charge_share_at(-5000, 0, &tenth));
    const int32_t at_most = charge_share_at(most_mV, 0, &tenth);
    TEST_ASSERT_EQUAL_INT32(at_most, charge_share_at(most_mV + 900, 0, &tenth));
    TEST_ASSERT_TRUE(charge_share_at(most_mV - 900, 0, &tenth) > at_most);
    TEST_ASSERT_EQUAL_INT32(at_most, charge_share_at(50000, most_mV + 900, &tenth));
    TEST_ASSERT_TRUE(charge_share_at(50000, most_mV - 900, &tenth) > at_most);
}

/* ---- the battery's resistance ---- */

/* 20 mOhm at 50 A are 1 V, within 1e-6. A quarter of the limit flows at 57.4 V: it is let rise as
 * far as 0.75 V more, as a battery without resistance at 58.15 V; likewise discharging. */
void test_a_current_moves_the_voltage_by_the_battery_s_resistance(void)
{
    const torque_limits_state_t whole = state;
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, whole.charge.allowed_q24);
    config.battery.resistance_uOhm = 20000;
    conditions.bus_current_mA = -CHARGE_mA / 4;
    const int32_t with_q24 = charge_share_at(57400, 0, &whole);
    config.battery.resistance_uOhm = 0;
    TEST_ASSERT_LESS_THAN_INT32(SCALED_ONE, with_q24);
    TEST_ASSERT_INT32_WITHIN(1200, charge_share_at(58150, 0, &whole), with_q24); /* 1 mV */
}

/* From half of both currents. Nothing wraps, and the largest current is that of -INT32_MAX. */
void test_a_current_of_any_size_is_one(void)
{
    config.battery.min_voltage_mV = config.battery.foldback_voltage_mV = BUS_mV - 3000;
    config.battery.max_voltage_mV = config.battery.discharge_foldback_voltage_mV = BUS_mV + 3000;
    const torque_limits_state_t half = settled_at(BUS_mV);
    TEST_ASSERT_INT32_WITHIN(SCALED_ONE / 1000, SCALED_ONE / 2, half.charge.allowed_q24);
    TEST_ASSERT_INT32_WITHIN(SCALED_ONE / 1000, SCALED_ONE / 2, half.discharge.allowed_q24);
    config.battery.resistance_uOhm = 100000000;
    static const int32_t FLOWING_mA[] = {-INT32_MAX, INT32_MIN};
    int32_t shares_q24[2];
    for (int k = 0; k < 2; k++) {
        conditions.bus_current_mA = FLOWING_mA[k];
        shares_q24[k] = charge_share_at(BUS_mV, 0, &half);
    }
    TEST_ASSERT_EQUAL_INT32(shares_q24[0], shares_q24[1]);
    TEST_ASSERT_TRUE(shares_q24[0] > half.charge.allowed_q24);
}

/* ---- the range of the fold-back ---- */

/* A step from the share that a voltage leaves, by the table and by foldback.h: the span is the
 * battery's whole range, and a resistance of 100 Ohm moves the voltage by four times that. */
static void assert_folds_back_over_the_range(int32_t resistance_uOhm, int32_t from_mV)
{
    const config_battery_t *b = &config.battery;
    config.battery.resistance_uOhm = 0;
    conditions.bus_current_mA = 0;
    const torque_limits_state_t from = settled_at(from_mV);
    config.battery.resistance_uOhm = resistance_uOhm;
    const int32_t span_mV = b->max_voltage_mV - b->min_voltage_mV;
    const int32_t rise_mV = resistance_uOhm > 0 ? 4 * span_mV : 0;
    const foldback_t charge = {.most_mA = CHARGE_mA,
                               .width_mV = b->max_voltage_mV - b->foldback_voltage_mV,
                               .span_mV = span_mV,
                               .rise_mV = rise_mV};
    const foldback_t discharge = {.most_mA = DISCHARGE_mA,
                                  .width_mV = b->discharge_foldback_voltage_mV - b->min_voltage_mV,
                                  .span_mV = span_mV,
                                  .rise_mV = rise_mV};
    foldback_state_t expected[] = {from.charge, from.discharge};
    conditions.bus_voltage_mV = BUS_mV;
    conditions.bus_current_mA = -CHARGE_mA * 2 / 5;
    const int32_t flowing_mA = conditions.bus_current_mA;
    foldback_step(&expected[0], &charge, b->max_voltage_mV - BUS_mV, -flowing_mA);
    foldback_step(&expected[1], &discharge, BUS_mV - b->min_voltage_mV, flowing_mA);
    (void)folded_mA(&state.charge, CHARGE_mA);
    TEST_ASSERT_EQUAL_INT32(expected[0].allowed_q24, state.charge.allowed_q24);
    TEST_ASSERT_EQUAL_INT32(expected[1].allowed_q24, state.discharge.allowed_q24);
}

void test_the_fold_back_spans_the_battery_s_range_and_counts_four_of_it_as_rise(void)
{
    const config_battery_t *b = &config.battery;
    const int32_t charge_mV = (b->foldback_voltage_mV + b->max_voltage_mV) / 2;
    const int32_t discharge_mV = (b->min_voltage_mV + b->discharge_foldback_voltage_mV) / 2;
    for (int32_t resistance_uOhm = 0; resistance_uOhm <= 100000000; resistance_uOhm += 100000000) {
        assert_folds_back_over_the_range(resistance_uOhm, charge_mV);
        assert_folds_back_over_the_range(resistance_uOhm, discharge_mV);
    }
}

/* ---- the peak of the charge current ---- */

static limit_t returned_line(int32_t pack_mA, bool as_peak, const torque_limits_state_t *from)
{
    state = *from;
    conditions.bms_charge_current_mA = as_peak ? 4000 : pack_mA;
    conditions.bms_charge_peak_mA = as_peak ? pack_mA : 0;
    (void)folded_mA(&state.charge, CHARGE_mA);
    return table.braking[as_peak ? TORQUE_LINE_RETURNED_PEAK : TORQUE_LINE_RETURNED];
}

/* With hall sensors and 20 A of i_d: the uncertain angle of 690 rad/s at 20 kHz, 17 mrad of 14 V
 * and 20 A, counts beyond the margin. A milliampere of 54 V at 30 rad/s is 1.8 mN m. */
void test_a_peak_beyond_the_fold_back_has_its_torque_and_margin(void)
{
    static const int32_t BEYOND_mA[] = {-1000, 0, 1, 20};
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX; k++) {
        config.current_map.current_d_lsb[k] = -20000;
    }
    config.battery.max_charge_current_mA = 8000;
    config.brake.loss_braking = 0;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    conditions.bus_voltage_mV =
        (config.battery.foldback_voltage_mV + config.battery.max_voltage_mV) / 2;
    settle_foldback(20000);
    const torque_limits_state_t settled = state;
    const int32_t by_voltage_mA = folded_mA(&state.charge, 8000);
    int32_t before_mNm = 0;
    for (int k = 0; k < 4; k++) {
        const int32_t pack_mA = 4 * (by_voltage_mA + BEYOND_mA[k]);
        const limit_t lasting = returned_line(pack_mA, false, &settled);
        const limit_t peak = returned_line(pack_mA, true, &settled);
        TEST_ASSERT_EQUAL_INT32(lasting.torque_mNm, peak.torque_mNm);
        TEST_ASSERT_EQUAL_INT(lasting.reason, peak.reason);
        TEST_ASSERT_GREATER_THAN_INT32(before_mNm, peak.torque_mNm);
        before_mNm = peak.torque_mNm;
    }
}

/* Loss braking makes more torque of the lasting limit than the map does of a peak beside it. */
void test_a_peak_has_no_less_torque_than_the_lasting_limit(void)
{
    config.brake.loss_braking = 1;
    conditions.bms_charge_current_mA = 4000;
    conditions.bms_charge_peak_mA = 4004;
    (void)folded_mA(&state.charge, CHARGE_mA);
    const int32_t lasting_mNm = table.braking[TORQUE_LINE_RETURNED].torque_mNm;
    TEST_ASSERT_GREATER_THAN_INT32(table.losses.by_map_mNm + 1000, lasting_mNm);
    TEST_ASSERT_EQUAL_INT32(lasting_mNm, table.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm);
}

/* What flows beyond the model comes off both limits of the management, at four wheels a quarter of
 * the pack's. */
void test_what_the_motor_charges_beyond_its_model_comes_off_the_limit(void)
{
    conditions.bms_charge_current_mA = 4 * 6000;
    conditions.bms_charge_peak_mA = 4 * 8000;
    conditions.charge_beyond_mA = 1000;
    (void)folded_mA(&state.charge, CHARGE_mA);
    const int32_t lasting_mNm = table.braking[TORQUE_LINE_RETURNED].torque_mNm;
    const int32_t peak_mNm = table.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm;
    conditions.bms_charge_current_mA = 4 * 5000;
    conditions.bms_charge_peak_mA = 4 * 7000;
    conditions.charge_beyond_mA = 0;
    (void)folded_mA(&state.charge, CHARGE_mA);
    TEST_ASSERT_EQUAL_INT32(lasting_mNm, table.braking[TORQUE_LINE_RETURNED].torque_mNm);
    TEST_ASSERT_EQUAL_INT32(peak_mNm, table.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, table.losses.returned.drawn_b);
}

/* With a charge limit of zero it has to draw; what it draws beyond its model it brakes with. */
void test_a_motor_draws_what_it_would_charge_and_brakes_with_what_it_would_draw(void)
{
    conditions.bms_charge_current_mA = 0;
    const motor_model_t model = model_at(&config, SPEED_mrad_s, winding_temperature_cC);
    const int32_t ampere_b = feasible_power_b(&model, 1000, conditions.bus_voltage_mV);
    conditions.charge_beyond_mA = 1000;
    (void)folded_mA(&state.charge, CHARGE_mA);
    TEST_ASSERT_EQUAL_INT32(-ampere_b, table.losses.returned.power_b);
    conditions.charge_beyond_mA = -1000;
    (void)folded_mA(&state.charge, CHARGE_mA);
    TEST_ASSERT_EQUAL_INT32(0, table.losses.returned.power_b);
    TEST_ASSERT_EQUAL_INT32(ampere_b, table.losses.returned.drawn_b);
}
