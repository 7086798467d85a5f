/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foldback.h: how much current a motor may draw, or return, near the end of the battery's voltage.
 *
 * In the steady state a straight line: all of `most` from `width` inside the end on, nothing at the
 * end itself. As a law from voltage to current that line is a gain of most/width, 214 A/V for the
 * paper's pack. With a pack of 1 ohm and a millisecond of delay it would be bang-bang between
 * nothing and all. So the current moves towards the line instead, from what the motor is asked for
 * now:
 *
 *     e = distance of the voltage from the end - width now/most          (0 on the line)
 *     allowed = now + (now + most/64) e / (8 span),   span = max_voltage - min_voltage
 *
 * The battery answers a current with the voltage R now, which is at most the span: one step moves e
 * by no more than an eighth of itself, whatever the pack's resistance is, and by R most/(512 span)
 * for the part that lets it leave zero (the paper's vehicle is calm up to 3 ohm, where the pack
 * gives 4 A). With two to three milliseconds of delay the loop has a phase margin above 60 degrees.
 * Time constant: 8 ms and more.
 *
 * Two widths inside the end nothing is limited, unless the voltage was nearer within the last half
 * second (foldback_near): a pack that a few amperes take there would otherwise be let go and
 * fetched back for ever. One width beyond the end nothing is allowed. Currents and widths are
 * magnitudes >= 0. For the slow reach: it divides.
 */
#ifndef TORQUE_FOLDBACK_H
#define TORQUE_FOLDBACK_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    int32_t most_mA;  /* away from the end of the voltage */
    int32_t width_mV; /* >= 1 */
    int32_t span_mV;  /* >= 1: the whole range of the battery's voltage */
} foldback_t;

enum { FOLDBACK_NEAR_STEPS = 500 };

/* Is the voltage near its end, or was it lately? steps: 0 at first, kept by the caller. 1 kHz. */
bool foldback_near(uint16_t *steps, int32_t inside_mV, int32_t width_mV);

/* inside_mV: distance of the voltage from its end, positive inside. now_mA: what the motor is asked
 * for now. */
int32_t foldback_current_mA(const foldback_t *foldback, bool near, int32_t inside_mV,
                            int32_t now_mA);

#endif
