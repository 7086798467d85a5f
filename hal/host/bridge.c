/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board's bridge, sensors and passing time. */
#include <string.h>

#include "board.h"
#include "hal/analog.h"
#include "hal/inverter.h"
#include "hal/power.h"
#include "hal/rotor_sensor.h"
#include "hal/time.h"
#include "hal/upcall.h"
#include "host/port.h"

/* The compare values are those of the STM32F405. */
enum {
    TIMER_Hz = 168000000,
    DEAD_TIME_MAX_ns = 6000,
    MILLISECONDS_PER_SECOND = 1000,
    STOP_PERIODS = 1
};

static struct {
    host_plant_t plant;
    host_sample_t sample; /* of this period */
    inverter_mode_t mode; /* requested; active from the next top on */
    uint16_t compare_counts[3];
    uint32_t frequency_Hz;
    uint32_t share_of_millisecond; /* counts up to frequency_Hz by 1000 a period */
    uint32_t milliseconds;
    uint32_t periods_left;
    bool endless;
    bool clock_broken;
    bool sensor_missing;
    bool tripped;
    uint32_t stale_periods; /* since inverter_set() */
    bool pwm_started;
    bool tick_started;
    bool pwm_period_hangs, millisecond_hangs;
} board;

static void reset(const host_plant_t *plant)
{
    memset(&board, 0, sizeof board);
    board.plant = *plant;
    board.endless = true;
}

void host_connect(const host_plant_t *plant, const void *configuration, uint32_t size_bytes)
{
    reset(plant);
    board_reset_memory(configuration, size_bytes);
    board_reset_lines();
    board_reset_packets();
}

void host_restart(reset_cause_t cause)
{
    const host_plant_t plant = board.plant;
    reset(&plant);
    board_restart_lines(cause);
    board_reset_packets();
    if (cause == RESET_POWER) {
        board_forget();
    }
}

bool board_bridge_on(void)
{
    return board.mode != INVERTER_MODE_OFF;
}

void host_run_for(uint32_t periods)
{
    board.periods_left = periods;
    board.endless = periods == 0;
}

void host_break_clock(bool broken)
{
    board.clock_broken = broken;
}

void host_remove_rotor_sensor(bool missing)
{
    board.sensor_missing = missing;
}

void host_hang(bool pwm_period, bool millisecond)
{
    board.pwm_period_hangs = pwm_period;
    board.millisecond_hangs = millisecond;
}

void host_millisecond(void)
{
    board.milliseconds++;
    board_watchdog_tick();
    if (board.tick_started && !board.millisecond_hangs) {
        app_millisecond_isr();
    }
}

/* 1.5 periods after the last call: between the tops of the first and of the second period without
 * one. Here it shows at the second. */
static void watch_stop_timer(void)
{
    board.stale_periods++;
    if (board.mode == INVERTER_MODE_PWM && board.stale_periods > STOP_PERIODS) {
        inverter_trip();
    }
}

void host_pwm_period(void)
{
    if (board.pwm_started) {
        watch_stop_timer();
        board.plant.drive(board.plant.context, board.mode, board.compare_counts);
        board.sample = board.plant.sample(board.plant.context);
        if (!board.pwm_period_hangs) {
            app_pwm_period_isr();
        }
    }
}

/* Without a running PWM the tick alone makes time pass, at the same rate. */
void host_step(void)
{
    host_pwm_period();
    const uint32_t frequency_Hz =
        board.frequency_Hz != 0 ? board.frequency_Hz : MILLISECONDS_PER_SECOND;
    board.share_of_millisecond += MILLISECONDS_PER_SECOND;
    if (board.share_of_millisecond >= frequency_Hz) {
        board.share_of_millisecond -= frequency_Hz;
        host_millisecond();
    }
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
    board.frequency_Hz = settings->pwm_frequency_Hz;
    board.sample = board.plant.sample(board.plant.context);
    return INVERTER_OK;
}

void inverter_start(void)
{
    board.pwm_started = true;
}

void inverter_set(inverter_mode_t mode, const uint16_t compare_counts[3])
{
    board.stale_periods = 0;
    board.mode = inverter_fault() ? INVERTER_MODE_OFF : mode;
    memcpy(board.compare_counts, compare_counts, sizeof board.compare_counts);
}

void inverter_trip(void)
{
    board.tripped = true;
    board.mode = INVERTER_MODE_OFF;
}

bool inverter_fault(void)
{
    return board.tripped || board.sample.power_stage_fault;
}

bool power_off(void)
{
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
    board.tripped = false;
}

analog_scale_t analog_scale(void)
{
    const analog_scale_t any = {.switch_25C_code = 0};
    return any;
}

void analog_read(analog_sample_t *sample)
{
    memcpy(sample->phase_current_code, board.sample.phase_current_code,
           sizeof sample->phase_current_code);
    sample->bus_voltage_code = board.sample.bus_voltage_code;
}

int32_t analog_winding_temperature_cC(const analog_curve_t *curve)
{
    (void)curve;
    return board.sample.winding_temperature_cC;
}

int32_t analog_switch_temperature_cC(const analog_curve_t *curve)
{
    (void)curve;
    return board.sample.switch_temperature_cC;
}

bool analog_pedals(uint16_t code[ANALOG_PEDAL_CHANNELS])
{
    memcpy(code, board.sample.pedal_code, sizeof board.sample.pedal_code);
    return true;
}

bool rotor_sensor_init(rotor_sensor_kind_t kind)
{
    (void)kind; /* the sample has all of them */
    return !board.sensor_missing;
}

uint16_t rotor_sensor_angle_turn(void)
{
    return board.sample.rotor_angle_turn;
}

uint8_t rotor_sensor_hall_state(void)
{
    return board.sample.hall_state;
}

rotor_sensor_encoder_t rotor_sensor_encoder(void)
{
    return board.sample.encoder;
}

bool time_init(void)
{
    return !board.clock_broken;
}

void time_start_tick(void)
{
    board.tick_started = true;
}

uint32_t time_ms(void)
{
    return board.milliseconds;
}

uint32_t time_cycles(void)
{
    return 0;
}

bool time_running(void)
{
    if (!board.endless) {
        if (board.periods_left == 0) {
            return false;
        }
        board.periods_left--;
    }
    host_step();
    return true;
}
