/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of app, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* app/recorder.h */
POST(recorder_init, recorder->memory == memory && recorder->fault_before == REASON_NONE &&
     recorder->now_ms == 0)
POST(recorder_init, memory->fast_next < RECORDER_FAST_ENTRIES && memory->slow_next <
     RECORDER_SLOW_ENTRIES && is_within(memory->phase, RECORDER_RECORDING, RECORDER_SEALED) &&
     memory->phase != RECORDER_ENDING)
POST(recorder_init, recorder->takes_samples == (memory->phase == RECORDER_RECORDING))
POST(recorder_init, memory->phase != RECORDER_COMPLETE || memory->after_reset == 1 ||
     old(memory->phase) == RECORDER_COMPLETE)
POST(recorder_init, old(memory->phase) != RECORDER_SEALED || memory->phase == RECORDER_RECORDING ||
     memory->reason == old(memory->reason))

PRE(recorder_counted, index < RECORDER_FIRST_START)
POST(recorder_counted, index >= RECORDER_FIRST_LOW || (uint32_t)result == RECORDER_FIRST_COUNTED +
     index)

POST(recorder_expect_restart, recorder->memory->phase == old(recorder->memory->phase) ||
     (old(recorder->memory->phase) == RECORDER_RECORDING && recorder->memory->phase ==
     RECORDER_EMPTY && !recorder->takes_samples))
POST(recorder_expect_restart, recorder->memory->phase != RECORDER_RECORDING &&
     recorder->memory->reason == old(recorder->memory->reason))

PRE(recorder_fast, memory->fast_next < RECORDER_FAST_ENTRIES)
POST(recorder_fast, memory->fast_next == (old(memory->fast_next) + 1) % RECORDER_FAST_ENTRIES)
POST(recorder_fast, memory->fast[old(memory->fast_next)].rotor == sample->rotor)

PRE(recorder_slow, recorder->memory->fast_next < RECORDER_FAST_ENTRIES &&
     recorder->memory->slow_next < RECORDER_SLOW_ENTRIES && recorder->memory->phase <=
     RECORDER_SEALED && (recorder->memory->phase != RECORDER_ENDING ||
     is_within(recorder->slow_left_ms, 1, RECORDER_SLOW_AFTER_ms)))
POST(recorder_slow, recorder->memory->fast_next < RECORDER_FAST_ENTRIES &&
     recorder->memory->slow_next < RECORDER_SLOW_ENTRIES && recorder->memory->phase <=
     RECORDER_SEALED && (recorder->memory->phase != RECORDER_ENDING ||
     is_within(recorder->slow_left_ms, 1, RECORDER_SLOW_AFTER_ms)))
POST(recorder_slow, recorder->memory->phase >= old(recorder->memory->phase) &&
     recorder->memory->fast_next == old(recorder->memory->fast_next))
POST(recorder_slow, recorder->memory->reason == old(recorder->memory->reason) ||
     (old(recorder->memory->phase) == RECORDER_RECORDING && recorder->memory->reason ==
     (uint8_t)output->fault_reason))
POST(recorder_slow, old(recorder->memory->phase) != RECORDER_RECORDING || (recorder->memory->phase
     == RECORDER_RECORDING) == (output->fault_reason == REASON_NONE || output->fault_reason ==
     old(recorder->fault_before)))
POST(recorder_slow, is_within(old(recorder->memory->phase), RECORDER_RECORDING, RECORDER_ENDING) ||
     recorder->memory->slow_next == old(recorder->memory->slow_next))

POST(recorder_seal, result == (old(recorder->memory->phase) == RECORDER_COMPLETE))
POST(recorder_seal, recorder->memory->phase == (result ? RECORDER_SEALED :
     old(recorder->memory->phase)) && recorder->memory->reason == old(recorder->memory->reason))
