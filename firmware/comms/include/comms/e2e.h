/* SPDX-License-Identifier: Apache-2.0 */
/*
 * e2e.h: end-to-end protection of eight-byte frames, as AUTOSAR's profiles 5 and 2.
 *
 * Profile 5, of every message to the wheel and of its command to the hydraulic brake:
 *
 *     byte 0, 1        CRC-16, polynomial 0x1021, initial 0xFFFF, of bytes 2 .. 7 and the data id,
 *                      version * 2048 + identifier; low byte first
 *
 *     byte 2           counter, one more with every frame, 255 is followed by 0
 *
 * Profile 2, of what the wheel only reports:
 *
 *     byte 0           CRC-8, polynomial 0x2F, initial and final 0xFF, of bytes 1 .. 7 and one
 *                      data id
 *
 *     byte 1, bit 0-3  counter, 15 is followed by 0
 *
 * The data id is never sent, so a frame under another message's or another wheel's identifier, or
 * of another version of the protocol, is refused. Numbers of both: generated/protection.h. What
 * they detect: DERIVATIONS, Detected errors.
 *
 * The receiver, one for each received message:
 *
 *     NO_DATA -> QUALIFYING -> VALID      first frame; third frame in order
 *     VALID -> QUALIFYING                     a step of the counter by more than step_max
 *     QUALIFYING, VALID -> TIMED_OUT          no frame to be used for timeout_ms
 *     TIMED_OUT -> QUALIFYING                 the next frame that is intact
 *
 * Only frames received in VALID may be used. A repeated counter does not restart the timeout, so a
 * sender whose counter is stuck times out like one that sends no frames. Time comes from the
 * caller, wraps, and only differences count. The specification is AUTOSAR FO "E2E Protocol
 * Specification" (PRS_E2EProtocol); the numbers of frames are ours.
 */
#ifndef COMMS_E2E_H
#define COMMS_E2E_H

#include <stdbool.h>
#include <stdint.h>

enum {
    E2E_FRAME_BYTES = 8,
    E2E_STEP_MAX = 3,         /* of the counter: two frames in a row may be lost */
    E2E_QUALIFYING_FRAMES = 3 /* in order, the last of them is the first to be used */
};

typedef enum { E2E_PROFILE_2, E2E_PROFILE_5 } e2e_profile_t;

/* On CAN and in the shell; the numbers are part of the protocol. */
typedef enum { E2E_NO_DATA = 0, E2E_QUALIFYING = 1, E2E_VALID = 2, E2E_TIMED_OUT = 3 } e2e_link_t;

typedef enum {
    E2E_OK,             /* to be used */
    E2E_SOME_LOST,      /* to be used; one or two frames before it were lost */
    E2E_NOT_QUALIFIED,  /* in order, but the sender is not qualified yet */
    E2E_REPEATED,       /* the counter is that of the frame before */
    E2E_WRONG_SEQUENCE, /* the counter jumped */
    E2E_IMPLAUSIBLE,    /* intact, but the caller's check failed; counts as lost */
    E2E_DAMAGED         /* CRC or identifier wrong */
} e2e_status_t;

/* Since the start; they wrap. */
typedef struct {
    uint32_t used;
    uint32_t lost; /* missing according to the counter; includes damaged frames */
    uint32_t repeated;
    uint32_t wrong_sequence;
    uint32_t implausible;
    uint32_t damaged;
    uint32_t timeouts;
} e2e_counts_t;

typedef struct {
    e2e_profile_t profile;
    e2e_link_t link;
    uint32_t timeout_ms;
    uint32_t step_max; /* of the counter; E2E_STEP_MAX unless the caller sets another */
    /* Time of the last frame that was used, or of the first one after a timeout. */
    uint32_t refreshed_ms;
    uint8_t counter;  /* of the last frame that was intact and not a repetition */
    uint8_t in_order; /* frames since the order was last broken, up to E2E_QUALIFYING_FRAMES */
    e2e_counts_t counts;
} e2e_receiver_t;

/* Writes counter and CRC into a frame whose other content is complete. */
void e2e_protect(e2e_profile_t profile, uint8_t data[E2E_FRAME_BYTES], uint16_t identifier,
                 uint8_t counter);

/* True if the CRC matches this content and identifier. */
bool e2e_intact(e2e_profile_t profile, const uint8_t data[E2E_FRAME_BYTES], uint16_t identifier);

/* The counter in a frame. */
uint8_t e2e_counter(e2e_profile_t profile, const uint8_t data[E2E_FRAME_BYTES]);

/* timeout_ms: at most ten cycle times, because after sixteen the counter has wrapped and shows no
 * gap. */
void e2e_receiver_init(e2e_receiver_t *receiver, e2e_profile_t profile, uint32_t timeout_ms);

/* Background context, for each received frame. plausible: the caller's check of length and
 * content; true where there is none. */
e2e_status_t e2e_receive(e2e_receiver_t *receiver, const uint8_t data[E2E_FRAME_BYTES],
                         uint16_t identifier, bool plausible, uint32_t now_ms);

/* Background context, every pass, with or without a frame. True once: when the timeout expires. */
bool e2e_timed_out(e2e_receiver_t *receiver, uint32_t now_ms);

/* Sum of all refused frames and timeouts. */
uint32_t e2e_errors(const e2e_counts_t *counts);

/* "VALID" and so on; never NULL. */
const char *e2e_link_text(e2e_link_t link);

#endif
