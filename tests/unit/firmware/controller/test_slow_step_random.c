/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Five properties of the slow step, in random lives of all four configurations:
 *
 * 1. No driving command while the brake is demanded, the demand is lost or no direction is engaged.
 *
 * 2. A lost demand lowers |command|; one that is kept is never exceeded.
 *
 * 3. Motor and hydraulic brake together make the demand, wherever the hydraulic brake can; of one
 * below twice the coasting torque C up to C and half of it.
 *
 * 4. A command below the demand has a reason, and so has an available torque below the largest.
 *
 * 5. The command lies between zero, its last value and the demand: no change of sign but by that.
 *
 * A life begins with a random configuration (strategy, bridging, feedback, hold of a lost demand)
 * and is a sequence of phases: demands, limits, temperatures, voltage and acceleration are drawn at
 * the beginning of each, and at times in between. In one phase of ten every input is any number.
 *
 * HUBFOC_RANDOM_STEPS: number of steps, default 200 000. HUBFOC_RANDOM_SEED: of the first life,
 * default 1; one more each.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "coasting.h"
#include "random_values.h"
#include "slow_step_rig.h"
#include "torque/demand.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;
static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};
enum { CONFIGS_COUNT = 4, LIFE_STEPS = 20000, STEPS = 200000, DEAD_STEPS = 200, SETTLE_ms = 600 };

typedef struct {
    int64_t left_ms;
    bool wild, feedback, lively, saves;
    double acceleration_rad_s2;
    int32_t report_mNm, report_age_ms;
} phase_t;

/* What the properties compare with; kept by the test alone. */
typedef struct {
    int32_t before_mNm; /* command of the step before */
    int32_t kept_mNm;   /* braking demand, lift-off included, that a lost demand keeps */
    int64_t lost_ms, quiet_ms, idle_ms;
    bridge_mode_t bridge;
} reference_t;

typedef struct {
    int64_t ran, braked, drove, lost, settled, reasons, wild, lives;
    double off_square; /* of the sum of both brakes, to its demand */
} counts_t;

static slow_rig_t rig;
static random_t source;
static phase_t phase;
static reference_t reference;
static counts_t counts;
static int64_t step_number;
static bool has_feedback; /* this life's hydraulic brake */
static uint64_t seed, life_seed;

void setUp(void) {}

void tearDown(void) {}

static int64_t setting(const char *name, int64_t otherwise)
{
    const char *text = getenv(name);
    return text != NULL ? strtoll(text, NULL, 10) : otherwise;
}

static bool chance(double probability)
{
    return random_chance(&source, probability);
}

static int32_t between(int32_t low, int32_t high)
{
    return random_between(&source, low, high);
}

static void check(bool holds, const char *property)
{
    if (!holds) {
        char text[420];
        const slow_output_t *out = &rig.out;
        const wheel_demand_t *demand = &rig.in.demand;
        snprintf(text, sizeof text,
                 "%s: %s, life %" PRIu64 ", step %" PRId64
                 ", drive %d, brake %d, age %u, direction %d/%d, speed %d, command %d after %d, "
                 "hydraulic %d (%.0f), kept %d, lost %d ms, quiet %d ms, reason %s/%s, mode %d, "
                 "available %d",
                 property, rig.config.name, life_seed, step_number, (int)demand->drive_torque_mNm,
                 (int)demand->brake_torque_mNm, (unsigned)rig.in.demand_age_ms,
                 (int)demand->direction, (int)out->direction, (int)out->speed_mrad_s,
                 (int)out->motor_torque_command_mNm, (int)reference.before_mNm,
                 (int)out->hydraulic_torque_mNm, rig.brake.torque_mNm, (int)reference.kept_mNm,
                 (int)reference.lost_ms, (int)reference.quiet_ms, reason_text(out->torque_reason),
                 reason_text(out->available_reason), (int)out->mode,
                 (int)out->electric_brake_available_mNm);
        TEST_FAIL_MESSAGE(text);
    }
}

/* ---- the random life ---- */

static void begin_life(void)
{
    life_seed = seed + (uint64_t)counts.lives;
    source = random_seeded(life_seed * UINT64_C(0x9E3779B97F4A7C15));
    config_t config = *CONFIGS[between(0, CONFIGS_COUNT - 1)];
    config.brake.strategy = between(0, 2);
    config.brake.loss_braking = between(0, 1);
    config.brake.bridging_time_ms *= chance(0.8) ? 1 : 0;
    config.driver.no_other_brake = chance(0.1) ? 1 : 0;
    slow_rig_start(&rig, &config);
    rig.speed_rad_s = random_real(&source, -0.5, 1.0) * config.motor.max_speed_mrad_s * 1e-3;
    has_feedback = chance(0.5);
    rig.brake.gain = has_feedback ? random_real(&source, 0.8, 1.2) : 1.0;
    phase.left_ms = 0;
    const reference_t fresh = {.before_mNm = 0};
    reference = fresh;
    reference.lost_ms = INT32_MAX;
    counts.lives++;
}

static void draw_demand(void)
{
    const int32_t most_mNm = rig.config.motor.max_torque_mNm;
    wheel_demand_t *demand = &rig.in.demand;
    const int kind = between(0, 4);
    demand->drive_torque_mNm = kind < 2 ? between(-most_mNm / 4, most_mNm * 5 / 4) : 0;
    demand->brake_torque_mNm = kind == 1 || kind == 2 || kind == 3 ? between(0, 2 * most_mNm) : 0;
    demand->brake_torque_mNm /= chance(0.5) ? 4 : 1;
    demand->abs_active = chance(0.03);
    demand->fault_reset = chance(0.3);
    if (chance(0.2)) {
        demand->direction = (drive_direction_t)between(0, 2);
    } else if (chance(0.5)) {
        demand->direction =
            rig.speed_rad_s >= 0.0 ? DRIVE_DIRECTION_FORWARD : DRIVE_DIRECTION_REVERSE;
    }
    if (demand->direction == DRIVE_DIRECTION_REVERSE) {
        demand->drive_torque_mNm = -demand->drive_torque_mNm;
    }
}

static void draw_limits(void)
{
    const config_battery_t *battery = &rig.config.battery;
    const config_motor_t *motor = &rig.config.motor;
    const int32_t pack_mA = 2 * battery->driven_wheels * battery->max_charge_current_mA;
    rig.in.bms.charge_current_mA = chance(0.3) ? 0 : between(0, pack_mA);
    rig.in.bms.charge_peak_current_mA = chance(0.5) ? 0 : between(0, pack_mA);
    rig.in.bms.discharge_current_mA = chance(0.1) ? 0 : between(0, 1000000);
    rig.in.bms.contactor = chance(0.02) ? CONTACTOR_OPEN : CONTACTOR_CLOSED;
    rig.in.temperature.winding_cC =
        between(-2000, motor->max_winding_temperature_cC + (chance(0.1) ? 1000 : -1000));
    rig.in.temperature.switch_cC =
        between(-2000, rig.config.drive.max_switch_temperature_cC - (chance(0.5) ? 2000 : 0));
    rig.bus_v = 1e-3 * between(battery->min_voltage_mV, battery->max_voltage_mV);
    rig.report.sensor_valid = chance(0.98);
    rig.weakening_a =
        chance(0.8) ? 0.0 : random_real(&source, -0.05, 0.0) * motor->max_phase_current_mA * 1e-3;
}

static void draw_phase(void)
{
    const double top_rad_s = rig.config.motor.max_speed_mrad_s * 1e-3;
    phase.left_ms = chance(0.6) ? between(1, 300) : between(300, 5000);
    phase.wild = chance(0.1);
    phase.left_ms = phase.wild ? between(1, 200) : phase.left_ms;
    phase.lively = chance(0.3);
    phase.feedback = has_feedback && chance(0.9);
    phase.acceleration_rad_s2 = chance(0.4) ? 0.0 : random_real(&source, -0.4, 0.1) * top_rad_s;
    phase.acceleration_rad_s2 *= rig.speed_rad_s >= 0.0 ? 1.0 : -1.0;
    if (chance(0.1)) {
        rig.speed_rad_s = random_real(&source, -0.3, 1.1) * top_rad_s;
    }
    rig.in.demand.enable = chance(0.97);
    rig.in.demand_age_ms = chance(0.85) ? 0 : (uint32_t)between(0, 150);
    phase.saves = rig.in.demand_age_ms > 0; /* no message comes in this phase */
    draw_demand();
    if (chance(0.6)) {
        draw_limits();
    }
    reference.quiet_ms = 0;
}

static void draw_anything(void)
{
    slow_input_t *in = &rig.in;
    in->demand.drive_torque_mNm = random_wild(&source);
    in->demand.brake_torque_mNm = random_wild(&source);
    in->demand.direction = (drive_direction_t)between(0, 2);
    in->demand.abs_active = chance(0.3);
    in->demand_age_ms = (uint32_t)between(0, 150);
    in->bms.charge_current_mA = random_wild(&source);
    in->bms.charge_peak_current_mA = random_wild(&source);
    in->bms.discharge_current_mA = random_wild(&source);
    in->hydraulic.torque_mNm = random_wild(&source);
    in->hydraulic.age_ms = has_feedback ? (uint32_t)between(0, 200) : 1000000U;
    in->hydraulic.valid = has_feedback && chance(0.9);
    in->temperature.winding_cC = chance(0.1) ? random_wild(&source) : between(-3000, 16000);
    in->temperature.switch_cC = chance(0.1) ? random_wild(&source) : between(-3000, 12000);
    rig.speed_rad_s += random_real(&source, -0.02, 0.02) * rig.config.motor.max_speed_mrad_s * 1e-3;
    rig.report.sensor_valid = chance(0.9);
    rig.bus_v = random_real(&source, 0.0, 1.2) * rig.config.battery.max_voltage_mV * 1e-3;
    reference.quiet_ms = 0;
}

/* A report each 20 ms, as old as the sensor and the bus make it. */
static void feed_back(void)
{
    hydraulic_feedback_t *feedback = &rig.in.hydraulic;
    const int32_t delay_ms = rig.config.brake.hydraulic_report_delay_ms;
    if (step_number % 20 == delay_ms) {
        feedback->torque_mNm = phase.report_mNm;
        feedback->age_ms = 0;
        feedback->valid = true;
    } else {
        feedback->age_ms = feedback->age_ms < 1000000U ? feedback->age_ms + 1U : 1000000U;
    }
    if (step_number % 20 == 0) {
        phase.report_mNm = (int32_t)rig.brake.torque_mNm;
    }
}

static void draw_step(void)
{
    if (phase.left_ms-- <= 0) {
        draw_phase();
    }
    if (phase.wild) {
        draw_anything();
        if (phase.left_ms == 0) { /* back to what a vehicle may send */
            draw_demand();
            draw_limits();
        }
    } else {
        if (phase.lively && chance(0.02)) {
            draw_demand();
            reference.quiet_ms = 0;
        }
        rig.in.demand_age_ms = phase.saves ? rig.in.demand_age_ms + 1U : 0U;
        if (phase.feedback) {
            feed_back();
        } else {
            rig.in.hydraulic.age_ms = 1000000;
        }
    }
    const double top_rad_s = 1.1e-3 * rig.config.motor.max_speed_mrad_s;
    rig.speed_rad_s =
        fmin(fmax(rig.speed_rad_s + phase.acceleration_rad_s2 * 1e-3, -0.5 * top_rad_s), top_rad_s);
}

/* ---- the properties ---- */

static int32_t sign_of_speed(void)
{
    return rig.out.speed_mrad_s >= 0 ? 1 : -1;
}

static bool runs(void)
{
    return rig.out.mode == MODE_RUN || rig.out.mode == MODE_LIMP;
}

static int32_t lift_off_mNm(void)
{
    const int64_t along =
        (int64_t)rig.in.demand.drive_torque_mNm * drive_direction_sign(rig.out.direction);
    return rig.in.demand.abs_active ? 0 : q_clamp(q_saturate64(-along), 0, 100000000);
}

static void remember_the_demand(bool lost)
{
    const config_t *config = &rig.config;
    if (!lost) {
        reference.lost_ms = 0;
        reference.kept_mNm = q_clamp(rig.in.demand.brake_torque_mNm, 0, 100000000) + lift_off_mNm();
        return;
    }
    reference.lost_ms++;
    if (reference.lost_ms > config->driver.lost_hold_ms + config->brake.hydraulic_dead_time_ms &&
        config->driver.no_other_brake == 0) {
        /* No slower than the lag of the path that replaces it, or than its rate. */
        const int32_t lag_ms = config->brake.hydraulic_time_constant_ms + 2;
        reference.kept_mNm -=
            q_min(reference.kept_mNm / lag_ms, config->brake.hydraulic_rate_mNm_s / 1000);
    }
}

static void check_driving(bool lost)
{
    const int32_t command_mNm = rig.out.motor_torque_command_mNm;
    const bool none =
        rig.in.demand.brake_torque_mNm > 0 || lost || rig.out.direction == DRIVE_DIRECTION_NEUTRAL;
    /* A speed of zero may be a stuck hall line: what braked before falls at the rate. */
    const bool falls =
        rig.out.speed_mrad_s == 0 && q_abs(command_mNm) <= q_abs(reference.before_mNm);
    if (none) {
        check((int64_t)command_mNm * sign_of_speed() <= 0 || falls, "drives while braking");
    } else {
        counts.drove += command_mNm != 0 ? 1 : 0;
    }
}

/* What a braking demand adds to. */
static int32_t coasting_mNm(void)
{
    return coasting_most_mNm(&rig.config, rig.out.speed_mrad_s,
                             controller_temperatures(&rig.controller.slow).winding_cC);
}

static void check_lost(void)
{
    const int32_t rate_mNm = demand_rate_mNm_per_step(&rig.config);
    const int32_t command_mNm = q_abs(rig.out.motor_torque_command_mNm);
    const int32_t falling_mNm = q_max(q_abs(reference.before_mNm) - rate_mNm, 0);
    const int32_t kept_mNm = reference.kept_mNm;
    const int32_t most_mNm =
        kept_mNm > 0 ? q_max(kept_mNm, coasting_mNm() + kept_mNm / 2) : kept_mNm;
    check(command_mNm <= q_max(falling_mNm, most_mNm), "a lost demand grows");
    if (reference.kept_mNm > 0) {
        counts.lost++;
    }
}

static void check_sign(bool lost)
{
    const wheel_demand_t *demand = &rig.in.demand;
    const bool brakes = lost || reference.kept_mNm > 0;
    const int32_t wanted_mNm = brakes ? -sign_of_speed() * reference.kept_mNm
                                      : q_clamp(demand->drive_torque_mNm, -100000000, 100000000) *
                                            (rig.out.direction == DRIVE_DIRECTION_NEUTRAL ? 0 : 1);
    /* Beside coasting, which goes on after braking. */
    const bool braked =
        reference.before_mNm != 0 && (reference.before_mNm > 0) == (sign_of_speed() < 0);
    const int32_t more_mNm =
        brakes || braked ? q_max(coasting_mNm() - q_abs(wanted_mNm) / 2, 0) : 0;
    const int32_t beside_mNm = wanted_mNm - sign_of_speed() * more_mNm;
    const int32_t low = q_min(q_min(reference.before_mNm, 0), q_min(wanted_mNm, beside_mNm));
    const int32_t high = q_max(q_max(reference.before_mNm, 0), q_max(wanted_mNm, beside_mNm));
    check(rig.out.motor_torque_command_mNm >= low && rig.out.motor_torque_command_mNm <= high,
          "the command leaves what is demanded");
}

static void check_reasons(bool lost)
{
    const slow_output_t *out = &rig.out;
    const int32_t command_mNm = q_abs(out->motor_torque_command_mNm);
    const int32_t drive_mNm = q_limit(rig.in.demand.drive_torque_mNm, 100000000);
    const bool below =
        reference.kept_mNm > 0 ? command_mNm < reference.kept_mNm : command_mNm != q_abs(drive_mNm);
    const bool coasts = reference.kept_mNm == 0 && drive_mNm == 0 && command_mNm <= coasting_mNm();
    if ((below && !coasts) || lost) {
        check(out->torque_reason != REASON_NONE, "no reason");
        counts.reasons++;
    }
    check(out->electric_brake_available_mNm >= rig.config.motor.max_torque_mNm ||
              out->available_reason != REASON_NONE,
          "no reason of what is available");
}

/* Steady inputs for the time that both brakes take. */
static int64_t settling_ms(void)
{
    const config_brake_t *brake = &rig.config.brake;
    const int32_t ramp_ms = rig.config.motor.max_torque_mNm / demand_rate_mNm_per_step(&rig.config);
    return SETTLE_ms + ramp_ms + 2 * brake->bridging_time_ms + brake->abs_hold_ms +
           2 * (brake->hydraulic_dead_time_ms + 6 * brake->hydraulic_time_constant_ms);
}

/* What is over before the hydraulic brake can follow counts as a step of the demand: a fast passage
 * through the blend-out from the hand-over ahead of it on, and the bridge's change of its state. */
static void count_fast_hand_over(void)
{
    const config_brake_t *brake = &rig.config.brake;
    const int64_t answer_ms =
        brake->hydraulic_dead_time_ms + brake->hydraulic_time_constant_ms * 5 / 2 + 50;
    const double slows = fmax(fabs(phase.acceleration_rad_s2), 1e-9); /* mrad/s in a ms */
    const double ahead_ms = (q_abs(rig.out.speed_mrad_s) - brake->blend_out_start_mrad_s) / slows;
    const double passed_ms = (brake->blend_out_start_mrad_s - brake->blend_out_end_mrad_s) / slows;
    const bool fast = ahead_ms <= (double)answer_ms && passed_ms < 2.0 * (double)answer_ms;
    const bool left = rig.report.bridge != reference.bridge; /* beyond the EMF limit it may */
    reference.bridge = rig.report.bridge;
    if ((fast || left) && reference.quiet_ms > 0) {
        const int64_t before_ms = settling_ms() - answer_ms;
        reference.quiet_ms = reference.quiet_ms < before_ms ? reference.quiet_ms : before_ms;
    }
}

static void check_sum(void)
{
    const wheel_demand_t *demand = &rig.in.demand;
    const int32_t most_mNm = rig.config.brake.max_hydraulic_torque_mNm;
    if (demand->brake_torque_mNm <= 0 || demand->drive_torque_mNm != 0 ||
        rig.out.speed_mrad_s == 0) {
        return;
    }
    const int32_t motor_mNm = -sign_of_speed() * rig.out.motor_torque_command_mNm;
    const int32_t demand_mNm = q_min(demand->brake_torque_mNm, most_mNm);
    if (!runs()) {
        /* A shorted motor brakes by itself, and its currents show it. */
        const bool shorted = bridge_is_short(rig.report.bridge);
        const int32_t missing_mNm = demand_mNm - rig.out.hydraulic_torque_mNm;
        check(missing_mNm == 0 || has_feedback || (shorted && missing_mNm > 0),
              "without the motor the hydraulic brake gets less than the demand");
    }
    /* A vehicle that gains speed under the brake finds limits at the rate of its acceleration. */
    const bool slows = phase.acceleration_rad_s2 * sign_of_speed() <= 0.0;
    /* Where no currents exist the bridge is open, and less than brake.shortfall_band is missing. */
    const bool switches = rig.report.bridge == BRIDGE_PWM;
    /* Whose torque it is while it intervenes, the anti-lock system decides. */
    if (slows && switches && !demand->abs_active && reference.quiet_ms > settling_ms() &&
        phase.feedback == has_feedback && rig.config.brake.bridging_time_ms > 0) {
        const double sum_mNm = motor_mNm + rig.brake.torque_mNm;
        const double most_sum_mNm = fmax(demand_mNm, coasting_mNm() + demand_mNm / 2.0);
        const double off_mNm = fmax(fmax(demand_mNm - sum_mNm, sum_mNm - most_sum_mNm), 0.0);
        counts.settled++;
        /* A small demand passes the blend-out of the largest torque in a fraction of its width, and
         * below a 64th of the largest hydraulic torque the gain, 0.8 to 1.2, is not learned. */
        check(off_mNm <= 0.1 * demand_mNm + 0.05 * rig.config.motor.max_torque_mNm ||
                  rig.out.hydraulic_torque_mNm == most_mNm,
              "the brakes together miss the demand");
        const double share = off_mNm / fmax(demand_mNm, most_mNm / 64.0);
        counts.off_square += share * share;
    }
}

static void check_bounds(void)
{
    const slow_output_t *out = &rig.out;
    check(q_abs(out->motor_torque_command_mNm) <= rig.config.motor.max_torque_mNm, "beyond max");
    check(out->hydraulic_torque_mNm >= 0 &&
              out->hydraulic_torque_mNm <= rig.config.brake.max_hydraulic_torque_mNm,
          "hydraulic torque out of range");
    check(runs() || out->motor_torque_command_mNm == 0, "torque outside of RUN and LIMP");
}

static void check_step(void)
{
    const bool lost = rig.in.demand_age_ms > (uint32_t)rig.config.brake.demand_timeout_ms;
    remember_the_demand(lost);
    reference.quiet_ms++;
    count_fast_hand_over();
    check_bounds();
    check_driving(lost);
    check_sign(lost);
    if (lost) {
        check_lost();
    } else {
        check_sum();
    }
    if (runs()) {
        check_reasons(lost);
        counts.ran++;
        counts.braked += reference.kept_mNm > 0 && rig.out.motor_torque_command_mNm != 0 ? 1 : 0;
        reference.idle_ms = 0;
    } else {
        reference.idle_ms++;
    }
    counts.wild += phase.wild ? 1 : 0;
    reference.before_mNm = rig.out.motor_torque_command_mNm;
}

static void live(int64_t steps)
{
    const counts_t none = {.ran = 0};
    counts = none;
    for (step_number = 0; step_number < steps; step_number++) {
        if (step_number % LIFE_STEPS == 0 || reference.idle_ms > DEAD_STEPS) {
            begin_life();
        }
        draw_step();
        slow_rig_step(&rig);
        check_step();
    }
    const double rms = sqrt(counts.off_square / fmax((double)counts.settled, 1.0));
    char text[240];
    snprintf(text, sizeof text,
             "%" PRId64 " steps, %" PRId64 " lives: %" PRId64 " ran, %" PRId64 " braked, %" PRId64
             " drove, %" PRId64 " lost, %" PRId64 " settled, %.2f %% rms, %" PRId64
             " reasons, %" PRId64 " wild",
             steps, counts.lives, counts.ran, counts.braked, counts.drove, counts.lost,
             counts.settled, 100.0 * rms, counts.reasons, counts.wild);
    TEST_MESSAGE(text);
    TEST_ASSERT_TRUE_MESSAGE(rms <= 0.03, text);
}

/* 361: an anti-lock system intervenes. The others: light brakes, to which coasting adds. */
void test_lives_that_once_missed_the_demand_keep_it(void)
{
    static const uint64_t FOUND[] = {361, 20260143, 20260181};
    for (size_t n = 0; n < sizeof FOUND / sizeof FOUND[0]; n++) {
        seed = FOUND[n];
        live(LIFE_STEPS);
    }
}

void test_five_properties_of_the_slow_step_hold_in_random_lives(void)
{
    const int64_t steps = setting("HUBFOC_RANDOM_STEPS", STEPS);
    seed = (uint64_t)setting("HUBFOC_RANDOM_SEED", 1);
    live(steps);
    /* Each property is exercised. */
    TEST_ASSERT_GREATER_THAN_INT64(steps / 2, counts.ran);
    TEST_ASSERT_GREATER_THAN_INT64(steps / 10, counts.braked);
    TEST_ASSERT_GREATER_THAN_INT64(steps / 50, counts.drove);
    TEST_ASSERT_GREATER_THAN_INT64(steps / 100, counts.lost);
    TEST_ASSERT_GREATER_THAN_INT64(steps / 200, counts.settled);
    TEST_ASSERT_GREATER_THAN_INT64(steps / 5, counts.reasons);
}
