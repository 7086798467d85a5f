/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/messages.h"

#include "comms/generated/hubfoc.h"
#include "core/q15.h"

enum {
    TORQUE_STEP_mNm = 100,
    UNCERTAINTY_STEP_mNm = 50,
    DEMAND_STEP_mNm = 200,
    CURRENT_STEP_mA = 100,
    PEAK_STEP_mA = 500,
    PACK_CURRENT_STEP_mA = 200,
    VOLTAGE_STEP_mV = 100,
    SPEED_STEP_mrad_s = 10,
    TEMPERATURE_STEP_cC = 10,
    /* Ends of what is sent, in steps. */
    TORQUE_MAX = 200000,
    DEMAND_DRIVE_MAX = 8191,
    DEMAND_BRAKE_MAX = 16383,
    SHARE_MAX = 100,
    HYDRAULIC_MAX = 32767,
    AVAILABLE_MAX = 32766,
    UNCERTAINTY_MAX = 32766,
    COMMAND_MAX = 65535,
    SPEED_MAX = 520000,
    CURRENT_MAX = 60000,
    BATTERY_CURRENT_MAX = 320000,
    VOLTAGE_MAX = 20000,
    PEAK_MAX = 4095,
    PACK_VOLTAGE_MAX = 16383,
    PACK_VOLTAGE_NOT_GIVEN = 0,
    PACK_CURRENT_MAX = 8191,
    PACK_CURRENT_NOT_GIVEN = -8192,
    TEMPERATURE_MIN = -2000,
    TEMPERATURE_NOT_AVAILABLE = 3000,
    ENERGY_STEP_10J = 36,        /* 0.1 Wh */
    LIFE_ENERGY_STEP_10J = 1800, /* 5 Wh; 32 bits of 10 J are 22 bits of them */
    ENERGY_MAX = 4194302,
    MODE_MASK = 0x0F,
    DIRECTION_MASK = 0x03,
    ERRORS_MASK = 0x0F
};

_Static_assert((int)MESSAGES_BASE == HUBFOC_DEMAND_FRAME_ID, "the base of the DBC");

typedef struct {
    uint16_t identifier; /* front left, in the DBC */
    uint16_t cycle_ms;
    bool each_wheel; /* has an identifier of its own */
} kind_t;

static const kind_t KINDS[MESSAGES_KINDS] = {
    [MESSAGES_DEMAND] = {HUBFOC_DEMAND_FRAME_ID, HUBFOC_DEMAND_CYCLE_TIME_MS, true},
    [MESSAGES_HYDRAULIC_FEEDBACK] = {HUBFOC_HYDRAULIC_FEEDBACK_FRAME_ID,
                                     HUBFOC_HYDRAULIC_FEEDBACK_CYCLE_TIME_MS, true},
    [MESSAGES_BATTERY_PEAK] = {HUBFOC_BATTERY_PEAK_FRAME_ID, HUBFOC_BATTERY_PEAK_CYCLE_TIME_MS,
                               false},
    [MESSAGES_BATTERY_LIMITS] = {HUBFOC_BATTERY_LIMITS_FRAME_ID,
                                 HUBFOC_BATTERY_LIMITS_CYCLE_TIME_MS, false},
    [MESSAGES_WHEEL_STATE] = {HUBFOC_WHEEL_STATE_FRAME_ID, HUBFOC_WHEEL_STATE_CYCLE_TIME_MS, true},
    [MESSAGES_WHEEL_BRAKE] = {HUBFOC_WHEEL_BRAKE_FRAME_ID, HUBFOC_WHEEL_BRAKE_CYCLE_TIME_MS, true},
    [MESSAGES_WHEEL_DRIVE] = {HUBFOC_WHEEL_DRIVE_FRAME_ID, HUBFOC_WHEEL_DRIVE_CYCLE_TIME_MS, true},
    [MESSAGES_WHEEL_POWER] = {HUBFOC_WHEEL_POWER_FRAME_ID, HUBFOC_WHEEL_POWER_CYCLE_TIME_MS, true},
    [MESSAGES_WHEEL_HEALTH] = {HUBFOC_WHEEL_HEALTH_FRAME_ID, HUBFOC_WHEEL_HEALTH_CYCLE_TIME_MS,
                               true},
    [MESSAGES_WHEEL_AHEAD] = {HUBFOC_WHEEL_AHEAD_FRAME_ID, HUBFOC_WHEEL_AHEAD_CYCLE_TIME_MS, true},
    [MESSAGES_WHEEL_AVAILABLE] = {HUBFOC_WHEEL_AVAILABLE_FRAME_ID,
                                  HUBFOC_WHEEL_AVAILABLE_CYCLE_TIME_MS, true},
    [MESSAGES_WHEEL_ENERGY] = {HUBFOC_WHEEL_ENERGY_FRAME_ID, HUBFOC_WHEEL_ENERGY_CYCLE_TIME_MS,
                               true},
};

const char *messages_wheel_text(messages_wheel_t wheel)
{
    switch (wheel) {
    case MESSAGES_FRONT_LEFT:
        return "front left";
    case MESSAGES_FRONT_RIGHT:
        return "front right";
    case MESSAGES_REAR_LEFT:
        return "rear left";
    case MESSAGES_REAR_RIGHT:
        return "rear right";
    }
    return "unknown";
}

uint16_t messages_identifier(messages_kind_t kind, messages_address_t address)
{
    const kind_t *k = &KINDS[kind];
    const int32_t wheel = k->each_wheel ? (int32_t)address.wheel : 0;
    return (uint16_t)(address.base + k->identifier - MESSAGES_BASE + wheel);
}

uint32_t messages_cycle_ms(messages_kind_t kind)
{
    return KINDS[kind].cycle_ms;
}

e2e_profile_t messages_profile(messages_kind_t kind)
{
    const bool commands = kind < MESSAGES_WHEEL_STATE || kind == MESSAGES_WHEEL_BRAKE;
    return commands ? E2E_PROFILE_5 : E2E_PROFILE_2;
}

/* Nearest step, halves away from zero; at most one step beyond the ends. */
static int32_t nearest(int32_t milli, int32_t step, int32_t lowest, int32_t highest)
{
    /* so that half a step more is no overflow */
    const int32_t near = q_clamp(milli, (lowest - 1) * step, (highest + 1) * step);
    return (near + (near < 0 ? -step : step) / 2) / step;
}

/* Nearest step between the ends. */
static int32_t signed_steps(int32_t milli, int32_t step, int32_t highest)
{
    return q_clamp(nearest(milli, step, -highest, highest), -highest, highest);
}

static uint32_t magnitude_steps(int32_t milli, int32_t step, int32_t highest)
{
    return (uint32_t)q_clamp(nearest(milli, step, 0, highest), 0, highest);
}

/* Nearest step; beyond the ends the number that stands for "not available". */
static int32_t sent_steps(int32_t milli, int32_t step, int32_t highest, int32_t not_available)
{
    const int32_t found = nearest(milli, step, -highest, highest);
    return found < -highest || found > highest ? not_available : found;
}

/* Of an available torque: whole steps, rounded down. */
static uint32_t available_steps(int32_t torque_mNm, int32_t highest, uint32_t not_available)
{
    const int32_t found = q_max(torque_mNm, 0) / TORQUE_STEP_mNm;
    return found > highest ? not_available : (uint32_t)found;
}

bool messages_read_demand(const messages_frame_t *frame, wheel_demand_t *demand)
{
    struct hubfoc_demand_t raw;
    if (frame->length != E2E_FRAME_BYTES ||
        hubfoc_demand_unpack(&raw, frame->data, frame->length) != 0 ||
        !hubfoc_demand_drive_torque_nm_is_in_range(raw.drive_torque_nm) ||
        !hubfoc_demand_direction_is_in_range(raw.direction) ||
        !hubfoc_demand_abs_motor_share_percent_is_in_range(raw.abs_motor_share_percent) ||
        !hubfoc_demand_brake_torque_nm_is_in_range(raw.brake_torque_nm)) {
        return false;
    }
    demand->drive_torque_mNm = raw.drive_torque_nm * DEMAND_STEP_mNm;
    demand->brake_torque_mNm = (int32_t)raw.brake_torque_nm * DEMAND_STEP_mNm;
    demand->abs_motor_share_percent = raw.abs_motor_share_percent;
    demand->direction = (drive_direction_t)raw.direction;
    demand->enable = raw.enable != 0;
    demand->abs_active = raw.abs_active != 0;
    demand->fault_reset = raw.fault_reset != 0;
    demand->reason = REASON_NONE;
    return true;
}

bool messages_read_battery(const messages_frame_t *frame, battery_limits_t *limits)
{
    struct hubfoc_battery_limits_t raw;
    if (frame->length != E2E_FRAME_BYTES ||
        hubfoc_battery_limits_unpack(&raw, frame->data, frame->length) != 0 ||
        !hubfoc_battery_limits_contactor_is_in_range(raw.contactor) ||
        !hubfoc_battery_limits_charge_current_a_is_in_range(raw.charge_current_a) ||
        !hubfoc_battery_limits_discharge_current_a_is_in_range(raw.discharge_current_a)) {
        return false;
    }
    limits->charge_current_mA = (int32_t)raw.charge_current_a * CURRENT_STEP_mA;
    limits->discharge_current_mA = (int32_t)raw.discharge_current_a * CURRENT_STEP_mA;
    limits->contactor = (contactor_t)raw.contactor;
    return true;
}

bool messages_read_peak(const messages_frame_t *frame, battery_limits_t *limits)
{
    struct hubfoc_battery_peak_t raw;
    if (frame->length != E2E_FRAME_BYTES ||
        hubfoc_battery_peak_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    limits->voltage_mV = (int32_t)raw.pack_voltage_v * VOLTAGE_STEP_mV;
    limits->charge_peak_current_mA = (int32_t)raw.charge_peak_current_a * PEAK_STEP_mA;
    limits->current_given = raw.pack_current_a != PACK_CURRENT_NOT_GIVEN;
    limits->current_mA = limits->current_given ? raw.pack_current_a * PACK_CURRENT_STEP_mA : 0;
    return true;
}

bool messages_read_hydraulic(const messages_frame_t *frame, hydraulic_feedback_t *feedback)
{
    struct hubfoc_hydraulic_feedback_t raw;
    if (frame->length != E2E_FRAME_BYTES ||
        hubfoc_hydraulic_feedback_unpack(&raw, frame->data, frame->length) != 0 ||
        !hubfoc_hydraulic_feedback_measured_torque_nm_is_in_range(raw.measured_torque_nm)) {
        return false;
    }
    feedback->torque_mNm = (int32_t)raw.measured_torque_nm * TORQUE_STEP_mNm;
    feedback->valid = raw.torque_valid != 0;
    return true;
}

/* What is NOT_AVAILABLE leaves the field as it was. */
static void take(int32_t *field, bool is_available, int32_t raw_steps, int32_t step)
{
    if (is_available) {
        *field = raw_steps * step;
    }
}

static bool read_state(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_state_t raw;
    if (hubfoc_wheel_state_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    o->mode = (operating_mode_t)raw.mode;
    o->fault_reason = (reason_t)raw.fault_reason;
    take(&o->motor_torque_estimate_mNm,
         hubfoc_wheel_state_motor_torque_estimate_nm_is_in_range(raw.motor_torque_estimate_nm),
         raw.motor_torque_estimate_nm, TORQUE_STEP_mNm);
    take(&o->speed_mrad_s, hubfoc_wheel_state_speed_rad_s_is_in_range(raw.speed_rad_s),
         raw.speed_rad_s, SPEED_STEP_mrad_s);
    o->stop_lamp = raw.stop_lamp != 0;
    return true;
}

static bool read_brake(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_brake_t raw;
    if (hubfoc_wheel_brake_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    o->hydraulic_torque_mNm = (int32_t)raw.hydraulic_torque_nm * TORQUE_STEP_mNm;
    take(&o->electric_brake_available_mNm, raw.electric_brake_available_nm <= AVAILABLE_MAX,
         (int32_t)raw.electric_brake_available_nm, TORQUE_STEP_mNm);
    o->hydraulic_valid = raw.hydraulic_valid != 0;
    return true;
}

static bool read_drive(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_drive_t raw;
    if (hubfoc_wheel_drive_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    o->direction = (drive_direction_t)raw.direction;
    o->torque_reason = (reason_t)raw.torque_reason;
    o->hydraulic_reason = (reason_t)raw.hydraulic_reason;
    take(&o->motor_torque_command_mNm,
         hubfoc_wheel_drive_motor_torque_command_nm_is_in_range(raw.motor_torque_command_nm),
         raw.motor_torque_command_nm, TORQUE_STEP_mNm);
    take(&o->i_q_mA, hubfoc_wheel_drive_current_q_a_is_in_range(raw.current_q_a), raw.current_q_a,
         CURRENT_STEP_mA);
    return true;
}

static bool read_power(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_power_t raw;
    if (hubfoc_wheel_power_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    take(&o->bus_voltage_mV, hubfoc_wheel_power_bus_voltage_v_is_in_range(raw.bus_voltage_v),
         raw.bus_voltage_v, VOLTAGE_STEP_mV);
    take(&o->bus_current_mA, hubfoc_wheel_power_bus_current_a_is_in_range(raw.bus_current_a),
         raw.bus_current_a, CURRENT_STEP_mA);
    take(&o->motor_torque_uncertainty_mNm, raw.motor_torque_uncertainty_nm <= UNCERTAINTY_MAX,
         (int32_t)raw.motor_torque_uncertainty_nm, UNCERTAINTY_STEP_mNm);
    return true;
}

static bool read_health(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_health_t raw;
    if (hubfoc_wheel_health_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    o->warning_reason = (reason_t)raw.warning_reason;
    return true;
}

static bool read_ahead(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_ahead_t raw;
    if (hubfoc_wheel_ahead_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    take(&o->electric_brake_ahead_mNm,
         hubfoc_wheel_ahead_electric_brake_ahead_nm_is_in_range(raw.electric_brake_ahead_nm),
         (int32_t)raw.electric_brake_ahead_nm, TORQUE_STEP_mNm);
    o->ahead_reason = (reason_t)raw.ahead_reason;
    take(&o->drive_ahead_mNm, hubfoc_wheel_ahead_drive_ahead_nm_is_in_range(raw.drive_ahead_nm),
         (int32_t)raw.drive_ahead_nm, TORQUE_STEP_mNm);
    o->drive_ahead_reason = (reason_t)raw.drive_ahead_reason;
    return true;
}

static bool read_available(const messages_frame_t *frame, slow_output_t *o)
{
    struct hubfoc_wheel_available_t raw;
    if (hubfoc_wheel_available_unpack(&raw, frame->data, frame->length) != 0) {
        return false;
    }
    take(&o->drive_available_mNm,
         hubfoc_wheel_available_drive_available_nm_is_in_range(raw.drive_available_nm),
         (int32_t)raw.drive_available_nm, TORQUE_STEP_mNm);
    o->drive_available_reason = (reason_t)raw.drive_available_reason;
    o->waits_for = (waits_for_t)raw.waits_for;
    o->available_reason = (reason_t)raw.electric_brake_available_reason;
    return true;
}

bool messages_read_output(const messages_frame_t *frame, messages_address_t address,
                          slow_output_t *output)
{
    if (frame->length != E2E_FRAME_BYTES) {
        return false;
    }
    static bool (*const READ[MESSAGES_WHEEL_ENERGY])(const messages_frame_t *, slow_output_t *) = {
        [MESSAGES_WHEEL_STATE] = read_state,         [MESSAGES_WHEEL_BRAKE] = read_brake,
        [MESSAGES_WHEEL_DRIVE] = read_drive,         [MESSAGES_WHEEL_POWER] = read_power,
        [MESSAGES_WHEEL_HEALTH] = read_health,       [MESSAGES_WHEEL_AHEAD] = read_ahead,
        [MESSAGES_WHEEL_AVAILABLE] = read_available,
    };
    for (int kind = MESSAGES_RECEIVED; kind < MESSAGES_WHEEL_ENERGY; kind++) {
        if (frame->identifier == messages_identifier((messages_kind_t)kind, address)) {
            return READ[kind](frame, output);
        }
    }
    return false;
}

static void protect(messages_frame_t *frame, messages_kind_t kind, uint8_t counter)
{
    e2e_protect(messages_profile(kind), frame->data, frame->identifier, counter);
}

static messages_frame_t new_frame(messages_kind_t kind, messages_address_t address)
{
    const messages_frame_t frame = {.identifier = messages_identifier(kind, address),
                                    .length = E2E_FRAME_BYTES};
    return frame;
}

messages_frame_t messages_demand(const wheel_demand_t *demand, messages_address_t address,
                                 uint8_t counter)
{
    const struct hubfoc_demand_t raw = {
        .enable = demand->enable ? 1 : 0,
        .abs_active = demand->abs_active ? 1 : 0,
        .fault_reset = demand->fault_reset ? 1 : 0,
        .direction = (uint8_t)((uint32_t)demand->direction & DIRECTION_MASK),
        .abs_motor_share_percent = (uint8_t)q_min(demand->abs_motor_share_percent, SHARE_MAX),
        .drive_torque_nm =
            (int16_t)signed_steps(demand->drive_torque_mNm, DEMAND_STEP_mNm, DEMAND_DRIVE_MAX),
        .brake_torque_nm =
            (uint16_t)magnitude_steps(demand->brake_torque_mNm, DEMAND_STEP_mNm, DEMAND_BRAKE_MAX),
    };
    messages_frame_t frame = new_frame(MESSAGES_DEMAND, address);
    (void)hubfoc_demand_pack(frame.data, &raw, sizeof frame.data);
    protect(&frame, MESSAGES_DEMAND, counter);
    return frame;
}

messages_frame_t messages_battery(const battery_limits_t *limits, messages_address_t address,
                                  uint8_t counter)
{
    const struct hubfoc_battery_limits_t raw = {
        .contactor = (uint8_t)limits->contactor,
        .charge_current_a =
            magnitude_steps(limits->charge_current_mA, CURRENT_STEP_mA, BATTERY_CURRENT_MAX),
        .discharge_current_a =
            magnitude_steps(limits->discharge_current_mA, CURRENT_STEP_mA, BATTERY_CURRENT_MAX),
    };
    messages_frame_t frame = new_frame(MESSAGES_BATTERY_LIMITS, address);
    (void)hubfoc_battery_limits_pack(frame.data, &raw, sizeof frame.data);
    protect(&frame, MESSAGES_BATTERY_LIMITS, counter);
    return frame;
}

messages_frame_t messages_peak(const battery_limits_t *limits, messages_address_t address,
                               uint8_t counter)
{
    const struct hubfoc_battery_peak_t raw = {
        .charge_peak_current_a =
            (uint16_t)q_clamp(limits->charge_peak_current_mA / PEAK_STEP_mA, 0, PEAK_MAX),
        .pack_voltage_v = (uint16_t)sent_steps(q_max(limits->voltage_mV, 0), VOLTAGE_STEP_mV,
                                               PACK_VOLTAGE_MAX, PACK_VOLTAGE_NOT_GIVEN),
        .pack_current_a =
            (int16_t)(limits->current_given ? sent_steps(limits->current_mA, PACK_CURRENT_STEP_mA,
                                                         PACK_CURRENT_MAX, PACK_CURRENT_NOT_GIVEN)
                                            : PACK_CURRENT_NOT_GIVEN),
    };
    messages_frame_t frame = new_frame(MESSAGES_BATTERY_PEAK, address);
    (void)hubfoc_battery_peak_pack(frame.data, &raw, sizeof frame.data);
    protect(&frame, MESSAGES_BATTERY_PEAK, counter);
    return frame;
}

messages_frame_t messages_hydraulic(const hydraulic_feedback_t *feedback,
                                    messages_address_t address, uint8_t counter)
{
    const struct hubfoc_hydraulic_feedback_t raw = {
        .torque_valid = feedback->valid ? 1 : 0,
        .measured_torque_nm = magnitude_steps(feedback->torque_mNm, TORQUE_STEP_mNm, TORQUE_MAX),
    };
    messages_frame_t frame = new_frame(MESSAGES_HYDRAULIC_FEEDBACK, address);
    (void)hubfoc_hydraulic_feedback_pack(frame.data, &raw, sizeof frame.data);
    protect(&frame, MESSAGES_HYDRAULIC_FEEDBACK, counter);
    return frame;
}

static void put_state(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o)
{
    const struct hubfoc_wheel_state_t raw = {
        .mode = (uint8_t)((uint32_t)o->mode & MODE_MASK),
        .fault_reason = (uint8_t)o->fault_reason,
        .motor_torque_estimate_nm =
            sent_steps(o->motor_torque_estimate_mNm, TORQUE_STEP_mNm, TORQUE_MAX,
                       HUBFOC_WHEEL_STATE_MOTOR_TORQUE_ESTIMATE_NM_NOT_AVAILABLE_CHOICE),
        .stop_lamp = o->stop_lamp ? 1 : 0,
        .speed_rad_s = sent_steps(o->speed_mrad_s, SPEED_STEP_mrad_s, SPEED_MAX,
                                  HUBFOC_WHEEL_STATE_SPEED_RAD_S_NOT_AVAILABLE_CHOICE),
    };
    (void)hubfoc_wheel_state_pack(data, &raw, E2E_FRAME_BYTES);
}

static void put_brake(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o, uint8_t demand_counter)
{
    const int32_t hydraulic = nearest(o->hydraulic_torque_mNm, TORQUE_STEP_mNm, 0, HYDRAULIC_MAX);
    const struct hubfoc_wheel_brake_t raw = {
        .hydraulic_valid = o->hydraulic_valid && hydraulic <= HYDRAULIC_MAX ? 1 : 0,
        .hydraulic_torque_nm = (uint16_t)q_clamp(hydraulic, 0, HYDRAULIC_MAX),
        .electric_brake_available_nm = (uint16_t)available_steps(
            o->electric_brake_available_mNm, AVAILABLE_MAX,
            HUBFOC_WHEEL_BRAKE_ELECTRIC_BRAKE_AVAILABLE_NM_NOT_AVAILABLE_CHOICE),
        .demand_counter = demand_counter,
    };
    (void)hubfoc_wheel_brake_pack(data, &raw, E2E_FRAME_BYTES);
}

static void put_drive(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o)
{
    const struct hubfoc_wheel_drive_t raw = {
        .direction = (uint8_t)((uint32_t)o->direction & DIRECTION_MASK),
        .torque_reason = (uint8_t)o->torque_reason,
        .hydraulic_reason = (uint8_t)o->hydraulic_reason,
        .motor_torque_command_nm =
            sent_steps(o->motor_torque_command_mNm, TORQUE_STEP_mNm, COMMAND_MAX,
                       HUBFOC_WHEEL_DRIVE_MOTOR_TORQUE_COMMAND_NM_NOT_AVAILABLE_CHOICE),
        .current_q_a = sent_steps(o->i_q_mA, CURRENT_STEP_mA, CURRENT_MAX,
                                  HUBFOC_WHEEL_DRIVE_CURRENT_Q_A_NOT_AVAILABLE_CHOICE),
    };
    (void)hubfoc_wheel_drive_pack(data, &raw, E2E_FRAME_BYTES);
}

static void put_power(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o)
{
    const struct hubfoc_wheel_power_t raw = {
        .bus_voltage_v =
            (uint16_t)sent_steps(q_max(o->bus_voltage_mV, 0), VOLTAGE_STEP_mV, VOLTAGE_MAX,
                                 HUBFOC_WHEEL_POWER_BUS_VOLTAGE_V_NOT_AVAILABLE_CHOICE),
        .bus_current_a = sent_steps(o->bus_current_mA, CURRENT_STEP_mA, CURRENT_MAX,
                                    HUBFOC_WHEEL_POWER_BUS_CURRENT_A_NOT_AVAILABLE_CHOICE),
        .motor_torque_uncertainty_nm = (uint16_t)sent_steps(
            q_max(o->motor_torque_uncertainty_mNm, 0), UNCERTAINTY_STEP_mNm, UNCERTAINTY_MAX,
            HUBFOC_WHEEL_POWER_MOTOR_TORQUE_UNCERTAINTY_NM_NOT_AVAILABLE_CHOICE),
    };
    (void)hubfoc_wheel_power_pack(data, &raw, E2E_FRAME_BYTES);
}

static int16_t temperature_steps(int32_t temperature_cC)
{
    const int32_t found =
        nearest(temperature_cC, TEMPERATURE_STEP_cC, TEMPERATURE_MIN, TEMPERATURE_NOT_AVAILABLE);
    const bool within = found >= TEMPERATURE_MIN && found <= TEMPERATURE_NOT_AVAILABLE;
    return (int16_t)(within ? found : TEMPERATURE_NOT_AVAILABLE);
}

static void put_health(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o,
                       const wheel_temperatures_t *temperature, const messages_links_t *links)
{
    const struct hubfoc_wheel_health_t raw = {
        .demand_link = (uint8_t)links->demand,
        .battery_link = (uint8_t)links->battery,
        .hydraulic_link = (uint8_t)links->hydraulic,
        .peak_link = (uint8_t)links->peak,
        .winding_temperature_c = temperature_steps(temperature->winding_cC),
        .switch_temperature_c = temperature_steps(temperature->switch_cC),
        .demand_errors = (uint8_t)(links->demand_errors & ERRORS_MASK),
        .battery_errors = (uint8_t)(links->battery_errors & ERRORS_MASK),
        .warning_reason = (uint8_t)o->warning_reason,
    };
    (void)hubfoc_wheel_health_pack(data, &raw, E2E_FRAME_BYTES);
}

static void put_ahead(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o)
{
    const struct hubfoc_wheel_ahead_t raw = {
        .electric_brake_ahead_nm =
            available_steps(o->electric_brake_ahead_mNm, TORQUE_MAX,
                            HUBFOC_WHEEL_AHEAD_ELECTRIC_BRAKE_AHEAD_NM_NOT_AVAILABLE_CHOICE),
        .ahead_reason = (uint8_t)o->ahead_reason,
        .drive_ahead_nm = available_steps(o->drive_ahead_mNm, TORQUE_MAX,
                                          HUBFOC_WHEEL_AHEAD_DRIVE_AHEAD_NM_NOT_AVAILABLE_CHOICE),
        .drive_ahead_reason = (uint8_t)o->drive_ahead_reason,
    };
    (void)hubfoc_wheel_ahead_pack(data, &raw, E2E_FRAME_BYTES);
}

static void put_available(uint8_t data[E2E_FRAME_BYTES], const slow_output_t *o)
{
    const struct hubfoc_wheel_available_t raw = {
        .drive_available_nm =
            available_steps(o->drive_available_mNm, TORQUE_MAX,
                            HUBFOC_WHEEL_AVAILABLE_DRIVE_AVAILABLE_NM_NOT_AVAILABLE_CHOICE),
        .drive_available_reason = (uint8_t)o->drive_available_reason,
        .waits_for = (uint8_t)o->waits_for,
        .electric_brake_available_reason = (uint8_t)o->available_reason,
    };
    (void)hubfoc_wheel_available_pack(data, &raw, E2E_FRAME_BYTES);
}

static uint32_t energy_steps(uint32_t energy_10J)
{
    const uint32_t steps = energy_10J / ENERGY_STEP_10J;
    return steps <= ENERGY_MAX ? steps
                               : (uint32_t)HUBFOC_WHEEL_ENERGY_DRAWN_WH_NOT_AVAILABLE_CHOICE;
}

static uint8_t friction_steps(const messages_energy_t *energy)
{
    return (uint8_t)(energy->friction_percent <= SHARE_MAX
                         ? energy->friction_percent
                         : HUBFOC_WHEEL_ENERGY_FRICTION_PERCENT_NOT_AVAILABLE_CHOICE);
}

messages_frame_t messages_energy(const messages_energy_t *since_start,
                                 const messages_energy_t *for_life, messages_address_t address,
                                 uint8_t counter)
{
    const struct hubfoc_wheel_energy_t raw = {
        .account = counter & 1U,
        .drawn_wh = energy_steps(since_start->drawn_10J),
        .returned_wh = energy_steps(since_start->returned_10J),
        .friction_percent = friction_steps(since_start),
        .life_drawn_wh = for_life->drawn_10J / LIFE_ENERGY_STEP_10J,
        .life_returned_wh = for_life->returned_10J / LIFE_ENERGY_STEP_10J,
        .life_friction_percent = friction_steps(for_life),
    };
    messages_frame_t frame = new_frame(MESSAGES_WHEEL_ENERGY, address);
    (void)hubfoc_wheel_energy_pack(frame.data, &raw, sizeof frame.data);
    protect(&frame, MESSAGES_WHEEL_ENERGY, counter);
    return frame;
}

messages_frame_t messages_output(messages_kind_t kind, const messages_values_t *values,
                                 messages_address_t address, uint8_t counter)
{
    if ((uint32_t)kind < MESSAGES_RECEIVED || (uint32_t)kind >= MESSAGES_WHEEL_ENERGY) {
        const messages_frame_t empty = {.length = 0};
        return empty;
    }
    messages_frame_t frame = new_frame(kind, address);
    switch (kind) {
    case MESSAGES_WHEEL_STATE:
        put_state(frame.data, values->output);
        break;
    case MESSAGES_WHEEL_BRAKE:
        put_brake(frame.data, values->output, values->links.demand_counter);
        break;
    case MESSAGES_WHEEL_DRIVE:
        put_drive(frame.data, values->output);
        break;
    case MESSAGES_WHEEL_POWER:
        put_power(frame.data, values->output);
        break;
    case MESSAGES_WHEEL_HEALTH:
        put_health(frame.data, values->output, values->temperature, &values->links);
        break;
    case MESSAGES_WHEEL_AHEAD:
        put_ahead(frame.data, values->output);
        break;
    case MESSAGES_WHEEL_AVAILABLE:
        put_available(frame.data, values->output);
        break;
    case MESSAGES_DEMAND:
    case MESSAGES_HYDRAULIC_FEEDBACK:
    case MESSAGES_BATTERY_LIMITS:
    case MESSAGES_BATTERY_PEAK:
    case MESSAGES_WHEEL_ENERGY:
    case MESSAGES_KINDS:
        break; /* excluded above */
    }
    protect(&frame, kind, counter);
    return frame;
}
