/* SPDX-License-Identifier: Apache-2.0 */
#include "drive.h"
#include "bench/link.h"
#include "config/bases.h"

#include <math.h>
#include <string.h>

#include "wiring.h"

enum { NO_CURRENT_CODE = 2048, BOOT_ms = 120 };
static const int64_t HOLD_TICKS = CHIP_TICKS_PER_US / 20;

/* A low-side shunt carries the current of its leg only while the low side conducts; what its
 * amplifier has not settled to is taken as zero. */
static bool shunt_shows_current(drive_t *drive, unsigned phase, uint16_t code)
{
    const wiring_shunts_t shunts = wiring_shunts();
    const int64_t settling = llround(shunts.settling_s * (double)CHIP_TICKS_PER_SECOND);
    if (!shunts.low_side || !shunts.at[phase] ||
        chip_low_side_conducts(drive->chip, phase, code > NO_CURRENT_CODE, settling)) {
        return true;
    }
    drive->lost_currents++;
    return false;
}

static void set_pins(drive_t *drive, const fast_input_t *sensed)
{
    chip_inputs_t *in = chip_inputs(drive->chip);
    uint16_t code[3];
    for (unsigned x = 0; x < 3; x++) {
        const uint16_t flows = sensed->phase_current_code[x];
        code[x] = shunt_shows_current(drive, x, flows) ? flows : (uint16_t)NO_CURRENT_CODE;
    }
    wiring_currents(drive->chip, code);
    wiring_bus_voltage(in, sensed->bus_voltage_code);
    wiring_halls(in, sensed->hall_state);
    in->encoder_count = sensed->encoder.count;
    in->encoder_index_count = sensed->encoder.index_count;
    in->encoder_index = sensed->encoder.index;
    chip_faults(drive->chip)->gate_driver_fault = sensed->power_stage_fault || drive->driver_fails;
}

void drive_begin(drive_t *drive, chip_t *chip, const config_t *config)
{
    const drive_t fresh = {.chip = chip,
                           .period_counts = bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz),
                           .period =
                               CHIP_TICKS_PER_SECOND / (uint32_t)config->drive.pwm_frequency_Hz,
                           .dead_time_ns = (uint32_t)config->drive.dead_time_ns};
    *drive = fresh;
    wiring_full_scales(1e-3 * config->drive.current_full_scale_mA,
                       1e-3 * config->drive.voltage_full_scale_mV);
    vehicle_can_init(&drive->vehicle, link_address(config));
    const fast_input_t at_rest = {
        .phase_current_code = {NO_CURRENT_CODE, NO_CURRENT_CODE, NO_CURRENT_CODE}, .hall_state = 5};
    set_pins(drive, &at_rest);
    wiring_temperatures(chip_inputs(chip), 2500, 2500);
    chip_run(chip, (chip_ticks_t)BOOT_ms * 1000U * CHIP_TICKS_PER_US);
}

static fast_output_t bridge_of(drive_t *drive)
{
    const chip_gates_t gates = chip_gates(drive->chip);
    fast_output_t out = {.bridge = BRIDGE_OFF};
    if (gates.bridge != CHIP_BRIDGE_SWITCHES) {
        return out;
    }
    const uint64_t dead_ns = gates.dead_time_ticks * 1000000000ULL / CHIP_TICKS_PER_SECOND;
    if (dead_ns < drive->dead_time_ns && !drive->reported) {
        drive->reported = true;
        chip_violate(drive->chip, "dead time shorter than configured");
    }
    /* In the middle of the low pulses, to 50 ns. */
    const int64_t late = chip_hold_from_top_ticks(drive->chip) - (int64_t)gates.dead_time_ticks / 2;
    if ((late < -HOLD_TICKS || late > HOLD_TICKS) && !drive->reported) {
        drive->reported = true;
        chip_violate(drive->chip, "currents are not held in the middle of the low pulses");
    }
    bool all_low = true;
    for (int x = 0; x < 3; x++) {
        const double share = (double)gates.high_on_counts[x] / gates.top_counts;
        out.compare_counts[x] = (uint16_t)lround(share * drive->period_counts);
        all_low = all_low && gates.high_on_counts[x] == 0;
    }
    out.bridge = all_low ? BRIDGE_SHORT : BRIDGE_PWM;
    drive->switching_periods++;
    return out;
}

static fast_output_t period(void *context, const fast_input_t *in)
{
    drive_t *drive = context;
    /* A quarter more than a period: triggers come once in each. */
    const bool sampled = chip_run_to_sample(drive->chip, drive->period + drive->period / 4U);
    set_pins(drive, in);
    if (sampled) {
        chip_sample(drive->chip);
        drive->periods_without_sample = 0;
    } else {
        drive->periods_without_sample++;
    }
    return bridge_of(drive);
}

static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    drive_t *drive = context;
    wiring_temperatures(chip_inputs(drive->chip), in->temperature.winding_cC,
                        in->temperature.switch_cC);
    drive->vehicle.queued_count = 0;
    if (drive->exchange != NULL) {
        drive->exchange(drive, in);
    } else {
        vehicle_can_send(&drive->vehicle, in);
    }
    for (uint32_t i = 0; i < drive->vehicle.queued_count; i++) {
        const messages_frame_t *queued = &drive->vehicle.queued[i];
        chip_frame_t frame = {.identifier = queued->identifier, .length = queued->length};
        memcpy(frame.data, queued->data, sizeof frame.data);
        chip_send(drive->chip, &frame);
    }
    drive->vehicle.now_ms++;
    chip_frame_t sent;
    while (chip_receive(drive->chip, &sent)) {
        messages_frame_t frame = {.identifier = (uint16_t)sent.identifier, .length = sent.length};
        memcpy(frame.data, sent.data, sizeof frame.data);
        if (sent.identifier < CHIP_EXTENDED) {
            vehicle_can_receive(&drive->vehicle, &frame);
        }
        if (drive->seen != NULL) {
            drive->seen(&sent);
        }
    }
    vehicle_can_expire(&drive->vehicle);
    return drive->vehicle.received;
}

wheel_coupling_t drive_coupling(drive_t *drive)
{
    const wheel_coupling_t coupling = {
        .context = drive, .period = period, .millisecond = millisecond};
    return coupling;
}
