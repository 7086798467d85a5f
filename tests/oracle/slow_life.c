/* SPDX-License-Identifier: Apache-2.0 */
#include "slow_life.h"

#include "config/bases.h"
#include "configurations.h"
#include "numbers.h"

static const uint64_t SEED = 2013;

/* ---- a run ---- */

static void draw_faults(life_t *life)
{
    life->faults = chance(life, 250) ? 0 : between(life, 1, LIFE_FAULTS_MOST);
    for (int32_t k = 0; k < life->faults; k++) {
        fault_t *fault = &life->fault[k];
        fault->kind = between(life, 0, FAULT_KINDS - 1);
        fault->begin = fault->kind == FAULT_OFFSETS ? 0 : between(life, 0, life->steps);
        const int32_t lasts = chance(life, 300)   ? life->steps
                              : chance(life, 500) ? between(life, 1, 30)
                                                  : between(life, 30, 400);
        fault->end = fault->begin + lasts;
        fault->amount = real(life, -1.0, 1.0);
        fault->number = (int32_t)(random_bits(&life->random) >> 33);
    }
}

/* Which study, and the fault in it. */
static int32_t drawn_study(life_t *life)
{
    static const int32_t BRAKES[] = {FAULT_BRAKE_GAIN, FAULT_BRAKE_DEAD, FAULT_BRAKE_STUCK,
                                     FAULT_BRAKE_LATE, FAULT_REPORT_WRONG};
    static const int32_t HEAT[] = {FAULT_WINDING_SENSOR, FAULT_SWITCH_SENSOR, FAULT_SLOW_SENSORS};
    static const int32_t SHORT[] = {FAULT_TRIP, FAULT_BUS_VOLTAGE, FAULT_CONTACTOR};
    const int32_t kind = between(life, 0, 99);
    if (kind < 35) {
        life->study = STUDY_BRAKE;
        life->steps = between(life, 2000, 8000);
        return BRAKES[between(life, 0, 4)];
    }
    if (kind < 50) {
        life->study = STUDY_HEAT;
        life->steps = between(life, 2000, 12000);
        return HEAT[between(life, 0, 2)];
    }
    life->steps = between(life, 800, 2500);
    if (kind < 62) {
        life->study = STUDY_SENSORS;
        return FAULT_CURRENT_GAIN;
    }
    if (kind < 70) {
        life->study = STUDY_FLUX;
        return FAULT_FLUX;
    }
    if (kind < 85) {
        life->study = STUDY_SHORT;
        return SHORT[between(life, 0, 2)];
    }
    life->study = STUDY_HOLD;
    return FAULT_DEMAND_LOST;
}

/* A field of the configuration, if it is accepted so. */
static void configure(life_t *life, int32_t *field, int32_t value)
{
    const int32_t before = *field;
    *field = value;
    if (!configuration_is_accepted(&life->config)) {
        *field = before;
        (void)configuration_is_accepted(&life->config);
    }
}

static void begin_study(life_t *life)
{
    config_t *config = &life->config;
    fault_t *fault = &life->fault[0];
    fault->kind = drawn_study(life);
    life->faults = 1;
    fault->begin =
        life->study == STUDY_BRAKE ? between(life, 100, life->steps) : between(life, 100, 400);
    fault->end = chance(life, 500) ? life->steps : between(life, fault->begin, life->steps);
    fault->amount = real(life, -1.0, 1.0);
    fault->number = between(life, 0, 1 << 20);
    life->release_ms = 50;
    double share = real(life, 0.3, 0.9); /* of the largest speed */
    if (life->study == STUDY_BRAKE) {
        life->has_brake_reports = chance(life, 600);
        life->wheel.mass_share = real(life, 0.7, 1.4);
    } else if (life->study == STUDY_SENSORS) {
        configure(life, &config->battery.driven_wheels, 1);
        life->gives_current = true;
        fault->amount *= chance(life, 500) ? 0.5 : 1.0; /* near what is tolerated */
    } else if (life->study == STUDY_SHORT) {
        share = real(life, 0.8, 1.5);
        life->wheel.battery_v = real(life, 0.9, 1.1) * config->battery.min_voltage_mV * 1e-3;
        configure(life, &config->drive.bus_capacitance_nF, between(life, 100000, 5000000));
    } else if (life->study == STUDY_HOLD) {
        share = chance(life, 500) ? 0.0 : real(life, -0.1, 0.1);
        configure(life, &config->driver.hold_torque_mNm,
                  between(life, 0, config->brake.max_hydraulic_torque_mNm));
    }
    life->wheel.speed_rad_s = share * config->motor.max_speed_mrad_s * 1e-3;
}

static int32_t drawn_length(life_t *life)
{
    const int32_t kind = between(life, 0, 99);
    return kind < 80 ? between(life, 150, 600) : kind < 97 ? between(life, 600, 1200) : 3000;
}

void life_begin(life_t *life, const config_t *shipped, uint64_t number)
{
    const life_t fresh = {.random = random_for(SEED, number),
                          .in.demand.direction = DRIVE_DIRECTION_FORWARD};
    *life = fresh;
    life->config = *shipped;
    if (chance(life, 600)) {
        configuration_vary(&life->config, &life->random, 12);
    }
    surrogate_init(&life->wheel, &life->config, &life->random);
    life->wheel.speed_rad_s =
        chance(life, 400) ? 0.0
                          : real(life, -0.3, 1.0) * life->config.motor.max_speed_mrad_s * 1e-3;
    controller_init(&life->controller, &life->config, BASES_MODEL_TIMER_Hz);
    life->setpoint = controller_initial_setpoint(&life->config, BASES_MODEL_TIMER_Hz);
    life->steps = drawn_length(life);
    life->boot_ms = chance(life, 900) ? between(life, 0, 5) : between(life, 0, 200);
    life->selftest_ms = life->boot_ms + (chance(life, 950) ? between(life, 0, 10) : 1000);
    life->release_ms = chance(life, 900) ? between(life, 30, 80) : 0;
    life->has_brake_reports = chance(life, 500);
    life->gives_current = chance(life, 700);
    life->winding_cC = between(life, -1000, 6000);
    life->switch_cC = between(life, -1000, 5000);
    life->in.hydraulic.age_ms = 1000000;
    draw_faults(life);
    if (chance(life, 400)) {
        begin_study(life);
    }
}

/* ---- a phase ---- */

/* The draws of an expression have no order in C, so each has a statement of its own. */
static int32_t drawn_torque_mNm(life_t *life, int32_t most_mNm)
{
    const int32_t torque_mNm = between(life, 0, most_mNm);
    return chance(life, 500) ? torque_mNm / 4 : torque_mNm;
}

drive_direction_t life_drawn_direction(life_t *life)
{
    static const drive_direction_t ANY[] = {DRIVE_DIRECTION_FORWARD, DRIVE_DIRECTION_REVERSE,
                                            DRIVE_DIRECTION_NEUTRAL};
    return ANY[between(life, 0, 2)];
}

static void draw_demand(life_t *life)
{
    const int32_t most_mNm = life->config.motor.max_torque_mNm;
    const int32_t kind = between(life, 0, 9);
    life->drive_to_mNm = 0;
    life->brake_to_mNm = 0;
    if (kind < 3 || kind == 9) {
        life->drive_to_mNm = drawn_torque_mNm(life, most_mNm * 5 / 4);
    }
    if ((kind >= 3 && kind < 8) || kind == 9) {
        life->brake_to_mNm = drawn_torque_mNm(life, 2 * most_mNm);
    }
    if (chance(life, 60)) {
        life->drive_to_mNm = -life->drive_to_mNm; /* lift-off braking */
    }
    wheel_demand_t *demand = &life->in.demand;
    if (chance(life, 150)) {
        demand->direction = life_drawn_direction(life);
    } else if (life->wheel.speed_rad_s != 0.0) {
        demand->direction =
            life->wheel.speed_rad_s > 0.0 ? DRIVE_DIRECTION_FORWARD : DRIVE_DIRECTION_REVERSE;
    }
    if (demand->direction == DRIVE_DIRECTION_REVERSE) {
        life->drive_to_mNm = -life->drive_to_mNm;
    }
    const int32_t ramp_ms = chance(life, 300) ? 1 : between(life, 5, 200);
    life->drive_ramp_mNm = most_mNm / ramp_ms + 1;
    life->brake_ramp_mNm = 2 * most_mNm / ramp_ms + 1;
    demand->enable = chance(life, 970);
}

static void draw_battery(life_t *life)
{
    const config_battery_t *battery = &life->config.battery;
    const int32_t wheels = battery->driven_wheels;
    const int32_t charge_mA = battery->max_charge_current_mA / 1000 * wheels;
    const int32_t discharge_mA = battery->max_discharge_current_mA / 1000 * wheels;
    battery_limits_t *bms = &life->in.bms;
    bms->charge_current_mA = chance(life, 100) ? 0 : between(life, 0, 2000) * charge_mA;
    bms->discharge_current_mA = chance(life, 50) ? 0 : between(life, 100, 2000) * discharge_mA;
    bms->charge_peak_current_mA = chance(life, 500) ? 0 : between(life, 0, 2000) * charge_mA;
    bms->contactor = (contactor_t)between(life, 0, 1);
}

static void draw_road(life_t *life)
{
    const double top_rad_s = life->config.motor.max_speed_mrad_s * 1e-3;
    life->wheel.road_rad_s2 = chance(life, 500) ? 0.0 : real(life, -0.5, 0.5) * top_rad_s;
    if (chance(life, 100)) { /* comes to rest */
        life->wheel.road_rad_s2 = -life->wheel.speed_rad_s * 5.0;
    }
    if (chance(life, 50)) {
        life->wheel.speed_rad_s = real(life, -0.3, 1.1) * top_rad_s;
    }
}

static void draw_temperatures(life_t *life)
{
    life->winding_cC = between(life, -2000, life->config.motor.max_winding_temperature_cC + 300);
    life->switch_cC = between(life, -2000, life->config.drive.max_switch_temperature_cC + 300);
}

/* Steps of the motor's torque, which show the vehicle's inertia, and then stops, hard and soft. */
static void draw_phase_of_brake(life_t *life, int32_t most_mNm)
{
    const bool drives = life->step < life->steps / 3;
    const int32_t share = 1 << 2 * between(life, 0, 2);
    if (drives) {
        life->phase_left_ms = between(life, 100, 600);
        life->drive_to_mNm = chance(life, 600) ? between(life, most_mNm / 4, most_mNm) : 0;
    } else if (chance(life, 700)) {
        life->brake_to_mNm = between(life, most_mNm / 4, 2 * most_mNm) / share;
    } else {
        life->drive_to_mNm = chance(life, 500) ? between(life, 0, most_mNm) : 0;
    }
    life->wheel.road_rad_s2 = chance(life, 200) ? real(life, -1.0, 1.0) : 0.0;
}

/* Nearly enough braking torque for the road, and starts on it. */
static void draw_phase_of_hold(life_t *life, int32_t most_mNm)
{
    const double road_nm = real(life, -0.5e-3, 0.5e-3) * most_mNm;
    life->wheel.road_rad_s2 = road_nm / life->wheel.inertia_kg_m2;
    if (chance(life, 600)) {
        const double wide = chance(life, 500) ? 1.0 : 0.2;
        const double share = 1.14 + wide * real(life, -0.5, 0.5); /* that of hill_hold.c */
        life->brake_to_mNm = (int32_t)(numbers_size(road_nm) * share * 1e3);
    } else if (chance(life, 600)) {
        life->drive_to_mNm = between(life, 0, most_mNm);
    }
}

/* Down through the speeds at which a short circuit begins and ends. */
static void draw_phase_of_short(life_t *life, int32_t most_mNm)
{
    const double speed_rad_s = life->wheel.speed_rad_s;
    life->wheel.road_rad_s2 = -real(life, -0.1, 0.8) * speed_rad_s;
    life->brake_to_mNm = chance(life, 300) ? between(life, 0, most_mNm) : 0;
    life->in.demand.enable = chance(life, 800);
}

/* Long phases of one thing. */
static void draw_phase_of_study(life_t *life)
{
    const int32_t most_mNm = life->config.motor.max_torque_mNm;
    const bool begins = life->step < life->release_ms;
    life->phase_left_ms = begins ? life->release_ms : between(life, 200, 1200);
    life->in.demand.enable = true;
    life->in.demand.direction = DRIVE_DIRECTION_FORWARD;
    life->drive_ramp_mNm = most_mNm / 20 + 1;
    life->brake_ramp_mNm = most_mNm / 20 + 1;
    life->wheel.road_rad_s2 = 0.0;
    life->drive_to_mNm = 0;
    life->brake_to_mNm = 0;
    if (life->study == STUDY_BRAKE) {
        draw_phase_of_brake(life, most_mNm);
    } else if (life->study == STUDY_HOLD) {
        draw_phase_of_hold(life, most_mNm);
    } else if (life->study == STUDY_SHORT) {
        draw_phase_of_short(life, most_mNm);
    } else if (chance(life, 500)) {
        life->brake_to_mNm = between(life, most_mNm / 4, 2 * most_mNm);
        life->drive_to_mNm = 0;
    } else {
        life->drive_to_mNm = between(life, most_mNm / 2, most_mNm);
    }
    draw_battery(life);
}

static void draw_any_phase(life_t *life)
{
    life->phase_left_ms = chance(life, 700) ? between(life, 1, 120) : between(life, 120, 600);
    draw_demand(life);
    draw_road(life);
    if (chance(life, 400) || life->step == 0) {
        draw_battery(life);
    }
    if (chance(life, 80)) {
        draw_temperatures(life);
    }
    if (life->out.mode == MODE_FAULT && chance(life, 600)) { /* the driver wants to go on */
        life->wheel.speed_rad_s = 0.0;
        life->wheel.road_rad_s2 = 0.0;
        life->drive_to_mNm = 0;
        life->brake_to_mNm = 0;
    }
}

void life_draw_phase(life_t *life)
{
    if (life->study == STUDY_NONE) {
        draw_any_phase(life);
    } else {
        draw_phase_of_study(life);
    }
}
