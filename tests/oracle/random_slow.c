/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_slow FIRST END: random lives of the slow step, each from controller_init() on. Entries
 * FIRST to the one before END, of RUNS_AN_ENTRY runs each.
 *
 * A run draws a configuration, a vehicle, and phases: what the driver wants, what the battery
 * permits, what the road does, how warm it is. In most runs faults come and go; in some phases
 * every number is any number. Setpoint and commands go back into the vehicle (surrogate.h).
 */
#include <stdio.h>
#include <stdlib.h>

#include "configurations.h"
#include "controller/controller.h"
#include "numbers.h"
#include "program.h"
#include "slow_life.h"

enum { RUNS_AN_ENTRY = 25, FRAME_ms = 10 };

static void any_input(life_t *life)
{
    slow_input_t *in = &life->in;
    random_t *random = &life->random;
    in->demand.drive_torque_mNm = random_wild(random);
    in->demand.brake_torque_mNm = random_wild(random);
    in->demand.direction = life_drawn_direction(life);
    in->demand.abs_active = chance(life, 300);
    in->demand.abs_motor_share_percent = (uint8_t)between(life, 0, 255);
    in->demand.fault_reset = chance(life, 300);
    in->demand_age_ms =
        chance(life, 800) ? (uint32_t)between(life, 0, 150) : (uint32_t)random_wild(random);
    in->bms.charge_current_mA = random_wild(random);
    in->bms.discharge_current_mA = random_wild(random);
    in->bms.charge_peak_current_mA = random_wild(random);
    in->bms.voltage_mV = random_wild(random);
    in->bms.current_mA = random_wild(random);
    in->bms.current_given = chance(life, 500);
    in->hydraulic.torque_mNm = random_wild(random);
    in->hydraulic.age_ms = (uint32_t)between(life, 0, 200);
    in->hydraulic.valid = chance(life, 700);
    in->temperature.winding_cC = between(life, -20000, 40000);
    in->temperature.switch_cC = between(life, -20000, 40000);
}

static bool has_fault(const life_t *life, int32_t kind)
{
    for (int32_t k = 0; k < life->faults; k++) {
        if (life->fault[k].kind == kind && fault_is_present(&life->fault[k], life->step)) {
            return true;
        }
    }
    return false;
}

static int32_t towards(int32_t now, int32_t to, int32_t most)
{
    const int64_t apart = (int64_t)to - now;
    return apart > most ? now + most : apart < -most ? now - most : to;
}

static void send_demand(life_t *life)
{
    wheel_demand_t *demand = &life->in.demand;
    const bool released = life->step < life->release_ms;
    const int32_t drive_mNm = released ? 0 : life->drive_to_mNm;
    const int32_t brake_mNm = released ? 0 : life->brake_to_mNm;
    const bool lost = has_fault(life, FAULT_DEMAND_LOST);
    if (!lost && --life->demand_left_ms <= 0) {
        life->demand_left_ms = FRAME_ms;
        life->in.demand_age_ms = 0;
        demand->drive_torque_mNm =
            towards(demand->drive_torque_mNm, drive_mNm, FRAME_ms * life->drive_ramp_mNm);
        demand->brake_torque_mNm =
            towards(demand->brake_torque_mNm, brake_mNm, FRAME_ms * life->brake_ramp_mNm);
        demand->fault_reset = life->out.mode == MODE_FAULT ? chance(life, 500) : chance(life, 20);
        demand->abs_active = false;
        demand->abs_motor_share_percent = 0;
        demand->reason = REASON_NONE;
    } else {
        life->in.demand_age_ms++;
    }
}

static void send_brake_report(life_t *life)
{
    hydraulic_feedback_t *feedback = &life->in.hydraulic;
    feedback->age_ms = feedback->age_ms < 1000000U ? feedback->age_ms + 1U : 1000000U;
    if (life->has_brake_reports && --life->report_left_ms <= 0) {
        life->report_left_ms = 2 * FRAME_ms;
        const bool lost = has_fault(life, FAULT_REPORT_LOST);
        if (!lost) {
            feedback->torque_mNm = life->report_mNm;
            feedback->age_ms = 0;
            feedback->valid = true;
        }
        life->report_mNm = numbers_whole(life->wheel.brake_nm * 1e3);
    }
}

static void send_inputs(life_t *life)
{
    slow_input_t *in = &life->in;
    const config_battery_t *battery = &life->config.battery;
    in->config_accepted = life->step >= life->boot_ms;
    in->selftest_passed = life->step >= life->selftest_ms;
    in->temperature.winding_cC = life->winding_cC + between(life, -5, 5);
    in->temperature.switch_cC = life->switch_cC + between(life, -5, 5);
    if (life->step % 7 == 0) { /* losses warm it */
        const double load = life->wheel.i_q_a / life->wheel.current_base_a;
        const double shown = has_fault(life, FAULT_SLOW_SENSORS) ? life->fault[0].amount : 1.0;
        const double rise_cC = 400.0 * load * load * numbers_size(shown);
        life->winding_cC = numbers_within(life->winding_cC + rise_cC, -9000, 29000);
        life->switch_cC = numbers_within(life->switch_cC + 0.5 * rise_cC, -9000, 29000);
    }
    if (in->bms.contactor == CONTACTOR_OPEN) {
        in->bms.contactor = CONTACTOR_CLOSED;
    }
    if (life->step % FRAME_ms == 0) {
        in->bms.voltage_mV = numbers_whole(
            (life->wheel.battery_v - life->wheel.battery_ohm * life->wheel.bus_a) * 1e3);
        in->bms.current_given = life->gives_current;
        in->bms.current_mA = numbers_whole(life->wheel.bus_a * battery->driven_wheels * 1e3);
    }
    send_demand(life);
    send_brake_report(life);
    for (int32_t k = 0; k < life->faults; k++) {
        const fault_t *fault = &life->fault[k];
        if (fault_is_present(fault, life->step)) {
            fault_of_inputs(fault, life->step, &life->config, in);
            if (fault->kind == FAULT_WILD_INPUT && life->step % (1 + fault->number % 8) == 0) {
                any_input(life);
            }
        }
    }
}

static void step_life(life_t *life)
{
    if (life->phase_left_ms-- <= 0) {
        life_draw_phase(life);
    }
    surrogate_fault_t now = surrogate_healthy();
    for (int32_t k = 0; k < life->faults; k++) {
        if (fault_is_present(&life->fault[k], life->step)) {
            fault_of_wheel(&life->fault[k], life->step, &now);
        }
    }
    surrogate_step(&life->wheel, &life->setpoint, &life->out, &now, &life->random);
    send_inputs(life);
    life->out = controller_slow_step(&life->controller.slow, &life->config, &life->wheel.report,
                                     &life->in, &life->setpoint);
}

int main(int count, char **arguments)
{
    if (count < 3 || !program_begin(count, arguments, 3, 0)) {
        fprintf(stderr, "usage: random_slow FIRST END [OPTION...]\n");
        return 2;
    }
    const int first = atoi(arguments[1]);
    const int end = atoi(arguments[2]);
    static life_t life;
    for (int entry = first; entry < end; entry++) {
        const int index = entry % CONFIGURATIONS;
        for (int run = 0; run < RUNS_AN_ENTRY; run++) {
            life_begin(&life, configuration_shipped(index),
                       (uint64_t)entry * RUNS_AN_ENTRY + (uint64_t)run);
            for (life.step = 0; life.step < life.steps; life.step++) {
                step_life(&life);
            }
        }
        char name[40];
        snprintf(name, sizeof name, "%s %d", configuration_name(index), entry);
        program_entry(name);
    }
    program_end();
    return 0;
}
