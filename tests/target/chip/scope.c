/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The wheel's scope in the flashable image, set and uploaded by XCP on CAN.
 *
 *     chip_scope ELF
 *
 * Exit code 0: the record of a current step is what the host gave to the chip's pins in each PWM
 * period, bit for bit.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comms/xcp.h"
#include "core/signals.h"
#include "rig.h"

/* Places in the table by its names. */
#define OUTPUT_PLACE(name, ...) OUTPUT_##name,
#define INPUT_PLACE(name, ...) INPUT_##name,
#define FAST_OUTPUT_PLACE(name, ...) FAST_OUTPUT_##name,
#define FAST_INPUT_PLACE(name, ...) FAST_INPUT_##name,
enum {
    SIGNALS_SLOW_OUTPUTS(OUTPUT_PLACE) SIGNALS_SLOW_INPUTS(INPUT_PLACE)
        SIGNALS_FAST_OUTPUTS(FAST_OUTPUT_PLACE) SIGNALS_FAST_INPUTS(FAST_INPUT_PLACE) PLACES
};

enum {
    BYTES = 8,
    ROWS = 400,
    BEFORE = 100,
    ROW_BYTES = 2 + 2 + 2 + 2 + 1,
    PART_BYTES = 7,
    TRACE = 4000,
    STEP_mNm = 30000
};
static const double ANSWER_s = 0.002, WAIT_s = 0.06, DEMAND_NM = 60.0;

static struct {
    wheel_coupling_t through;
    fast_input_t trace[TRACE];
    unsigned periods;
    bool ends;
    uint8_t answer[BYTES];
    bool answered;
    uint8_t record[ROWS * ROW_BYTES];
} scope;

static fast_output_t period(void *context, const fast_input_t *in)
{
    if (!scope.ends) {
        scope.trace[scope.periods % TRACE] = *in;
        scope.periods++;
    }
    return scope.through.period(context, in);
}

static uint16_t identifier(void)
{
    return (uint16_t)(rig.config.service.can_base + rig.config.vehicle.wheel_position);
}

static void see_frame(const chip_frame_t *frame)
{
    if (frame->identifier == identifier() + (uint32_t)CONFIG_WHEELS) {
        memcpy(scope.answer, frame->data, BYTES);
        scope.answered = true;
    }
}

static bool ask(uint8_t code, uint8_t count, uint32_t word)
{
    chip_frame_t frame = {.identifier = identifier(), .length = BYTES, .data = {code, count}};
    const unsigned at = code == 0xF0 ? 2 : 4; /* DOWNLOAD */
    for (unsigned i = 0; i < sizeof word; i++) {
        frame.data[at + i] = (uint8_t)(word >> 8U * i);
    }
    scope.answered = false;
    chip_send(rig.chip, &frame);
    for (int tries = 0; tries < 5 && !scope.answered; tries++) {
        run(ANSWER_s);
    }
    return expect(scope.answered && scope.answer[0] == 0xFF, "XCP answers");
}

static bool put(size_t offset, int32_t value)
{
    return ask(0xF6, 0, XCP_SCOPE_ADDRESS + (uint32_t)offset) && ask(0xF0, 4, (uint32_t)value);
}

static uint32_t get(size_t offset)
{
    (void)ask(0xF4, 4, XCP_SCOPE_ADDRESS + (uint32_t)offset);
    return scope.answer[1] | (uint32_t)scope.answer[2] << 8 | (uint32_t)scope.answer[3] << 16 |
           (uint32_t)scope.answer[4] << 24;
}

static bool arm(void)
{
    static const int32_t CHANNELS[] = {FAST_INPUT_phase_a_a, FAST_INPUT_phase_b_a,
                                       FAST_INPUT_phase_c_a, FAST_INPUT_bus_voltage_v,
                                       FAST_INPUT_hall_state};
    bool good = ask(0xFF, 0, 0);
    for (size_t k = 0; k < sizeof CHANNELS / sizeof CHANNELS[0]; k++) {
        good = good && put(offsetof(scope_page_t, signal) + 4U * k, CHANNELS[k]);
    }
    return good && put(offsetof(scope_page_t, trigger), SCOPE_RISES) &&
           put(offsetof(scope_page_t, trigger_signal), INPUT_brake_torque_nm) &&
           put(offsetof(scope_page_t, level), STEP_mNm) &&
           put(offsetof(scope_page_t, before_rows), BEFORE) &&
           put(offsetof(scope_page_t, rows), ROWS) && put(offsetof(scope_page_t, run), 1);
}

static bool upload(void)
{
    bool good = ask(0xF6, 0, XCP_RECORD_ADDRESS);
    for (unsigned at = 0; good && at < sizeof scope.record; at += PART_BYTES) {
        const unsigned left = (unsigned)sizeof scope.record - at;
        const unsigned count = left < PART_BYTES ? left : PART_BYTES;
        good = ask(0xF5, (uint8_t)count, 0);
        memcpy(&scope.record[at], &scope.answer[1], count);
    }
    return good;
}

static uint16_t half(const uint8_t *at)
{
    return (uint16_t)(at[0] | at[1] << 8);
}

static bool equal(const uint8_t *row, const fast_input_t *in)
{
    return half(row) == in->phase_current_code[0] && half(row + 2) == in->phase_current_code[1] &&
           half(row + 4) == in->phase_current_code[2] && half(row + 6) == in->bus_voltage_code &&
           row[8] == in->hall_state;
}

static unsigned most_equal(unsigned first)
{
    unsigned most = 0;
    for (unsigned from = scope.periods - TRACE; from + ROWS < scope.periods; from++) {
        unsigned same = 0;
        while (same < ROWS && equal(&scope.record[(first + same) % ROWS * ROW_BYTES],
                                    &scope.trace[(from + same) % TRACE])) {
            same++;
        }
        most = same > most ? same : most;
    }
    return most;
}

static bool records_a_step(void)
{
    bool good = arm();
    run(WAIT_s);
    good = good && expect(get(offsetof(scope_page_t, phase)) == SCOPE_ARMED, "it waits");
    rig.bench.params.driver.brake_demand_nm = DEMAND_NM;
    run(WAIT_s);
    scope.ends = true;
    good = good && expect(get(offsetof(scope_page_t, phase)) == SCOPE_COMPLETE, "it triggers") &&
           expect(get(offsetof(scope_page_t, row_bytes)) == ROW_BYTES, "bytes of a row");
    const unsigned first = get(offsetof(scope_page_t, first_row));
    good = good && upload();
    const unsigned same = most_equal(first);
    int before = 0, after = 0;
    for (unsigned row = 0; row < ROWS; row++) {
        const int beside = abs(half(&scope.record[(first + row) % ROWS * ROW_BYTES]) - 2048);
        before = row < BEFORE && beside > before ? beside : before;
        after = row >= BEFORE && beside > after ? beside : after;
    }
    printf("%u of %d rows are the host's; largest current before the step %d codes, then %d\n",
           same, ROWS, before, after);
    return good && expect(same == ROWS, "the record is the host's trace") &&
           expect(after > 5 * before, "it is a step");
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_scope ELF\n");
        return 2;
    }
    bool good = open_rig(argv[1]);
    if (good) {
        boot();
        rig.drive.seen = see_frame;
        scope.through = rig.coupling;
        rig.coupling.period = period;
        good = expect(drive_off(&rig.coupling), "comes to RUN") && records_a_step();
    }
    good = good && expect(rig.bench.wheel[0].first_fault == REASON_NONE, "runs without a fault") &&
           obeys_the_manuals();
    return rig_result(good, NULL);
}
