/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The bridge, the sensors and CAN of a board at rest, through the mailbox. SysTick is the PWM
 * period, with the highest priority, as on a real board; it interrupts the millisecond.
 */
#include "hal/analog.h"
#include "hal/can.h"
#include "hal/inverter.h"
#include "hal/packets.h"
#include "hal/power.h"
#include "hal/random.h"
#include "hal/rotor_sensor.h"
#include "hal/upcall.h"
#include "mailbox.h"
#include "memory_map.h"
#include "semihost.h"
#include "vectors.h"

enum {
    CODE_MID = 2048,
    BUS_CODE_DEFAULT = 3513, /* 53 V of 61.8 V; bus_code=NUMBER on the command line overrides it */
    HALL_DEFAULT = 5,
    ROOM_TEMPERATURE_cC = 2500,
    TIMER_Hz = 168000000,    /* there is none; compare values are those of the STM32F405 */
    DEAD_TIME_MAX_ns = 6000, /* what the timer of the flashable port can make */
    SYSTICK_RUN = 7
};

static uint32_t period_ticks;

static void put_motor_at_rest(void)
{
    for (int x = 0; x < 3; x++) {
        MAILBOX->phase_current_code[x] = CODE_MID;
    }
    MAILBOX->bus_voltage_code = (uint16_t)semihost_option("bus_code", BUS_CODE_DEFAULT);
    MAILBOX->rotor_angle_turn = 0;
    MAILBOX->hall_state = HALL_DEFAULT;
    MAILBOX->encoder_count = 0;
    MAILBOX->encoder_index_count = 0;
    MAILBOX->encoder_index = 0;
    MAILBOX->power_stage_fault = (uint8_t)semihost_option("power_stage_fault", 0);
    MAILBOX->winding_temperature_cC = ROOM_TEMPERATURE_cC;
    MAILBOX->switch_temperature_cC = ROOM_TEMPERATURE_cC;
    MAILBOX->magic = MAILBOX_MAGIC;
}

uint32_t inverter_timer_Hz(void)
{
    return TIMER_Hz;
}

uint32_t inverter_dead_time_least_ns(void)
{
    return 0;
}

static bool frequency_fits(const inverter_settings_t *settings)
{
    const uint32_t frequency_Hz = TIMER_Hz / (2U * settings->pwm_period_counts);
    const uint32_t tolerance_Hz = settings->pwm_frequency_Hz / 1000U;
    return frequency_Hz + tolerance_Hz >= settings->pwm_frequency_Hz &&
           frequency_Hz <= settings->pwm_frequency_Hz + tolerance_Hz;
}

inverter_status_t inverter_init(const inverter_settings_t *settings)
{
    if (!frequency_fits(settings)) {
        return INVERTER_FREQUENCY_UNSUPPORTED;
    }
    if (settings->dead_time_ns > DEAD_TIME_MAX_ns) {
        return INVERTER_DEAD_TIME_UNSUPPORTED;
    }
    period_ticks = PROCESSOR_CLOCK_Hz / settings->pwm_frequency_Hz;
    if (MAILBOX->magic != MAILBOX_MAGIC) {
        put_motor_at_rest();
    }
    MAILBOX->mode = INVERTER_MODE_OFF;
    MAILBOX->tripped = 0;
    MAILBOX->periods = 0;
    return INVERTER_OK;
}

void inverter_start(void)
{
    SCB_SHPR[15 - 4] = 0;
    *SYSTICK_RVR = period_ticks - 1U;
    *SYSTICK_CVR = 0;
    *SYSTICK_CSR = SYSTICK_RUN;
}

void systick_handler(void)
{
    app_pwm_period_isr();
    MAILBOX->periods = MAILBOX->periods + 1U;
}

void inverter_set(inverter_mode_t mode, const uint16_t compare_counts[3])
{
    const bool follow = mode == INVERTER_MODE_PWM;
    for (int x = 0; x < 3; x++) {
        MAILBOX->compare_counts[x] =
            follow ? compare_counts[x] : 0; /* ignored in a short circuit */
    }
    MAILBOX->mode = (uint8_t)(inverter_fault() ? INVERTER_MODE_OFF : mode);
}

void inverter_trip(void)
{
    MAILBOX->tripped = 1;
    MAILBOX->mode = INVERTER_MODE_OFF;
}

bool inverter_fault(void)
{
    return MAILBOX->tripped != 0 || MAILBOX->power_stage_fault != 0;
}

bool power_off(void)
{
    return false;
}

/* An emulated core, whose clock counts instructions, has nothing that cannot be predicted. */
bool random_draw(uint64_t *bits)
{
    *bits = 0;
    return false;
}

bool packets_receive(packet_t *packet)
{
    packet->length = 0;
    return false;
}

bool packets_send(const packet_t *packet)
{
    (void)packet;
    return false;
}

bool power_request_bootloader(void)
{
    return false;
}

uint32_t inverter_driver_status(void)
{
    return 0;
}

void inverter_clear_fault(void)
{
    MAILBOX->tripped = 0;
}

analog_scale_t analog_scale(void)
{
    const analog_scale_t any = {.switch_25C_code = 0};
    return any;
}

void analog_read(analog_sample_t *sample)
{
    for (int x = 0; x < 3; x++) {
        sample->phase_current_code[x] = MAILBOX->phase_current_code[x];
    }
    sample->bus_voltage_code = MAILBOX->bus_voltage_code;
}

int32_t analog_winding_temperature_cC(const analog_curve_t *curve)
{
    (void)curve;
    return MAILBOX->winding_temperature_cC;
}

int32_t analog_switch_temperature_cC(const analog_curve_t *curve)
{
    (void)curve;
    return MAILBOX->switch_temperature_cC;
}

bool analog_pedals(uint16_t code[ANALOG_PEDAL_CHANNELS])
{
    (void)code; /* the mailbox has no pedals */
    return false;
}

bool rotor_sensor_init(rotor_sensor_kind_t kind)
{
    (void)kind; /* the mailbox has all of them */
    return true;
}

uint16_t rotor_sensor_angle_turn(void)
{
    return MAILBOX->rotor_angle_turn;
}

uint8_t rotor_sensor_hall_state(void)
{
    return MAILBOX->hall_state;
}

rotor_sensor_encoder_t rotor_sensor_encoder(void)
{
    const rotor_sensor_encoder_t seen = {.count = MAILBOX->encoder_count,
                                         .index_count = MAILBOX->encoder_index_count,
                                         .index = MAILBOX->encoder_index != 0};
    MAILBOX->encoder_index = 0;
    return seen;
}

/* The machine has no CAN controller: it reports itself missing, which the application must cope
 * with anyway. */
bool can_init(const uint16_t *accepted_identifiers, uint32_t count)
{
    (void)accepted_identifiers;
    (void)count;
    return false;
}

bool can_receive(can_frame_t *frame)
{
    (void)frame;
    return false;
}

bool can_transmit(const can_frame_t *frame)
{
    (void)frame;
    return false;
}

can_progress_t can_progress(uint32_t identifier)
{
    (void)identifier;
    return CAN_ABORTED;
}

bool can_bus_off(void)
{
    return false;
}
