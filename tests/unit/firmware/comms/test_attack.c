/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Mutated, repeated, delayed and replayed Demand frames by the hundred thousand, and in the
 * test `full` by the million: how many are used, against the bound of DERIVATIONS.
 *
 * A frame with random content passes the CRC with p = 2^-16; for a flip of up to three bits or a
 * burst of up to 15 p = 0. Of n such frames more than n p + 6 sqrt(n p) + 6 pass with a
 * probability below 1e-8 (Chernoff's bound of a binomial). Whatever passes, no torque in use is
 * larger than the configured one, and none has risen faster.
 */
#include <stdio.h>
#include <stdlib.h>

#include "comms/node.h"
#include "core/q15.h"
#include "random_values.h"
#include "unity.h"
#include "wheel_address.h"

enum { CYCLE_ms = 10, PAST = 512, LARGEST_DRIVE = 40000, LARGEST_BRAKE = 300000, RISE_ms = 20 };

static const node_limits_t LIMITS = {
    .largest_drive_mNm = LARGEST_DRIVE,
    .largest_brake_mNm = LARGEST_BRAKE,
    .demand_rise_ms = RISE_ms,
    .demand_lost_frames = 2,
};

static node_t node;
static random_t dice;
static messages_frame_t past[PAST];
static uint32_t sent, now_ms;

static uint32_t frames_a_kind; /* HUBFOC_ATTACK_FRAMES, or a hundred thousand */

void setUp(void)
{
    const char *wanted = getenv("HUBFOC_ATTACK_FRAMES");
    frames_a_kind = wanted != NULL ? (uint32_t)strtoul(wanted, NULL, 10) : 100000;
    dice = random_seeded(13);
    sent = 0;
    now_ms = 0;
    node_init(&node, address_of(MESSAGES_FRONT_LEFT), &LIMITS, 0);
}

void tearDown(void) {}

/* A receiver's use of a frame must stay within the configuration, whatever the frame is. */
static bool offer(const messages_frame_t *frame)
{
    const node_command_t before = node.command;
    const uint32_t used = node.demand.counts.used;
    (void)node_receive(&node, frame, now_ms);
    const wheel_demand_t *got = &node.command.demand;
    TEST_ASSERT_TRUE(q_abs(got->drive_torque_mNm) <= LARGEST_DRIVE);
    TEST_ASSERT_TRUE(got->brake_torque_mNm >= 0 && got->brake_torque_mNm <= LARGEST_BRAKE);
    if (node.demand.counts.used == used) {
        TEST_ASSERT_EQUAL_INT32(before.demand.drive_torque_mNm, got->drive_torque_mNm);
        TEST_ASSERT_EQUAL_INT32(before.demand.brake_torque_mNm, got->brake_torque_mNm);
        TEST_ASSERT_EQUAL_UINT32(before.demand_time_ms, node.command.demand_time_ms);
        return false;
    }
    const uint32_t elapsed_ms = now_ms - before.demand_time_ms;
    if (before.demand_known && elapsed_ms <= CYCLE_ms) {
        TEST_ASSERT_TRUE(got->brake_torque_mNm - before.demand.brake_torque_mNm <=
                         LARGEST_BRAKE / 2);
    }
    return true;
}

/* The sender's own next frame: within the limits, rising no faster than they allow. */
static messages_frame_t next_frame(void)
{
    const wheel_demand_t demand = {.drive_torque_mNm =
                                       random_between(&dice, -LARGEST_DRIVE / 2, LARGEST_DRIVE / 2),
                                   .brake_torque_mNm = random_between(&dice, 0, LARGEST_BRAKE / 2),
                                   .enable = true};
    const messages_frame_t frame = messages_demand(&demand, node.address, (uint8_t)sent);
    past[sent % PAST] = frame;
    sent++;
    return frame;
}

static void cycle(void)
{
    now_ms += CYCLE_ms;
    const messages_frame_t own = next_frame();
    (void)offer(&own);
}

static void start(void)
{
    for (int k = 0; k < 4; k++) {
        cycle();
    }
    TEST_ASSERT_EQUAL_INT(E2E_VALID, node.demand.link);
}

static double most_accepted(double frames, double probability)
{
    const double mean = frames * probability;
    double root = mean > 1 ? mean : 1;
    for (int k = 0; k < 40; k++) {
        root = (root + mean / root) / 2;
    }
    return mean + 6 * root + 6;
}

typedef void damage_t(messages_frame_t *frame);

static void random_content(messages_frame_t *frame)
{
    for (int k = 0; k < 8; k++) {
        frame->data[k] = (uint8_t)random_u64(&dice);
    }
}

/* With the counter that the receiver waits for: the CRC alone is tested. */
static void random_payload(messages_frame_t *frame)
{
    const uint8_t counter = frame->data[2];
    random_content(frame);
    frame->data[2] = counter;
}

static void three_bits(messages_frame_t *frame)
{
    const int32_t first = random_between(&dice, 0, 61);
    const int32_t flips[] = {first, random_between(&dice, first + 1, 62), 63};
    const int32_t count = random_between(&dice, 1, 3);
    for (int32_t k = 0; k < count; k++) {
        frame->data[flips[k] / 8] ^= (uint8_t)(1U << flips[k] % 8);
    }
}

/* 4 to 64 wrong bits anywhere. */
static void many_bits(messages_frame_t *frame)
{
    const messages_frame_t sound = *frame;
    int differ = 0;
    while (differ < 4) {
        *frame = sound;
        differ = 0;
        for (int k = 0; k < 8; k++) {
            frame->data[k] ^= (uint8_t)(random_u64(&dice) & random_u64(&dice));
            differ += __builtin_popcount(frame->data[k] ^ (unsigned)sound.data[k]);
        }
    }
}

static void other_identifier(messages_frame_t *frame)
{
    /* the same content as another wheel's, delivered under this wheel's identifier */
    const uint8_t counter = frame->data[2];
    e2e_protect(E2E_PROFILE_5, frame->data,
                (uint16_t)(frame->identifier ^ random_between(&dice, 1, 0x7FF)), counter);
}

/* Each damaged frame takes the place of the sender's own. Used ones are counted. */
static uint32_t used_of(damage_t *damage)
{
    start();
    uint32_t used = 0;
    for (uint32_t n = 0; n < frames_a_kind; n++) {
        const node_t before = node;
        now_ms += CYCLE_ms;
        messages_frame_t frame = next_frame();
        damage(&frame);
        used += offer(&frame) ? 1U : 0U;
        node = before; /* the next one meets the same receiver */
        now_ms -= CYCLE_ms;
        sent--;
    }
    return used;
}

static void assert_used(damage_t *damage, double probability)
{
    const uint32_t used = used_of(damage);
    const double most = most_accepted(frames_a_kind, probability);
    printf("%u of %u used, at most %.0f\n", used, frames_a_kind, probability > 0 ? most : 0);
    TEST_ASSERT_TRUE(used <= (probability > 0 ? most : 0));
}

void test_random_contents_with_the_right_counter_pass_once_in_65536(void)
{
    assert_used(random_payload, 1.0 / 65536);
}

void test_random_contents_pass_three_times_in_16_million(void)
{
    assert_used(random_content, 3.0 / 256 / 65536);
}

void test_frames_with_up_to_three_wrong_bits_never_pass(void)
{
    assert_used(three_bits, 0);
}

/* The polynomial has the factor x + 1: an odd number of wrong bits never passes, an even one twice
 * as often. */
void test_frames_with_many_wrong_bits_pass_once_in_65536(void)
{
    assert_used(many_bits, 1.0 / 65536);
}

void test_frames_of_another_wheel_or_message_never_pass(void)
{
    assert_used(other_identifier, 0);
}

void test_repeated_frames_never_pass_again(void)
{
    start();
    for (uint32_t n = 0; n < frames_a_kind; n++) {
        cycle();
        const messages_frame_t again = past[(sent - 1) % PAST];
        TEST_ASSERT_FALSE(offer(&again));
    }
    TEST_ASSERT_EQUAL_UINT32(frames_a_kind, node.demand.counts.repeated);
}

/* One frame of the last 255, between two of the sender's own: 3 of 255 are taken for new ones. */
void test_replayed_frames_pass_three_times_in_255(void)
{
    uint32_t used = 0;
    for (uint32_t n = 0; n < 256; n++) {
        cycle();
    }
    for (uint32_t n = 0; n < frames_a_kind; n++) {
        const node_t before = node;
        const uint32_t back = (uint32_t)random_between(&dice, 2, 256);
        used += offer(&past[(sent - back) % PAST]) ? 1U : 0U;
        node = before;
        if (n % 16 == 0) {
            cycle();
        }
    }
    const double most = most_accepted(frames_a_kind, 3.0 / 255);
    printf("%u of %u used, at most %.0f\n", used, frames_a_kind, most);
    TEST_ASSERT_TRUE(used <= most);
}

/* Later by a constant time: used, and the echo shows it. Later by a random time, so that frames
 * change places: an older one is used after a newer one only if the sender has qualified anew. */
void test_delayed_frames_are_shown_by_the_echo_and_do_not_change_places(void)
{
    const uint32_t late = 7;
    for (uint32_t n = 0; n < frames_a_kind; n++) {
        now_ms += CYCLE_ms;
        (void)next_frame();
        if (sent > late) {
            const messages_frame_t *frame = &past[(sent - 1 - late) % PAST];
            (void)offer(frame);
        }
        if (sent > late + 3) {
            TEST_ASSERT_EQUAL_UINT8(late, (uint8_t)(sent - 1 - node.demand_counter));
        }
    }
    setUp();
    start();
    uint32_t newest = sent - 1;
    for (uint32_t n = 0; n < frames_a_kind; n++) {
        now_ms += CYCLE_ms;
        (void)next_frame();
        const uint32_t index = sent - 1 - (uint32_t)random_between(&dice, 0, 9);
        const bool qualified = node.demand.link == E2E_VALID;
        if (offer(&past[index % PAST])) {
            TEST_ASSERT_TRUE(index > newest || !qualified);
            newest = index;
        }
    }
}
