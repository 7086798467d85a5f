/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/bench.h"

#include <math.h>
#include <stddef.h>

#include "plant/numbers.h"

enum {
    MILLI = 1000,
    LOST_S = 1000000,
    /* Of random numbers; of wheels from 0, of their brakes from 2000 on. */
    BATTERY_STREAM = 1000,
    DEMAND_STREAM = 1001
};
static const double SLOW_STEP_S = 1.0 / CONTROLLER_SLOW_RATE_HZ;
static const double ROUNDING =
    1e-6; /* of a slow step: periods and milliseconds are counted, not added up */
/* The run-up: long enough for self-test and offset calibration, gentle enough for the rotor
 * estimate to follow. */
static const double BOOT_LIMIT_S = 3.0;
static const double RUN_UP_M_PER_S2 = 15.0;
static const double SETTLE_S = 0.5;

static motion_t moving(bench_t *bench)
{
    const motion_t out = {.vehicle = &bench->vehicle,
                          .chassis = &bench->chassis,
                          .wheels = bench->wheel,
                          .worlds = bench->world_of,
                          .count = bench->wheels};
    return out;
}

static void flip_config_bit(bench_t *bench, uint32_t bit)
{
    if (bit > 0U) {
        unsigned char *bytes = (unsigned char *)&bench->config;
        bytes[(bit - 1U) / 8U % sizeof(bench->config)] ^= (unsigned char)(1U << (bit - 1U) % 8U);
    }
}

void bench_refresh(bench_t *bench)
{
    const uint32_t bit = (uint32_t)bench->params.fault.config_bit;
    if (bit != bench->flipped_config_bit) {
        flip_config_bit(bench, bench->flipped_config_bit);
        flip_config_bit(bench, bit);
        bench->flipped_config_bit = bit;
        const config_watch_t fresh = {.at_bytes = 0};
        bench->config_watch = fresh;
        if (bench->processor != NULL) {
            bench->processor->configure(bench->processor->context, &bench->config);
        }
    }
    bench->world = wheel_world(&bench->params, &bench->config);
    bench->world.config_damaged = bench->config_watch.damaged;
    if (bench->first_rear < bench->wheels) {
        bench->rear_world = wheel_world(&bench->rear_params, &bench->rear_config);
    }
    bench->road = motion_world(&bench->params, bench->world.step_s);
    for (int k = 0; k < bench->wheels; k++) {
        bench->world_of[k] = k < bench->first_rear ? &bench->world : &bench->rear_world;
        wheel_refresh(&bench->wheel[k], bench->world_of[k]);
    }
}

static double kinetic_energy_j(const bench_t *bench)
{
    return motion_kinetic_energy_j(&bench->road, &bench->vehicle, bench->wheel, bench->wheels);
}

static void begin_accounts(bench_t *bench)
{
    const ledger_t empty = {.chemical_j = 0.0};
    bench->booked = empty;
    bench->braking = empty;
    bench->is_braking = false;
    bench->battery = battery_init(&bench->params.battery, bench->world.step_s);
    bench->bus = bus_init(&bench->battery);
    bench->bus_peak_v = bench->bus.voltage_v;
    bench->bus_before_j = bus_stored_j(&bench->params.bus, &bench->bus);
    bench->driver = driver_init();
    /* Controllers that booted before the run have had demands of a driver with his feet off. */
    const bool never_sent =
        bench->params.run.boots_rolling > 0.5 && bench->params.driver.silent > 0.5;
    bench->demand_age_s = never_sent ? LOST_S : 0.0;
    bench->demand_due_s = 0.0;
    bench->demand_random = random_init((uint64_t)bench->params.run.seed, DEMAND_STREAM);
    bench->period = 0;
    bench->time_s = 0.0;
    bench->slow_steps = 0;
    bench->vehicle.distance_m = 0.0;
    bench->vehicle.height_m = 0.0;
    const chassis_state_t level = {.filtered_m_per_s2 = 0.0};
    bench->chassis = level;
    const motion_t motion = moving(bench);
    motion_roll(&bench->road, &motion);
    abs_unit_begin(&bench->abs_unit, &bench->params, bench->wheel, bench->wheels);
    const bms_state_t none_sent = {
        .random = random_init((uint64_t)bench->params.run.seed, BATTERY_STREAM)};
    bench->limits = none_sent;
    bench->kinetic_before_j = kinetic_energy_j(bench);
    bench->magnetic_before_j = 0.0;
    for (int k = 0; k < bench->wheels; k++) {
        wheel_begin(&bench->wheel[k], bench->world_of[k]);
        bench->magnetic_before_j +=
            pmsm_magnetic_energy_j(&bench->wheel[k].machine, &bench->wheel[k].rotor);
    }
}

void bench_init(bench_t *bench, const bench_params_t *params, const config_t *config,
                const driver_trace_t *trace)
{
    const bench_t empty = {.wheels = 0};
    *bench = empty;
    bench->params = *params;
    bench->config = *config;
    bench->trace = *trace;
    bench->pieces = (int)plant_max(floor(params->run.pieces), 1.0);
    bench->wheels = (int)plant_clamp(floor(params->vehicle.driven_wheels), 1.0, BENCH_WHEELS_MAX);
    bench->first_rear = BENCH_WHEELS_MAX;
    bench_refresh(bench);
    bench->cockpit = cockpit_init();
    for (int k = 0; k < bench->wheels; k++) {
        wheel_init(&bench->wheel[k], bench->world_of[k], k);
    }
    begin_accounts(bench);
}

/* Those of the vehicle, with the sections of another drive. */
static bench_params_t with_drive(const bench_params_t *vehicle, const bench_params_t *drive)
{
    bench_params_t out = *vehicle;
    out.motor = drive->motor;
    out.inverter = drive->inverter;
    out.brake = drive->brake;
    out.brake_sensor = drive->brake_sensor;
    out.sensors = drive->sensors;
    out.encoder = drive->encoder;
    out.thermal = drive->thermal;
    out.winding_sensor = drive->winding_sensor;
    out.switch_sensor = drive->switch_sensor;
    return out;
}

void bench_set_rear(bench_t *bench, const bench_params_t *params, const config_t *config)
{
    bench->rear_params = with_drive(&bench->params, params);
    bench->rear_config = *config;
    bench->first_rear = bench->road.chassis.first_rear;
    bench_refresh(bench);
    for (int k = bench->first_rear; k < bench->wheels; k++) {
        wheel_init(&bench->wheel[k], bench->world_of[k], k);
    }
    begin_accounts(bench);
}

const config_t *bench_config_of(const bench_t *bench, int wheel)
{
    return bench->world_of[wheel]->config;
}

void bench_use_processor(bench_t *bench, const processor_t *processor)
{
    bench->processor = processor;
    processor->configure(processor->context, &bench->config);
    processor->begin(processor->context, bench->wheels);
    for (int k = 0; k < bench->wheels; k++) {
        bench->wheel[k].processor = processor;
    }
}

double bench_wheel_speed_rad_s(const bench_t *bench)
{
    return bench->vehicle.speed_m_per_s / bench->params.vehicle.wheel_radius_m;
}

/* The demand changes with the slow step only, so the accounts are updated only when braking begins
 * or ends. */
static void note_braking(bench_t *bench)
{
    const bool brakes = bench->demand.brake_nm > 0.0;
    if (brakes == bench->is_braking) {
        return;
    }
    const ledger_t now = bench_ledger(bench);
    if (brakes) {
        bench->braking_since = now;
    } else {
        bench->braking = bench_braking_ledger(bench, &now);
    }
    bench->is_braking = brakes;
}

static bool has_pedals(const bench_t *bench)
{
    return bench->params.driver.uses_pedals > 0.5;
}

/* The pedals give the demand; what comes by CAN, and its age, is one of their inputs. */
static void press_pedals(bench_t *bench)
{
    driver_params_t feet = bench->params.driver;
    if (bench->speed_prescribed) {
        feet.accelerator = 0.0;
        feet.brake_pedal = 0.0;
    }
    const wheel_demand_t received = {
        .drive_torque_mNm = (int32_t)lround(bench->demand.drive_nm * MILLI),
        .brake_torque_mNm = (int32_t)lround(bench->demand.brake_nm * MILLI),
        .direction = (drive_direction_t)feet.direction,
        .enable = bench->speed_prescribed || feet.enable > 0.5,
    };
    cockpit_step(&bench->cockpit, &bench->config, &feet, &bench->params.pedal_sensors, &received,
                 bench->demand_age_s);
    bench->demand.drive_nm = bench->cockpit.out.demand.drive_torque_mNm / (double)MILLI;
    bench->demand.brake_nm = bench->cockpit.out.demand.brake_torque_mNm / (double)MILLI;
}

/* Of the mean torque of all wheels, what this one is to make. */
static double share_of(const bench_t *bench, int wheel)
{
    const bool front = wheel < bench->road.chassis.first_rear;
    const double bias = bench->params.driver.front_bias;
    return front ? 1.0 + bias : 1.0 - bias;
}

/* The order of one wheel: its share of the pedals, or the message, of which all get the same but
 * for the torque. */
static wheel_order_t order_of(const bench_t *bench, const wheel_order_t *message, int wheel)
{
    wheel_order_t out = *message;
    const double share = share_of(bench, wheel);
    out.drive_nm *= share;
    out.brake_nm *= share;
    out.pedal_nm *= share;
    if (has_pedals(bench)) {
        const pedals_output_t *pedals = &bench->cockpit.out;
        const wheel_demand_t own =
            pedals_wheel_demand(&bench->config, &pedals->demand, wheel % CONFIG_WHEELS);
        out.drive_nm = own.drive_torque_mNm / (double)MILLI;
        out.brake_nm = own.brake_torque_mNm / (double)MILLI;
        out.direction = own.direction;
        out.enable = own.enable;
        out.demand_reason = own.reason;
        out.demand_age_s = pedals->age_ms == UINT32_MAX ? LOST_S : pedals->age_ms / (double)MILLI;
    }
    return out;
}

static bool contactor_is_open(const bench_t *bench)
{
    const double bounce_s = bench->params.fault.contactor_bounce_s;
    return bench->params.bus.contactor_open > 0.5 ||
           (bounce_s > 0.0 && bench->params.bus.capacitance_f > 0.0 &&
            fmod(bench->time_s, 2.0 * bounce_s) < bounce_s);
}

/* The brake pedal as the brake system itself sees it, also while no demand is sent. */
static double pedal_nm(const bench_t *bench)
{
    const driver_params_t *driver = &bench->params.driver;
    if (has_pedals(bench)) {
        return cockpit_brake_nm(&bench->config, driver);
    }
    return driver->follow_trace > 0.5 ? bench->demand.brake_nm : driver->brake_demand_nm;
}

/* The controllers get the driver's demand with its message. */
static void send_demand(bench_t *bench, const driver_demand_t *demand)
{
    const driver_params_t *driver = &bench->params.driver;
    bench->demand_age_s += SLOW_STEP_S;
    if (bench->time_s + ROUNDING * SLOW_STEP_S >= bench->demand_due_s) {
        const double longer_s =
            driver->demand_jitter_s > 0.0
                ? driver->demand_jitter_s * random_uniform(&bench->demand_random)
                : 0.0;
        bench->demand = *demand;
        bench->demand_age_s = driver->demand_age_s;
        bench->demand_due_s = bench->time_s + driver->demand_period_s + longer_s;
    }
}

static void slow_step(bench_t *bench)
{
    const bench_params_t *params = &bench->params;
    if (bench->speed_prescribed) {
        bench->demand_age_s = 0.0;
        const driver_demand_t feet_off = {.reference_m_per_s = bench->vehicle.speed_m_per_s};
        bench->demand = feet_off;
    } else if (params->driver.silent > 0.5) {
        bench->demand_age_s += SLOW_STEP_S;
    } else {
        const driver_demand_t demand =
            driver_step(&params->driver, &bench->driver, &bench->trace, &bench->road.vehicle,
                        bench->wheels, bench->vehicle.speed_m_per_s, bench->time_s, SLOW_STEP_S);
        send_demand(bench, &demand);
    }
    if (has_pedals(bench)) {
        press_pedals(bench);
    }
    note_braking(bench);
    abs_unit_step(&bench->abs_unit, &bench->world, bench->wheel, bench->wheels, &bench->vehicle,
                  bench->demand.brake_nm, bench->time_s, SLOW_STEP_S);
    const bms_limits_t limits = bms_step(&params->bms, &bench->limits, &params->battery,
                                         &bench->battery, contactor_is_open(bench), bench->time_s);
    const wheel_order_t order = {
        .drive_nm = bench->demand.drive_nm,
        .brake_nm = bench->demand.brake_nm,
        .charge_limit_a = limits.charge_a,
        .discharge_limit_a = limits.discharge_a,
        .peak_charge_a = limits.peak_charge_a,
        .pack_voltage_v = limits.voltage_v,
        .pack_current_a = limits.current_a,
        .pack_current_given = limits.current_given,
        .contactor = bench->limits.contactor,
        .demand_age_s = bench->demand_age_s,
        .current_drift_a =
            bench->speed_prescribed ? 0.0 : params->sensors.current_drift_a_per_s * bench->time_s,
        .bus_voltage_v = bench->bus.voltage_v,
        .time_s = bench->time_s,
        .direction = (drive_direction_t)params->driver.direction,
        .pedal_nm = params->driver.own_brake_path > 0.5 ? pedal_nm(bench) : 0.0,
        .enable = bench->speed_prescribed || params->driver.enable > 0.5,
        .abs_active = !bench->speed_prescribed &&
                      (params->driver.abs_active > 0.5 || bench->abs_unit.anti_lock.at_work),
        .abs_motor_share = params->driver.abs_motor_share,
        .fault_reset = !bench->speed_prescribed && driver_resets(&params->driver, bench->time_s),
    };
    if (bench->flipped_config_bit > 0U) {
        bench->world.config_damaged = config_watch_step(&bench->config_watch, &bench->config);
    }
    for (int k = 0; k < bench->wheels; k++) {
        const wheel_order_t own = order_of(bench, &order, k);
        wheel_slow(&bench->wheel[k], bench->world_of[k], &own);
    }
}

/* A vehicle with an external speed. */
static motion_flow_t carry(bench_t *bench, const wheel_flow_t *flow)
{
    const motion_flow_t out = {.road = {.mean_speed_m_per_s = bench->vehicle.speed_m_per_s}};
    const double speed_rad_s = bench_wheel_speed_rad_s(bench);
    for (int k = 0; k < bench->wheels; k++) {
        bench->wheel[k].motion.speed_rad_s = speed_rad_s;
        wheel_settle(&bench->wheel[k], bench->world_of[k], &flow[k], speed_rad_s, 0.0);
    }
    return out;
}

static void book(ledger_t *ledger, const bus_flow_t *bus, const motion_flow_t *motion,
                 double kinetic_loss_j)
{
    ledger->chemical_j += bus->battery.chemical_j;
    ledger->battery_j += bus->battery.heat_j;
    ledger->cable_j += bus->cable_j;
    ledger->tyre_j += motion->tyre_j;
    ledger->drag_j += motion->road.drag_j;
    ledger->rolling_j += motion->road.rolling_j;
    ledger->climbed_j += motion->road.climbed_j;
    ledger->turned_over_j += plant_max(bus->battery.chemical_j, 0.0) +
                             plant_max(kinetic_loss_j, 0.0) +
                             plant_max(-motion->road.climbed_j, 0.0);
}

/* Battery and bus with their faults. */
static bus_flow_t feed_bus(bench_t *bench, double dc_j)
{
    const bench_params_t *params = &bench->params;
    const fault_params_t *fault = &params->fault;
    bus_params_t bus = params->bus;
    bus.cable_resistance_ohm += fault->cable_rise * (params->bus.cable_resistance_ohm +
                                                     params->battery.series_resistance_ohm);
    bus.contactor_open = contactor_is_open(bench) ? 1.0 : 0.0;
    if (fault->cell_rise > 0.0) {
        battery_params_t battery = params->battery;
        battery.series_resistance_ohm *= 1.0 + fault->cell_rise;
        return bus_step(&bus, &bench->bus, &battery, &bench->battery, dc_j);
    }
    return bus_step(&bus, &bench->bus, &params->battery, &bench->battery, dc_j);
}

/* The plant alone, world.step_s long. */
static void advance(bench_t *bench)
{
    motion_t motion = moving(bench);
    wheel_flow_t flow[BENCH_WHEELS_MAX];
    double dc_j = 0.0;
    for (int k = 0; k < bench->wheels; k++) {
        const double speed_rad_s =
            bench->speed_prescribed
                ? bench_wheel_speed_rad_s(bench)
                : motion_expected_rad_s(&bench->road, &motion, k, bench->world.step_s);
        flow[k] =
            wheel_step(&bench->wheel[k], bench->world_of[k], speed_rad_s, bench->bus.voltage_v);
        dc_j += flow[k].dc_j;
    }
    const bus_flow_t bus = feed_bus(bench, dc_j);
    bench->bus_peak_v = plant_max(bench->bus_peak_v, bench->bus.voltage_v);
    const double kinetic_j = kinetic_energy_j(bench);
    const motion_flow_t moved =
        bench->speed_prescribed ? carry(bench, flow) : motion_step(&bench->road, &motion, flow);
    book(&bench->booked, &bus, &moved, kinetic_j - kinetic_energy_j(bench));
}

void bench_begin_period(bench_t *bench)
{
    if (bench->time_s * CONTROLLER_SLOW_RATE_HZ + ROUNDING >= (double)bench->slow_steps) {
        bench->slow_steps++;
        slow_step(bench);
    }
    for (int k = 0; k < bench->wheels; k++) {
        wheel_sample(&bench->wheel[k], bench->world_of[k], bench->bus.voltage_v);
    }
}

void bench_end_period(bench_t *bench)
{
    for (int k = 0; k < bench->pieces; k++) {
        advance(bench);
    }
    if (bench->processor != NULL) {
        for (int k = 0; k < bench->wheels; k++) {
            wheel_t *wheel = &bench->wheel[k];
            bench->processor->finish(bench->processor->context, k, &wheel->next,
                                     &wheel->controller);
        }
    }
    bench->period++;
    bench->time_s = (double)bench->period * bench->world.step_s * bench->pieces;
}

void bench_period(bench_t *bench)
{
    bench_begin_period(bench);
    bench_end_period(bench);
}

static bool all_run(const bench_t *bench)
{
    bool out = true;
    for (int k = 0; k < bench->wheels; k++) {
        const operating_mode_t mode = bench->wheel[k].slow.mode;
        out = out && (mode == MODE_RUN || mode == MODE_LIMP);
    }
    return out;
}

static void run_at_prescribed_speed(bench_t *bench, double acceleration_m_per_s2, double duration_s)
{
    const double until_s = bench->time_s + duration_s;
    while (bench->time_s < until_s) {
        bench_period(bench);
        bench->vehicle.speed_m_per_s += acceleration_m_per_s2 * bench->world.step_s * bench->pieces;
    }
}

/* Standing, unless the controllers wait for the index of an encoder: then a turn a second. */
static double boot_speed_m_per_s(const bench_t *bench)
{
    bool turns = false;
    for (int k = 0; k < bench->wheels; k++) {
        turns = turns || bench_config_of(bench, k)->rotor.sensor == CONFIG_ROTOR_ENCODER;
    }
    return turns ? PLANT_TWO_PI * bench->params.vehicle.wheel_radius_m : 0.0;
}

static bool is_resolved(const bench_t *bench)
{
    bool out = true;
    for (int k = 0; k < bench->wheels; k++) {
        const wheel_t *wheel = &bench->wheel[k];
        out = out && pmsm_is_resolved(&wheel->machine, wheel->inverter.pwm_resistance_ohm,
                                      bench->world.step_s);
    }
    return out;
}

bench_start_t bench_start(bench_t *bench)
{
    const bench_params_t *params = &bench->params;
    if (!is_resolved(bench)) {
        return BENCH_UNRESOLVED;
    }
    if (params->run.boots_rolling > 0.5) {
        bench->vehicle.speed_m_per_s = params->run.initial_speed_m_per_s;
        begin_accounts(bench);
        return BENCH_READY;
    }
    bench->speed_prescribed = true;
    bench->vehicle.speed_m_per_s = boot_speed_m_per_s(bench);
    while (!all_run(bench)) {
        if (bench->time_s > BOOT_LIMIT_S) {
            return BENCH_NOT_RUN;
        }
        bench_period(bench);
    }
    const double speed = params->run.initial_speed_m_per_s;
    const double run_up = speed - bench->vehicle.speed_m_per_s;
    if (run_up != 0.0) {
        run_at_prescribed_speed(bench, run_up > 0.0 ? RUN_UP_M_PER_S2 : -RUN_UP_M_PER_S2,
                                fabs(run_up) / RUN_UP_M_PER_S2);
        bench->vehicle.speed_m_per_s = speed;
        run_at_prescribed_speed(bench, 0.0, SETTLE_S);
    }
    if (!all_run(bench)) {
        return BENCH_NOT_RUN;
    }
    bench->speed_prescribed = false;
    begin_accounts(bench);
    return BENCH_READY;
}

bool bench_has_ended(const bench_t *bench)
{
    const double initial = bench->params.run.initial_speed_m_per_s;
    const double speed =
        initial >= 0.0 ? bench->vehicle.speed_m_per_s : -bench->vehicle.speed_m_per_s;
    return bench->params.run.stop_at_standstill > 0.5 && bench->period > 0 && speed <= 0.0;
}

ledger_t bench_ledger(const bench_t *bench)
{
    ledger_t out = bench->booked;
    for (int k = 0; k < bench->wheels; k++) {
        const wheel_t *wheel = &bench->wheel[k];
        out.shaft_j += wheel->totals.shaft_j;
        out.copper_j += wheel->totals.copper_j;
        out.iron_j += wheel->totals.iron_j;
        out.conduction_j += wheel->totals.conduction_j;
        out.diode_j += wheel->totals.diode_j;
        out.switching_j += wheel->totals.switching_j;
        out.bearing_j += wheel->totals.bearing_j;
        out.hydraulic_j += wheel->totals.hydraulic_j;
        out.magnetic_j += pmsm_magnetic_energy_j(&wheel->machine, &wheel->rotor);
    }
    out.magnetic_j -= bench->magnetic_before_j;
    out.kinetic_j = kinetic_energy_j(bench) - bench->kinetic_before_j;
    out.polarisation_j = battery_stored_j(&bench->params.battery, &bench->battery);
    out.bus_j = bus_stored_j(&bench->params.bus, &bench->bus) - bench->bus_before_j;
    out.residual_j = ledger_residual_j(&out);
    return out;
}

ledger_t bench_braking_ledger(const bench_t *bench, const ledger_t *now)
{
    ledger_t out = bench->braking;
    if (bench->is_braking) {
        ledger_add_change(&out, now, &bench->braking_since);
    }
    return out;
}
