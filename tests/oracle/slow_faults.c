/* SPDX-License-Identifier: Apache-2.0 */
#include "slow_faults.h"

#include "numbers.h"

enum { SENSOR_BROKEN_cC = 29999, SENSOR_SHORTED_cC = -9000 };

bool fault_is_present(const fault_t *fault, int32_t step)
{
    return step >= fault->begin && step < fault->end;
}

static void fault_of_currents(const fault_t *fault, surrogate_fault_t *now)
{
    switch (fault->kind) {
    case FAULT_CURRENT_GAIN:
        now->current_gain = fault->amount < 0.0 ? 1.0 + 0.6 * fault->amount : 1.0 + fault->amount;
        break;
    case FAULT_OPEN_PHASE:
        now->open_phase = 1 + fault->number % 3;
        now->open_share = fault->amount < 0.0 ? 1.0 : 1.0 - 0.5 * fault->amount;
        break;
    case FAULT_NO_CURRENT:
        now->no_current = true;
        break;
    case FAULT_EXTRA_TORQUE:
        now->extra_torque = 0.5 * fault->amount;
        break;
    case FAULT_NAMED_SENSOR:
        now->wrong_sensor = 1 + fault->number % 3;
        break;
    case FAULT_UNDETERMINED:
        now->undetermined = true;
        break;
    case FAULT_CURRENT_SUM:
        now->current_sum_pu = (int32_t)(40000.0 * fault->amount);
        break;
    case FAULT_OFFSETS:
        now->offset_codes = (int32_t)(600.0 * fault->amount);
        break;
    default:
        break;
    }
}

static void fault_of_rotor(const fault_t *fault, int32_t step, surrogate_fault_t *now)
{
    switch (fault->kind) {
    case FAULT_ROTOR_INVALID:
        now->rotor_invalid = true;
        break;
    case FAULT_ROTOR_FAULTS:
        now->rotor_faults = step % (1 + fault->number % 20) == 0;
        now->rotor_invalid = now->rotor_faults && fault->amount > 0.5;
        break;
    case FAULT_ROTOR_SLIPPED:
        now->sensor_turn = 0.5 * fault->amount;
        break;
    case FAULT_ROTOR_FROZEN:
        now->sensor_turn = fault->amount + 0.013 * (step - fault->begin);
        now->sensor_speed = 0.0;
        break;
    case FAULT_ROTOR_REVERSED:
        now->sensor_turn = fault->amount + 0.026 * (step - fault->begin);
        now->sensor_speed = -1.0;
        break;
    case FAULT_OBSERVER_LOST:
        now->observer_lost = true;
        break;
    case FAULT_OBSERVER_WRONG:
        now->observer_speed = 2.0 * fault->amount;
        break;
    case FAULT_FLUX:
        now->flux_share = 1.0 + 0.6 * fault->amount;
        break;
    default:
        break;
    }
}

static void fault_of_bus(const fault_t *fault, int32_t step, surrogate_fault_t *now)
{
    switch (fault->kind) {
    case FAULT_BUS_SENSOR:
        now->bus_gain = 1.0 + 0.9 * fault->amount;
        break;
    case FAULT_BUS_VOLTAGE:
        now->bus_share = 1.0 + 0.9 * fault->amount;
        break;
    case FAULT_BUS_SWINGS:
        now->bus_share = 1.0 + (step / (1 + fault->number % 4) % 2 == 0 ? 0.3 : -0.3);
        break;
    case FAULT_CONTACTOR:
    case FAULT_CONTACTOR_SILENT:
        now->battery_open = true;
        break;
    default:
        break;
    }
}

static void fault_of_program(const fault_t *fault, int32_t step, surrogate_fault_t *now)
{
    static const reason_t TRIPS[] = {REASON_OVERCURRENT, REASON_BUS_OVERVOLTAGE,
                                     REASON_HARDWARE_BREAK, REASON_CURRENT_SENSOR,
                                     REASON_BUS_SENSOR};
    switch (fault->kind) {
    case FAULT_TRIP:
        now->trip = step == fault->begin || fault->amount > 0.5
                        ? TRIPS[fault->number % (int32_t)(sizeof TRIPS / sizeof TRIPS[0])]
                        : REASON_NONE;
        break;
    case FAULT_TRIP_DAMAGED:
        now->trip = (reason_t)(fault->number % 128);
        break;
    case FAULT_PERIODS:
        now->periods = (int32_t)(25.0 * fault->amount);
        break;
    case FAULT_WILD_REPORT:
        now->wild = step % (1 + fault->number % 8) == 0;
        break;
    case FAULT_BRAKE_GAIN:
        now->brake_gain = 1.0 + 0.7 * fault->amount;
        break;
    case FAULT_BRAKE_DEAD:
        now->brake_gain = 0.0;
        break;
    case FAULT_BRAKE_STUCK:
        now->brake_stuck = true;
        break;
    case FAULT_BRAKE_LATE:
        now->brake_delay_ms = fault->number % 300;
        break;
    default:
        break;
    }
}

void fault_of_wheel(const fault_t *fault, int32_t step, surrogate_fault_t *now)
{
    fault_of_currents(fault, now);
    fault_of_rotor(fault, step, now);
    fault_of_bus(fault, step, now);
    fault_of_program(fault, step, now);
}

static int32_t sum_of(int32_t a, double b)
{
    return numbers_whole(a + b);
}

void fault_of_inputs(const fault_t *fault, int32_t step, const config_t *config, slow_input_t *in)
{
    switch (fault->kind) {
    case FAULT_CONTACTOR:
        in->bms.contactor = CONTACTOR_OPEN;
        break;
    case FAULT_WINDING_SENSOR:
        in->temperature.winding_cC = fault->amount > 0.0 ? SENSOR_BROKEN_cC : SENSOR_SHORTED_cC;
        break;
    case FAULT_SWITCH_SENSOR:
        in->temperature.switch_cC = fault->amount > 0.0 ? SENSOR_BROKEN_cC : SENSOR_SHORTED_cC;
        break;
    case FAULT_WINDING_HOT:
        in->temperature.winding_cC =
            config->motor.max_winding_temperature_cC + (int32_t)(3000.0 * fault->amount);
        break;
    case FAULT_SWITCH_HOT:
        in->temperature.switch_cC =
            config->drive.max_switch_temperature_cC + (int32_t)(3000.0 * fault->amount);
        break;
    case FAULT_SELFTEST:
        in->selftest_passed = false;
        break;
    case FAULT_CONFIGURATION:
        in->config_accepted = false;
        break;
    case FAULT_REPORT_WRONG:
        in->hydraulic.torque_mNm = sum_of(in->hydraulic.torque_mNm, 1e5 * fault->amount);
        break;
    case FAULT_REPORT_LOST:
        in->hydraulic.valid = in->hydraulic.valid && fault->amount > 0.0;
        break;
    case FAULT_DEMAND_REASON: {
        static const reason_t REASONS[] = {REASON_ACCELERATOR_LOCKED, REASON_BRAKE_PRIORITY,
                                           REASON_ACCELERATOR_SENSOR, REASON_BRAKE_PEDAL_SENSOR,
                                           REASON_DEMAND_IMPLAUSIBLE};
        in->demand.reason = REASONS[fault->number % (int32_t)(sizeof REASONS / sizeof REASONS[0])];
        break;
    }
    case FAULT_ANTI_LOCK:
        in->demand.abs_active = step / (1 + fault->number % 60) % 2 == 0;
        in->demand.abs_motor_share_percent =
            (uint8_t)(fault->amount > 0.0 ? fault->number % 120 : 0);
        break;
    case FAULT_BATTERY_FULL:
        in->bms.charge_current_mA = 0;
        break;
    case FAULT_BATTERY_EMPTY:
        in->bms.discharge_current_mA = 0;
        break;
    case FAULT_BATTERY_CURRENT:
        in->bms.current_mA = sum_of(in->bms.current_mA, 2e5 * fault->amount);
        break;
    default:
        break;
    }
}
