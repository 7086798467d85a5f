/* SPDX-License-Identifier: Apache-2.0 */
/* Packing and unpacking of messages in C. test_frames.py compares the layout with the DBC. */
#include "comms/generated/hubfoc.h"
#include "comms/messages.h"
#include "core/q15.h"
#include "unity.h"
#include "wheel_address.h"

void setUp(void) {}

void tearDown(void) {}

static messages_frame_t frame_of(messages_kind_t kind, const slow_output_t *output,
                                 messages_wheel_t wheel, uint8_t counter)
{
    const wheel_temperatures_t temperature = {2500, 2500};
    const messages_values_t values = {.output = output, .temperature = &temperature};
    return messages_output(kind, &values, address_of(wheel), counter);
}

static const messages_wheel_t WHEELS[] = {MESSAGES_FRONT_LEFT, MESSAGES_FRONT_RIGHT,
                                          MESSAGES_REAR_LEFT, MESSAGES_REAR_RIGHT};

void test_identifiers_fit_eleven_bits_and_no_two_share_their_low_byte(void)
{
    bool seen[256] = {false};
    for (uint32_t w = 0; w < 4; w++) {
        for (int kind = 0; kind < MESSAGES_KINDS; kind++) {
            const uint16_t identifier =
                messages_identifier((messages_kind_t)kind, address_of(WHEELS[w]));
            TEST_ASSERT_TRUE(identifier < 0x800);
            if ((kind == MESSAGES_BATTERY_LIMITS || kind == MESSAGES_BATTERY_PEAK) && w > 0) {
                TEST_ASSERT_EQUAL_HEX16(
                    messages_identifier((messages_kind_t)kind, address_of(MESSAGES_FRONT_LEFT)),
                    identifier);
                continue;
            }
            TEST_ASSERT_FALSE_MESSAGE(seen[identifier & 0xFF], "two data ids would be equal");
            seen[identifier & 0xFF] = true;
        }
    }
}

void test_every_wheel_has_a_name_of_its_own(void)
{
    TEST_ASSERT_EQUAL_STRING("front left", messages_wheel_text(MESSAGES_FRONT_LEFT));
    TEST_ASSERT_EQUAL_STRING("front right", messages_wheel_text(MESSAGES_FRONT_RIGHT));
    TEST_ASSERT_EQUAL_STRING("rear left", messages_wheel_text(MESSAGES_REAR_LEFT));
    TEST_ASSERT_EQUAL_STRING("rear right", messages_wheel_text(MESSAGES_REAR_RIGHT));
    TEST_ASSERT_EQUAL_STRING("unknown", messages_wheel_text((messages_wheel_t)4));
}

void test_a_wheel_is_the_lowest_two_bits_of_the_identifier(void)
{
    for (uint32_t w = 0; w < 4; w++) {
        TEST_ASSERT_EQUAL_HEX16(0x100 | w,
                                messages_identifier(MESSAGES_DEMAND, address_of(WHEELS[w])));
        TEST_ASSERT_EQUAL_HEX16(0x190 | w,
                                messages_identifier(MESSAGES_WHEEL_HEALTH, address_of(WHEELS[w])));
    }
}

/* Of any base, for each wheel; the data ids are the identifiers, so they move with it. */
void test_every_identifier_moves_with_the_base_and_stays_within_eleven_bits(void)
{
    for (uint16_t base = 0; base <= 0x740; base += 32) {
        for (int kind = 0; kind < MESSAGES_KINDS; kind++) {
            for (uint32_t w = 0; w < 4; w++) {
                const messages_address_t moved = {.base = base, .wheel = WHEELS[w]};
                const uint16_t identifier = messages_identifier((messages_kind_t)kind, moved);
                TEST_ASSERT_EQUAL_INT(
                    messages_identifier((messages_kind_t)kind, address_of(WHEELS[w])) - 0x100,
                    identifier - base);
                TEST_ASSERT_TRUE(identifier < 0x7F0);
            }
        }
    }
}

/* A frame of another base is no frame of this vehicle: its data id differs, too. */
void test_a_demand_of_another_base_is_intact_under_its_own_identifier_only(void)
{
    const wheel_demand_t demand = {.brake_torque_mNm = 20000};
    const messages_address_t moved = {.base = 0x320, .wheel = MESSAGES_REAR_LEFT};
    const messages_frame_t frame = messages_demand(&demand, moved, 5);
    TEST_ASSERT_EQUAL_HEX16(0x322, frame.identifier);
    TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_5, frame.data, 0x322));
    TEST_ASSERT_FALSE(e2e_intact(E2E_PROFILE_5, frame.data, 0x102));
}

/* On CAN the lower identifier wins: an urgent message of any wheel precedes a less urgent one of
 * any other. */
void test_more_urgent_messages_have_lower_identifiers_for_every_wheel(void)
{
    for (int kind = 1; kind < MESSAGES_KINDS; kind++) {
        TEST_ASSERT_TRUE(
            messages_identifier((messages_kind_t)(kind - 1), address_of(MESSAGES_REAR_RIGHT)) <
            messages_identifier((messages_kind_t)kind, address_of(MESSAGES_FRONT_LEFT)));
    }
}

/* Values are whole steps, so that none is rounded; 100 is a reason unknown to this version. */
void test_wheel_state_and_brake_unpack_to_the_packed_values(void)
{
    const slow_output_t meant = {
        .motor_torque_estimate_mNm = -39900,
        .hydraulic_torque_mNm = 123400,
        .electric_brake_available_mNm = 40000,
        .speed_mrad_s = -12340,
        .fault_reason = (reason_t)7,
        .mode = MODE_LIMP,
        .hydraulic_valid = true,
        .stop_lamp = true,
    };
    for (uint32_t w = 0; w < 4; w++) {
        slow_output_t back = {.i_q_mA = 77};
        const messages_frame_t state = frame_of(MESSAGES_WHEEL_STATE, &meant, WHEELS[w], 9);
        const messages_frame_t brake = frame_of(MESSAGES_WHEEL_BRAKE, &meant, WHEELS[w], 9);
        TEST_ASSERT_TRUE(messages_read_output(&state, address_of(WHEELS[w]), &back));
        TEST_ASSERT_EQUAL_INT(0, back.hydraulic_torque_mNm);
        TEST_ASSERT_TRUE(messages_read_output(&brake, address_of(WHEELS[w]), &back));
        TEST_ASSERT_EQUAL_INT(meant.motor_torque_estimate_mNm, back.motor_torque_estimate_mNm);
        TEST_ASSERT_EQUAL_INT(meant.hydraulic_torque_mNm, back.hydraulic_torque_mNm);
        TEST_ASSERT_EQUAL_INT(meant.electric_brake_available_mNm,
                              back.electric_brake_available_mNm);
        TEST_ASSERT_EQUAL_INT(meant.speed_mrad_s, back.speed_mrad_s);
        TEST_ASSERT_EQUAL_INT(meant.fault_reason, back.fault_reason);
        TEST_ASSERT_EQUAL_UINT8(meant.mode, back.mode);
        TEST_ASSERT_TRUE(back.hydraulic_valid);
        TEST_ASSERT_TRUE(back.stop_lamp);
        TEST_ASSERT_EQUAL_INT(77, back.i_q_mA);
    }
}

void test_all_other_messages_of_a_wheel_unpack_to_the_packed_values(void)
{
    const slow_output_t meant = {
        .motor_torque_command_mNm = -12300,
        .electric_brake_ahead_mNm = 1900000,
        .drive_available_mNm = 700,
        .drive_ahead_mNm = 20000000,
        .i_q_mA = -45600,
        .bus_voltage_mV = 72100,
        .bus_current_mA = -8900,
        .motor_torque_uncertainty_mNm = 1350,
        .torque_reason = (reason_t)1,
        .available_reason = (reason_t)2,
        .ahead_reason = (reason_t)3,
        .drive_available_reason = (reason_t)4,
        .drive_ahead_reason = (reason_t)5,
        .hydraulic_reason = (reason_t)6,
        .waits_for = (waits_for_t)7,
        .warning_reason = (reason_t)8,
        .direction = DRIVE_DIRECTION_REVERSE,
    };
    slow_output_t back = {.speed_mrad_s = 77};
    for (messages_kind_t kind = MESSAGES_WHEEL_DRIVE; kind < MESSAGES_WHEEL_ENERGY; kind++) {
        const messages_frame_t frame = frame_of(kind, &meant, MESSAGES_FRONT_RIGHT, 3);
        TEST_ASSERT_TRUE(messages_read_output(&frame, address_of(MESSAGES_FRONT_RIGHT), &back));
    }
    TEST_ASSERT_EQUAL_INT(77, back.speed_mrad_s);
    TEST_ASSERT_EQUAL_INT(meant.motor_torque_command_mNm, back.motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT(meant.electric_brake_ahead_mNm, back.electric_brake_ahead_mNm);
    TEST_ASSERT_EQUAL_INT(meant.drive_available_mNm, back.drive_available_mNm);
    TEST_ASSERT_EQUAL_INT(meant.drive_ahead_mNm, back.drive_ahead_mNm);
    TEST_ASSERT_EQUAL_INT(meant.i_q_mA, back.i_q_mA);
    TEST_ASSERT_EQUAL_INT(meant.bus_voltage_mV, back.bus_voltage_mV);
    TEST_ASSERT_EQUAL_INT(meant.bus_current_mA, back.bus_current_mA);
    TEST_ASSERT_EQUAL_INT(meant.motor_torque_uncertainty_mNm, back.motor_torque_uncertainty_mNm);
    TEST_ASSERT_EQUAL_INT(meant.torque_reason, back.torque_reason);
    TEST_ASSERT_EQUAL_INT(meant.available_reason, back.available_reason);
    TEST_ASSERT_EQUAL_INT(meant.ahead_reason, back.ahead_reason);
    TEST_ASSERT_EQUAL_INT(meant.drive_available_reason, back.drive_available_reason);
    TEST_ASSERT_EQUAL_INT(meant.drive_ahead_reason, back.drive_ahead_reason);
    TEST_ASSERT_EQUAL_INT(meant.hydraulic_reason, back.hydraulic_reason);
    TEST_ASSERT_EQUAL_INT(meant.waits_for, back.waits_for);
    TEST_ASSERT_EQUAL_INT(meant.warning_reason, back.warning_reason);
    TEST_ASSERT_EQUAL_INT(meant.direction, back.direction);
}

void test_what_is_not_available_leaves_the_field_as_it_was(void)
{
    const slow_output_t meant = {.motor_torque_estimate_mNm = 20000050,
                                 .speed_mrad_s = -5200005,
                                 .hydraulic_torque_mNm = 3276750,
                                 .hydraulic_valid = true,
                                 .electric_brake_available_mNm = 3276700};
    slow_output_t back = {
        .motor_torque_estimate_mNm = 1, .speed_mrad_s = 2, .electric_brake_available_mNm = 3};
    const messages_frame_t state = frame_of(MESSAGES_WHEEL_STATE, &meant, MESSAGES_FRONT_LEFT, 0);
    const messages_frame_t brake = frame_of(MESSAGES_WHEEL_BRAKE, &meant, MESSAGES_FRONT_LEFT, 0);
    TEST_ASSERT_TRUE(messages_read_output(&state, address_of(MESSAGES_FRONT_LEFT), &back));
    TEST_ASSERT_TRUE(messages_read_output(&brake, address_of(MESSAGES_FRONT_LEFT), &back));
    TEST_ASSERT_EQUAL_INT32(1, back.motor_torque_estimate_mNm);
    TEST_ASSERT_EQUAL_INT32(2, back.speed_mrad_s);
    TEST_ASSERT_EQUAL_INT32(3, back.electric_brake_available_mNm);
    TEST_ASSERT_FALSE(back.hydraulic_valid);
}

void test_state_and_brake_of_other_wheels_or_messages_are_refused(void)
{
    const slow_output_t meant = {.hydraulic_torque_mNm = 1000, .mode = MODE_READY};
    slow_output_t back = {.mode = MODE_SELFTEST};
    messages_frame_t frame = frame_of(MESSAGES_WHEEL_BRAKE, &meant, MESSAGES_REAR_LEFT, 0);
    TEST_ASSERT_FALSE(messages_read_output(&frame, address_of(MESSAGES_REAR_RIGHT), &back));
    frame.length = 7;
    TEST_ASSERT_FALSE(messages_read_output(&frame, address_of(MESSAGES_REAR_LEFT), &back));
    const wheel_demand_t none = {.brake_torque_mNm = 1000};
    const messages_frame_t demand = messages_demand(&none, address_of(MESSAGES_REAR_LEFT), 0);
    TEST_ASSERT_FALSE(messages_read_output(&demand, address_of(MESSAGES_REAR_LEFT), &back));
    TEST_ASSERT_EQUAL_INT(0, back.hydraulic_torque_mNm);
    TEST_ASSERT_EQUAL_UINT8(1, back.mode);
}

void test_demand_unpacks_to_the_packed_values(void)
{
    static const int32_t DRIVE_mNm[] = {-1638200, -12400, -200, 0, 200, 40000, 1638200};
    static const int32_t BRAKE_mNm[] = {0, 200, 12400, 3276600};
    for (uint32_t d = 0; d < 7; d++) {
        for (uint32_t b = 0; b < 4; b++) {
            for (uint32_t flags = 0; flags < 8; flags++) {
                const wheel_demand_t meant = {
                    .direction = (drive_direction_t)((d + b) % 3),
                    .drive_torque_mNm = DRIVE_mNm[d],
                    .brake_torque_mNm = BRAKE_mNm[b],
                    .enable = (flags & 1U) != 0,
                    .abs_active = (flags & 2U) != 0,
                    .abs_motor_share_percent = (uint8_t)(25 * b + flags),
                    .fault_reset = (flags & 4U) != 0,
                };
                const messages_frame_t frame =
                    messages_demand(&meant, address_of(MESSAGES_FRONT_RIGHT), 5);
                wheel_demand_t read;
                TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_5, frame.data, frame.identifier));
                TEST_ASSERT_TRUE(messages_read_demand(&frame, &read));
                TEST_ASSERT_EQUAL_INT32(meant.drive_torque_mNm, read.drive_torque_mNm);
                TEST_ASSERT_EQUAL_INT32(meant.brake_torque_mNm, read.brake_torque_mNm);
                TEST_ASSERT_EQUAL_INT(meant.direction, read.direction);
                TEST_ASSERT_EQUAL(meant.enable, read.enable);
                TEST_ASSERT_EQUAL_UINT8(q_min(meant.abs_motor_share_percent, 100),
                                        read.abs_motor_share_percent);
                TEST_ASSERT_EQUAL(meant.abs_active, read.abs_active);
                TEST_ASSERT_EQUAL(meant.fault_reset, read.fault_reset);
            }
        }
    }
}

void test_battery_limits_unpack_to_the_packed_values(void)
{
    static const int32_t CURRENT_mA[] = {0, 100, 123400, 32000000};
    for (uint32_t c = 0; c < 4; c++) {
        for (uint32_t d = 0; d < 4; d++) {
            const battery_limits_t meant = {.charge_current_mA = CURRENT_mA[c],
                                            .discharge_current_mA = CURRENT_mA[d],
                                            .contactor = (contactor_t)(d % 3)};
            const messages_frame_t frame =
                messages_battery(&meant, address_of(MESSAGES_FRONT_LEFT), 15);
            battery_limits_t read;
            TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_5, frame.data, frame.identifier));
            TEST_ASSERT_TRUE(messages_read_battery(&frame, &read));
            TEST_ASSERT_EQUAL_INT32(meant.charge_current_mA, read.charge_current_mA);
            TEST_ASSERT_EQUAL_INT32(meant.discharge_current_mA, read.discharge_current_mA);
            TEST_ASSERT_EQUAL_INT(meant.contactor, read.contactor);
        }
    }
}

static bool demand_is_read(int16_t drive_steps, uint8_t share_percent, uint8_t direction)
{
    const struct hubfoc_demand_t raw = {.drive_torque_nm = drive_steps,
                                        .brake_torque_nm = 16383,
                                        .abs_motor_share_percent = share_percent,
                                        .direction = direction};
    messages_frame_t frame = {.length = 8};
    (void)hubfoc_demand_pack(frame.data, &raw, sizeof frame.data);
    wheel_demand_t demand = {.drive_torque_mNm = 7};
    const bool read = messages_read_demand(&frame, &demand);
    TEST_ASSERT_TRUE_MESSAGE(read || demand.drive_torque_mNm == 7,
                             "a refused frame must leave everything as it was");
    return read;
}

/* 8191 steps of 0.2 N m are the DBC's 1638.2 N m; the field could hold -8192. */
void test_demand_above_its_range_is_refused(void)
{
    TEST_ASSERT_TRUE(demand_is_read(8191, 100, 2));
    TEST_ASSERT_TRUE(demand_is_read(-8191, 0, 0));
    TEST_ASSERT_FALSE(demand_is_read(-8192, 0, 0));
    TEST_ASSERT_FALSE(demand_is_read(0, 101, 0));
    TEST_ASSERT_FALSE(demand_is_read(0, 127, 0));
    TEST_ASSERT_FALSE(demand_is_read(0, 0, 3));
}

/* What a sender puts on the bus before it has computed anything. */
void test_a_demand_of_zeros_is_off_and_neutral_and_without_torque(void)
{
    const messages_frame_t frame = {.length = 8};
    wheel_demand_t read = {.drive_torque_mNm = 7, .brake_torque_mNm = 7, .enable = true};
    TEST_ASSERT_TRUE(messages_read_demand(&frame, &read));
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, read.direction);
    TEST_ASSERT_FALSE(read.enable);
    TEST_ASSERT_EQUAL_INT32(0, read.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, read.brake_torque_mNm);
}

/* What does not fit is sent as the end of its range, never wrapped. */
void test_demand_beyond_its_range_is_sent_as_its_end(void)
{
    const wheel_demand_t meant = {.drive_torque_mNm = INT32_MIN,
                                  .brake_torque_mNm = INT32_MAX,
                                  .abs_motor_share_percent = 255};
    const messages_frame_t frame = messages_demand(&meant, address_of(MESSAGES_FRONT_LEFT), 0);
    wheel_demand_t read;
    TEST_ASSERT_TRUE(messages_read_demand(&frame, &read));
    TEST_ASSERT_EQUAL_INT32(-1638200, read.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(3276600, read.brake_torque_mNm);
    TEST_ASSERT_EQUAL_UINT8(100, read.abs_motor_share_percent);
}

static bool battery_is_read(uint32_t charge_steps, uint32_t discharge_steps)
{
    const struct hubfoc_battery_limits_t raw = {.charge_current_a = charge_steps,
                                                .discharge_current_a = discharge_steps};
    messages_frame_t frame = {.length = 8};
    (void)hubfoc_battery_limits_pack(frame.data, &raw, sizeof frame.data);
    battery_limits_t battery = {.charge_current_mA = 7, .discharge_current_mA = 7};
    const bool read = messages_read_battery(&frame, &battery);
    TEST_ASSERT_TRUE(read || (battery.charge_current_mA == 7 && battery.discharge_current_mA == 7));
    return read;
}

void test_a_contactor_state_that_does_not_exist_is_refused(void)
{
    for (uint8_t state = 0; state < 4; state++) {
        const struct hubfoc_battery_limits_t raw = {.contactor = state};
        messages_frame_t frame = {.length = 8};
        (void)hubfoc_battery_limits_pack(frame.data, &raw, sizeof frame.data);
        battery_limits_t battery = {.contactor = CONTACTOR_CLOSED};
        TEST_ASSERT_EQUAL_INT(state <= CONTACTOR_OPEN, messages_read_battery(&frame, &battery));
        TEST_ASSERT_EQUAL_INT(state <= CONTACTOR_OPEN ? state : CONTACTOR_CLOSED,
                              battery.contactor);
    }
}

void test_battery_limits_beyond_the_range_are_refused(void)
{
    TEST_ASSERT_TRUE(battery_is_read(320000, 320000));
    TEST_ASSERT_FALSE(battery_is_read(320001, 0));
    TEST_ASSERT_FALSE(battery_is_read(0, 320001));
    TEST_ASSERT_FALSE(battery_is_read(524287, 524287));
}

void test_a_frame_of_another_length_is_refused(void)
{
    const wheel_demand_t demand = {.enable = true};
    const battery_limits_t battery = {.charge_current_mA = 1000, .discharge_current_mA = 1000};
    for (uint8_t length = 0; length < 8; length++) {
        messages_frame_t frame = messages_demand(&demand, address_of(MESSAGES_FRONT_LEFT), 0);
        wheel_demand_t read_demand;
        frame.length = length;
        TEST_ASSERT_FALSE(messages_read_demand(&frame, &read_demand));
        frame = messages_battery(&battery, address_of(MESSAGES_FRONT_LEFT), 0);
        battery_limits_t read_battery;
        frame.length = length;
        TEST_ASSERT_FALSE(messages_read_battery(&frame, &read_battery));
    }
}

void test_received_messages_cannot_be_sent(void)
{
    const slow_output_t output = {.mode = MODE_RUN};
    TEST_ASSERT_EQUAL_UINT8(0, frame_of(MESSAGES_DEMAND, &output, MESSAGES_FRONT_LEFT, 0).length);
    TEST_ASSERT_EQUAL_UINT8(
        0, frame_of(MESSAGES_BATTERY_LIMITS, &output, MESSAGES_FRONT_LEFT, 0).length);
    TEST_ASSERT_EQUAL_UINT8(
        0, frame_of(MESSAGES_WHEEL_ENERGY, &output, MESSAGES_FRONT_LEFT, 0).length);
    TEST_ASSERT_EQUAL_UINT8(0, frame_of(MESSAGES_KINDS, &output, MESSAGES_FRONT_LEFT, 0).length);
}

void test_hydraulic_feedback_and_battery_peak_unpack_to_the_packed_values(void)
{
    const int32_t steps_mNm[] = {0, 100, 34500, 20000000};
    for (int k = 0; k < 4; k++) {
        const hydraulic_feedback_t meant = {.torque_mNm = steps_mNm[k], .valid = k % 2 == 1};
        const messages_frame_t frame =
            messages_hydraulic(&meant, address_of(MESSAGES_REAR_RIGHT), 7);
        hydraulic_feedback_t read = {.torque_mNm = -1, .age_ms = 5};
        TEST_ASSERT_EQUAL_HEX16(0x123, frame.identifier);
        TEST_ASSERT_TRUE(messages_read_hydraulic(&frame, &read));
        TEST_ASSERT_EQUAL_INT32(meant.torque_mNm, read.torque_mNm);
        TEST_ASSERT_EQUAL_INT(meant.valid, read.valid);
        TEST_ASSERT_EQUAL_UINT32(5, read.age_ms);

        const int32_t peaks_mA[] = {0, 500, 34500, 2047500};
        const int32_t currents_mA[] = {-1638200, -200, 0, 1638200};
        const battery_limits_t limits = {.charge_peak_current_mA = peaks_mA[k],
                                         .voltage_mV = 100 + 546 * 100 * k,
                                         .current_mA = currents_mA[k],
                                         .current_given = true};
        const messages_frame_t peak = messages_peak(&limits, address_of(MESSAGES_FRONT_LEFT), 3);
        battery_limits_t got = {.charge_current_mA = 11, .discharge_current_mA = 12};
        TEST_ASSERT_EQUAL_HEX16(0x144, peak.identifier);
        TEST_ASSERT_TRUE(messages_read_peak(&peak, &got));
        TEST_ASSERT_EQUAL_INT32(peaks_mA[k], got.charge_peak_current_mA);
        TEST_ASSERT_EQUAL_INT32(limits.voltage_mV, got.voltage_mV);
        TEST_ASSERT_EQUAL_INT32(currents_mA[k], got.current_mA);
        TEST_ASSERT_TRUE(got.current_given);
        TEST_ASSERT_EQUAL_INT32(11, got.charge_current_mA);
    }
}

/* A limit is never overstated; a measured value beyond its range is not given. */
void test_battery_peak_rounds_its_limit_down_and_leaves_out_what_does_not_fit(void)
{
    const battery_limits_t high = {
        .charge_peak_current_mA = 900, .current_mA = 1638301, .current_given = true};
    const battery_limits_t low = {.charge_peak_current_mA = INT32_MAX,
                                  .voltage_mV = 1638350,
                                  .current_mA = INT32_MIN,
                                  .current_given = true};
    const battery_limits_t none = {.charge_peak_current_mA = -1, .current_mA = 5000};
    battery_limits_t got = {.current_given = false};
    messages_frame_t frame = messages_peak(&high, address_of(MESSAGES_FRONT_LEFT), 0);
    TEST_ASSERT_TRUE(messages_read_peak(&frame, &got));
    TEST_ASSERT_EQUAL_INT32(500, got.charge_peak_current_mA);
    TEST_ASSERT_FALSE(got.current_given);
    frame = messages_peak(&low, address_of(MESSAGES_FRONT_LEFT), 0);
    TEST_ASSERT_TRUE(messages_read_peak(&frame, &got));
    TEST_ASSERT_EQUAL_INT32(2047500, got.charge_peak_current_mA);
    TEST_ASSERT_FALSE(got.current_given);
    TEST_ASSERT_EQUAL_INT32(0, got.voltage_mV);
    frame = messages_peak(&none, address_of(MESSAGES_FRONT_LEFT), 0);
    TEST_ASSERT_TRUE(messages_read_peak(&frame, &got));
    TEST_ASSERT_EQUAL_INT32(0, got.charge_peak_current_mA);
    TEST_ASSERT_EQUAL_INT32(0, got.current_mA);
    TEST_ASSERT_FALSE(got.current_given);
}

void test_hydraulic_feedback_beyond_the_range_and_a_short_battery_peak_are_refused(void)
{
    const struct hubfoc_hydraulic_feedback_t torque = {.measured_torque_nm = 200001};
    messages_frame_t frame = {.length = E2E_FRAME_BYTES};
    (void)hubfoc_hydraulic_feedback_pack(frame.data, &torque, sizeof frame.data);
    hydraulic_feedback_t feedback = {.torque_mNm = 7};
    TEST_ASSERT_FALSE(messages_read_hydraulic(&frame, &feedback));
    TEST_ASSERT_EQUAL_INT32(7, feedback.torque_mNm);
    frame.length = E2E_FRAME_BYTES - 1;
    battery_limits_t limits = {.charge_peak_current_mA = 7};
    TEST_ASSERT_FALSE(messages_read_peak(&frame, &limits));
    TEST_ASSERT_EQUAL_INT32(7, limits.charge_peak_current_mA);
}

/* Signals by their bits in the DBC: account 12, drawn 13 .. 34, returned 35 .. 56, friction 57 ..
 * 63. 1 Wh is 360 times 10 J. */
void test_wheel_energy_has_the_account_of_its_counter(void)
{
    const messages_energy_t start = {360, 36, 25}, life = {360000, 1799, MESSAGES_NO_SHARE};
    const messages_address_t address = address_of(MESSAGES_REAR_LEFT);
    slow_output_t untouched = {.speed_mrad_s = 77};
    for (uint8_t counter = 0; counter < 16; counter++) {
        const messages_frame_t frame = messages_energy(&start, &life, address, counter);
        uint64_t bits = 0;
        for (uint32_t k = 0; k < 8; k++) {
            bits |= (uint64_t)frame.data[k] << (8U * k);
        }
        TEST_ASSERT_EQUAL_HEX16(0x19E, frame.identifier);
        TEST_ASSERT_TRUE(e2e_intact(E2E_PROFILE_2, frame.data, 0x19E));
        TEST_ASSERT_EQUAL_UINT8(counter, frame.data[1] & 0x0F);
        TEST_ASSERT_EQUAL_UINT8(counter & 1U, bits >> 12 & 1U);
        const bool for_life = (counter & 1U) != 0;
        TEST_ASSERT_EQUAL_UINT32(for_life ? 200 : 10, bits >> 13 & 0x3FFFFF);
        TEST_ASSERT_EQUAL_UINT32(for_life ? 0 : 1, bits >> 35 & 0x3FFFFF);
        TEST_ASSERT_EQUAL_UINT32(for_life ? 127 : 25, bits >> 57);
        TEST_ASSERT_FALSE(messages_read_output(&frame, address, &untouched));
    }
    TEST_ASSERT_EQUAL_INT(77, untouched.speed_mrad_s);
}
