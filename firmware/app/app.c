/* SPDX-License-Identifier: Apache-2.0 */
#include "app/app.h"

#include <stddef.h>

#include "app/background_check.h"
#include "app/boot.h"
#include "app/can_link.h"
#include "app/console.h"
#include "app/double_buffer.h"
#include "app/energy_frame.h"
#include "app/fault_journal.h"
#include "app/kept_hold.h"
#include "app/kept_temperature.h"
#include "app/pedal_link.h"
#include "app/pwm_period.h"
#include "app/recorder.h"
#include "app/report_timer.h"
#include "app/service.h"
#include "app/supervisor.h"
#include "app/vesc_link.h"
#include "config/demand_age.h"
#include "controller/controller.h"
#include "hal/analog.h"
#include "hal/can.h"
#include "hal/flash.h"
#include "hal/inverter.h"
#include "hal/memory.h"
#include "hal/time.h"
#include "hal/upcall.h"
#include "hal/watchdog.h"

enum {
    FINISH_PASSES =
        100000, /* of the console, more than the closing line needs at the lowest bit rate */
    FAST_TIMEOUT_ms = 3, /* without a fast step; a millisecond has at least four */
    DAMAGED_PASSES = 2,  /* of the background */
    /* Of the watchdog without control: on the internal oscillator a pass of the background that
     * checks a received configuration takes 30 ms. */
    BOOT_TIMEOUT_ms = 1000,
    JOURNAL_PERIOD_ms = 1000 /* between two records, at least */
};

/* Results of the slow step for the background. */
typedef struct {
    slow_output_t output;
    supervisor_counts_t counts;
    slow_input_t input;
    torque_limits_t limits;
    pedals_output_t pedals; /* with wired pedals only */
    dq16_t u_pu;            /* fast_report_t */
} snapshot_t;

/* The one instance: interrupts have no other way to find their data. Each member has one writer,
 * named on the right. */
/* In memory that keeps its content over a reset. */
typedef struct {
    recorder_memory_t recorder;
    kept_temperature_t temperature;
    kept_hold_t hold;
} retained_t;

_Static_assert(sizeof(retained_t) <= 8192, "the ports keep 8 KiB");

static struct {
    boot_report_t boot; /* boot */
    const config_t
        *volatile config; /* boot, background; NULL when the control steps must not run */

    /* Near the beginning, where one instruction of the PWM period reaches them. */
    double_buffer_t to_fast; /* low side millisecond, high side PWM period */
    fast_setpoint_t fast_setpoint[2];
    double_buffer_t from_fast; /* low side millisecond, high side PWM period */
    fast_report_t fast_report[2];
    report_timer_t report_timer;         /* PWM period */
    fast_input_t fast_input;             /* PWM period; zero what the rotor sensor does not give */
    volatile uint32_t fast_cycles_worst; /* PWM period */
    scope_t *volatile recording;         /* background; NULL: service_fast_step() is not called */
    recorder_t recorder;                 /* millisecond, and at boot */
    retained_t *retained;                /* likewise; NULL: this board has none */
    recorder_memory_t *volatile samples; /* millisecond; NULL: no more for the black box */
    controller_t controller;             /* .fast: PWM period, .slow: millisecond */

    uint32_t fast_missing_ms; /* millisecond; consecutive ones without a fast step */
    double_buffer_t to_slow;  /* low side background, high side millisecond */
    node_command_t commands[2];
    double_buffer_t from_slow; /* low side background, high side millisecond */
    snapshot_t snapshot[2];

    volatile bool memory_good, config_good; /* background */
    pedal_link_t pedals;                    /* millisecond */
    slow_input_t slow_input;                /* millisecond */
    supervisor_t supervisor;                /* background, like everything below */
    background_check_t check;
    uint32_t damaged_passes; /* in a row, of the fast monitor's variables */
    can_link_t can;
    pedal_sender_t pedal_sender;
    service_t service;
    service_view_t view;
    console_t console;
    vesc_link_t vesc;
    fault_journal_t journal;
    uint32_t journal_ms;      /* of the latest record, or attempt */
    uint16_t slow_steps_seen; /* of the snapshot, and when it last was another one */
    uint32_t slow_step_ms;
    bool restarting; /* the watchdog is no longer fed */
} app;

static void start_recorder(const config_t *config)
{
    const memory_window_t retained = memory_retained();
    const recorder_start_t start = {.pwm_frequency_Hz = (uint32_t)config->drive.pwm_frequency_Hz,
                                    .config_crc32 = config->crc32,
                                    .was_watchdog = app.boot.reset_cause == RESET_WATCHDOG ||
                                                    app.boot.reset_cause == RESET_WINDOW_WATCHDOG,
                                    .reset_cause = (uint8_t)app.boot.reset_cause};
    const bool fits = 4U * retained.words >= sizeof(retained_t);
    /* Not volatile for the recorder: one core, and a compiler does not move stores beyond a call.
     */
    app.retained = fits ? (retained_t *)(uintptr_t)retained.begin : NULL;
    recorder_init(&app.recorder, fits ? &app.retained->recorder : NULL, &start);
    if (app.recorder.memory != NULL) {
        fault_journal_number(&app.journal, app.recorder.memory);
    }
}

/* What a reset has not changed: the motor is as hot, the vehicle stands on its slope. */
static void start_as_before(controller_slow_t *slow, retained_t *retained)
{
    const hill_hold_kept_t hold = kept_hold_read(&retained->hold);
    controller_start_warm(slow, kept_temperature_read(&retained->temperature));
    controller_start_hold(slow, hold);
    kept_hold_write(&retained->hold, hold);
}

static void join_bus(const config_t *config)
{
    static const service_link_t LINK = {.fast = &app.controller.fast,
                                        .fast_input = &app.fast_input,
                                        .findings = &app.controller.slow.findings,
                                        .recording = &app.recording};
    static const vesc_link_t NONE_SENT = {.pending = false};
    uint16_t identifier;
    app.vesc = NONE_SENT;
    service_init(&app.service, config, &LINK);
    const bool serves = service_accepts(&app.service, &identifier);
    (void)can_link_init(&app.can, config, serves ? &identifier : NULL, time_ms());
}

static void start_control(const config_t *config)
{
    start_recorder(config);
    background_check_init(&app.check, config, flash_firmware(), flash_firmware_crc32());
    app.memory_good = true;
    app.config_good = true;
    app.damaged_passes = 0;
    const int32_t timer_Hz = (int32_t)inverter_timer_Hz();
    controller_init(&app.controller, config, timer_Hz);
    if (app.retained != NULL) {
        start_as_before(&app.controller.slow, app.retained);
    }
    for (int i = 0; i < 2; i++) {
        app.fast_setpoint[i] = controller_initial_setpoint(config, timer_Hz);
        controller_fast_report(&app.controller.fast, &app.fast_report[i]);
    }
    report_timer_init(&app.report_timer, (uint32_t)config->drive.pwm_frequency_Hz,
                      CONTROLLER_SLOW_RATE_HZ);
    supervisor_init(&app.supervisor, (uint32_t)config->drive.pwm_frequency_Hz,
                    CONTROLLER_SLOW_RATE_HZ);
    /* Without CAN the demand counts as lost, which is safe. */
    join_bus(config);
    pedal_link_init(&app.pedals);
    pedal_sender_init(&app.pedal_sender, time_ms());
    app.commands[0] = app.can.node.command;
    app.commands[1] = app.can.node.command;
    app.config = config;
    inverter_start();
}

void app_boot(void)
{
    /* Too large for the stack. */
    static const snapshot_t empty = {.pedals = {.age_ms = UINT32_MAX}};
    const fast_input_t no_input = {.power_stage_fault = false};
    app.config = NULL;
    app.fast_cycles_worst = 0;
    app.fast_input = no_input;
    app.fast_missing_ms = 0;
    app.samples = NULL; /* until the first slow step */
    app.restarting = false;
    app.slow_steps_seen = 0;
    app.slow_step_ms = 0;
    app.snapshot[0] = empty;
    app.snapshot[1] = empty;
    double_buffer_init(&app.to_fast);
    double_buffer_init(&app.from_fast);
    double_buffer_init(&app.to_slow);
    double_buffer_init(&app.from_slow);
    console_init(&app.console, &app.boot);

    app.boot = boot_run();
    console_greet(&app.console);
    fault_journal_init(&app.journal);
    app.journal_ms = 0;
    if (app.boot.reset_cause <= RESET_POWER) { /* else the wheel may be turning: control first */
        fault_journal_make_space(&app.journal);
    }
    watchdog_start(boot_may_control(&app.boot) ? SUPERVISOR_TIMEOUT_ms : BOOT_TIMEOUT_ms);
    if (boot_may_control(&app.boot)) {
        start_control(app.boot.config);
    } else if (boot_knows_address(&app.boot)) {
        (void)can_link_init(&app.can, app.boot.config, NULL, time_ms());
    }
    time_start_tick();
}

_Static_assert((int)NODE_PACK_CURRENT_AGE_ms < (int)MONITOR_WINDOW_QUALIFY_STEPS,
               "one message of the battery is no fault of the current sensors");

/* The report is copied in the last period before the slow step takes and completes it. */
static void report_when_due(void)
{
    const unsigned high = double_buffer_high(&app.from_fast);
    if (report_timer_is_due(&app.report_timer, high)) {
        controller_fast_report_copy(&app.controller.fast, &app.fast_report[high]);
        double_buffer_mark(&app.from_fast);
    }
}

/* The sensors that there are not read as zero (fast_input), so the sum is the one there is. */
static void record(const fast_input_t *in, const fast_output_t *out)
{
    recorder_memory_t *samples = app.samples;
    if (samples == NULL) {
        return;
    }
    const recorder_fast_t sample = {
        .phase_code = {in->phase_current_code[0], in->phase_current_code[1],
                       in->phase_current_code[2]},
        .bus_code = in->bus_voltage_code,
        .rotor = (uint16_t)(in->rotor_angle_turn + in->encoder.count + in->hall_state),
        .on_a_counts = out->compare_counts[0],
    };
    recorder_fast(samples, &sample, out->bridge);
}

void app_pwm_period_isr(void)
{
    const config_t *config = app.config;
    if (config == NULL) {
        return;
    }
    const uint32_t begin_cycles = time_cycles();
    const fast_setpoint_t *from_slow = &app.fast_setpoint[double_buffer_high(&app.to_fast)];
    const fast_output_t *out =
        pwm_period_step(&app.controller.fast, config, from_slow, &app.fast_input);
    record(&app.fast_input, out);
    report_when_due();
    scope_t *recording = app.recording;
    if (recording != NULL) {
        service_fast_step(recording, &app.controller.fast);
    }

    const uint32_t cycles = time_cycles() - begin_cycles;
    if (cycles > app.fast_cycles_worst) {
        app.fast_cycles_worst = cycles;
    }
}

static void fill_slow_input(slow_input_t *in, const node_command_t *command)
{
    in->demand = command->demand;
    in->demand_age_ms = node_demand_age_ms(command, time_ms());
    in->bms = command->bms;
    in->hydraulic = node_hydraulic(command, time_ms());
    const config_temperature_t *sensors = &app.config->temperature;
    const analog_curve_t winding = {sensors->winding_cC, sensors->winding_lowest_code,
                                    sensors->winding_highest_code};
    const analog_curve_t switches = {sensors->switch_cC, sensors->switch_lowest_code,
                                     sensors->switch_highest_code};
    in->temperature.winding_cC = analog_winding_temperature_cC(&winding);
    in->temperature.switch_cC = analog_switch_temperature_cC(&switches);
    in->selftest_passed = boot_selftest_passed(&app.boot) && app.memory_good;
    in->config_accepted = app.config_good; /* accepted at boot, or no slow step runs */
}

/* Without fast steps the timer repeats the last compare values: a constant voltage vector, in which
 * the turning rotor drives nearly its short-circuit current until the watchdog resets the core. A
 * port's stop timer ends that within two periods (hal/inverter.h); here the bridge is switched off
 * whatever it does, as the reset would do, and for good. */
static void watch_fast_loop(bool has_stepped)
{
    if (has_stepped) {
        app.fast_missing_ms = 0;
    } else if (app.fast_missing_ms < FAST_TIMEOUT_ms) {
        app.fast_missing_ms++;
    }
    if (app.fast_missing_ms >= FAST_TIMEOUT_ms) {
        inverter_trip();
    }
}

void app_millisecond_isr(void)
{
    const config_t *config = app.config;
    if (config == NULL) {
        return;
    }
    watch_fast_loop(
        double_buffer_take(&app.from_fast)); /* the monitor checks the step count as well */
    fast_report_t *from_fast = &app.fast_report[double_buffer_low(&app.from_fast)];
    controller_fast_report_complete(from_fast);
    fast_setpoint_t *to_fast = &app.fast_setpoint[double_buffer_low(&app.to_fast)];
    const node_command_t *command = &app.commands[double_buffer_high(&app.to_slow)];
    fill_slow_input(&app.slow_input, command);

    snapshot_t *snapshot = &app.snapshot[double_buffer_high(&app.from_slow)];
    if (pedals_wired(config)) {
        pedal_link_step(&app.pedals, config, &app.slow_input);
        snapshot->pedals = app.pedals.out;
    }
    if (demand_needs_transmission(config)) {
        node_hand_over(command, time_ms(), &app.slow_input);
    }
    snapshot->output =
        controller_slow_step(&app.controller.slow, config, from_fast, &app.slow_input, to_fast);
    snapshot->input = app.slow_input;
    snapshot->limits = *controller_limits(&app.controller.slow);
    snapshot->u_pu = from_fast->u_pu;
    snapshot->counts.fast_steps = from_fast->sequence;
    snapshot->counts.slow_steps = to_fast->sequence;
    snapshot->counts.monitor_steps = app.controller.slow.monitor.steps;
    if ((to_fast->clear_trip || to_fast->release_break) && app.fast_missing_ms == 0) {
        inverter_clear_fault(); /* the hardware's latch is released with the monitor's, or for the
                                   short circuit that a stuck switch calls for; never on its own */
    }
    service_slow_step(&app.service, &snapshot->output, &snapshot->input);
    recorder_slow(&app.recorder, &snapshot->output, &snapshot->input.temperature);
    if (app.retained != NULL) {
        kept_temperature_write(&app.retained->temperature,
                               controller_warmest_cC(&app.controller.slow));
        kept_hold_follow(&app.retained->hold, controller_hold(&app.controller.slow));
    }
    app.samples = app.recorder.takes_samples ? app.recorder.memory : NULL;
    double_buffer_swap(&app.to_fast);
    double_buffer_mark(&app.from_slow);
}

static const snapshot_t *latest_snapshot(void)
{
    (void)double_buffer_take(&app.from_slow);
    return &app.snapshot[double_buffer_low(&app.from_slow)];
}

static report_status_t status_of(const snapshot_t *snapshot)
{
    const report_status_t status = {
        .output = &snapshot->output,
        .limits = &snapshot->limits,
        .node = &app.can.node,
        .fast_cycles_worst = app.fast_cycles_worst,
        .stack_free_bytes = memory_stack_free_bytes(),
        .driver_status = inverter_driver_status(),
        .bus_off = can_bus_off(),
        .control = app.config != NULL,
        .black_box = app.recorder.memory,
        .journal = &app.journal,
    };
    return status;
}

/* True if the configuration may be replaced: torque is not enabled and the wheel is at standstill
 * (monitor_speed.h). A board on which neither sensor nor current ever showed a movement counts as
 * at standstill, so that it can be set up on a bench. Without control the bridge is off. */
static bool is_at_standstill(const slow_output_t *output)
{
    const bool switched_on = output->mode == MODE_RUN || output->mode == MODE_LIMP;
    return app.config == NULL || (!switched_on && output->standstill);
}

/* Torque is not enabled and the wheel at rest. A board that is kept so begins a record a second at
 * most, and after a failure the next start finds the place behind it. */
static void write_journal(const snapshot_t *snapshot, uint32_t now_ms)
{
    const recorder_memory_t *box = app.recorder.memory;
    const uint32_t pause_ms = app.journal.written_bytes > 0 ? 1 : JOURNAL_PERIOD_ms;
    if (box == NULL || now_ms - app.journal_ms < pause_ms || !is_at_standstill(&snapshot->output) ||
        !fault_journal_is_due(&app.journal, box)) {
        return;
    }
    app.journal_ms = now_ms;
    (void)fault_journal_append(&app.journal, box);
}

/* The watchdog restarts the core. */
static void stop_control(void)
{
    app.config = NULL;
    app.restarting = true;
    recorder_expect_restart(&app.recorder);
}

/* Control ends here, because the core stands still while the memory is erased. */
static void replace_configuration(const snapshot_t *snapshot)
{
    const bool permitted = is_at_standstill(&snapshot->output);
    if (permitted) {
        stop_control();
    }
    console_install(&app.console, permitted);
}

/* The tool's staging page: in order as a whole, and the wheel as for any other configuration. */
static xcp_error_t objection_to_staging(const snapshot_t *snapshot)
{
    const config_result_t result = installer_check_staging(&app.console.installer);
    if (result.code != CONFIG_RESULT_OK) {
        console_refuse_staging(&app.console, &result);
        return XCP_ERROR_OUT_OF_RANGE;
    }
    return is_at_standstill(&snapshot->output) ? XCP_ERROR_NONE : XCP_ERROR_NOT_ACCESSIBLE_NOW;
}

/* XCP on the serial line. */
static void receive_serial(uint32_t now_ms)
{
    uint32_t length;
    const uint8_t *packet = console_xcp_packet(&app.console.xcp, &length);
    if (packet != NULL) {
        service_receive_serial(&app.service, &app.view, packet, length, now_ms);
    }
    if (console_xcp_has_ended(&app.console.xcp)) {
        service_end_serial(&app.service, &app.view, now_ms);
    }
}

static void answer_serial(void)
{
    const uint8_t *packet;
    const uint32_t length = service_serial_answer(&app.service, &packet);
    if (length > 0) {
        console_xcp_answer(&app.console.xcp, packet, length);
    }
}

/* A staging page is stored as a received configuration is, when the tool has its answer. */
static void serve(const snapshot_t *snapshot, uint32_t now_ms)
{
    installer_t *installer = &app.console.installer;
    app.view.output = &snapshot->output;
    app.view.input = &snapshot->input;
    app.view.in_force = app.config;
    app.view.staging = installer_staging(installer);
    const can_frame_t *command = can_link_service(&app.can);
    if (command != NULL) {
        service_receive(&app.service, &app.view, command, now_ms);
    }
    receive_serial(now_ms);
    if (service_wants_store(&app.service)) {
        service_store(&app.service, objection_to_staging(snapshot), now_ms);
    }
    service_step(&app.service, &app.view, now_ms);
    answer_serial();
    if (service_store_is_due(&app.service, now_ms) && app.view.staging != NULL) {
        installer_accept_staging(installer);
    }
}

/* False while the slow loop stands still: its last commands are then not sent any more, so that the
 * brake system sees a counter that stands still and keeps the brake by its own timeout. */
static bool slow_loop_steps(const snapshot_t *snapshot, uint32_t now_ms)
{
    if (snapshot->counts.slow_steps != app.slow_steps_seen) {
        app.slow_steps_seen = snapshot->counts.slow_steps;
        app.slow_step_ms = now_ms;
    }
    return now_ms - app.slow_step_ms < APP_SLOW_STOPPED_ms;
}

/* What the wheel says of itself while the slow loop stands still. The fast loop, which has missed
 * its setpoints for 4 ms, has switched the bridge to its safe state. */
static void report_stopped_loop(uint32_t now_ms)
{
    snapshot_t *last = &app.snapshot[double_buffer_low(&app.from_slow)];
    last->output.mode = MODE_FAULT;
    last->output.fault_reason = REASON_PROGRAM_FLOW;
    last->output.motor_torque_estimate_mNm = 0;
    can_link_transmit_state(&app.can, now_ms, &last->output, &last->input.temperature);
}

static void send_vesc_status(const snapshot_t *snapshot, uint32_t now_ms)
{
    const vesc_link_view_t view = {.output = &snapshot->output,
                                   .temperature = &snapshot->input.temperature,
                                   .u_pu = snapshot->u_pu,
                                   .slow_steps = snapshot->counts.slow_steps};
    vesc_link_step(&app.vesc, app.config, &view, &app.journal.energy, now_ms);
}

/* Trip and limits of the fast monitor, twice in a row because a trip may come in between. */
static bool safety_variables_good(void)
{
    const bool intact = monitor_fast_intact(&app.controller.fast.monitor, app.config);
    app.damaged_passes = intact ? 0 : app.damaged_passes + 1U;
    return app.damaged_passes < DAMAGED_PASSES;
}

void app_background(void)
{
    const uint32_t now_ms = time_ms();
    const snapshot_t *snapshot = latest_snapshot();
    if (app.restarting) {
        /* the watchdog is not fed; the console still prints the result */
    } else if (app.config == NULL) {
        watchdog_feed(); /* bridge off; a restart would only hide the reason */
        if (boot_knows_address(&app.boot)) {
            can_link_transmit_boot(&app.can, now_ms, boot_waits_for(&app.boot));
        }
    } else {
        if (!background_check_step(&app.check, memory_stack_free_bytes())) {
            app.memory_good = false;
            app.config_good = !app.check.config_damaged;
        }
        if (!safety_variables_good()) {
            app.memory_good = false;
        }
        if (supervisor_may_feed(&app.supervisor, snapshot->counts)) {
            watchdog_feed();
        }
        if (can_link_receive(&app.can, now_ms)) {
            app.commands[double_buffer_low(&app.to_slow)] = app.can.node.command;
            double_buffer_swap(&app.to_slow);
        }
        serve(snapshot, now_ms);
        energy_step(&app.journal.energy, &snapshot->output, snapshot->counts.slow_steps);
        write_journal(snapshot, now_ms);
        if (pedals_wired(app.config)) {
            pedal_sender_transmit(&app.pedal_sender, app.config, &snapshot->pedals, now_ms);
        }
        if (slow_loop_steps(snapshot, now_ms)) {
            can_link_transmit(&app.can, now_ms, &snapshot->output, &snapshot->input.temperature);
            energy_frame_transmit(&app.can, now_ms, &app.journal.energy);
            send_vesc_status(snapshot, now_ms);
        } else if (app.slow_steps_seen != 0) { /* it has run */
            report_stopped_loop(now_ms);
        }
    }
    (void)recorder_seal(&app.recorder);
    const report_status_t status = status_of(snapshot);
    console_pump(&app.console, now_ms, &status);
    if (console_wants_off(&app.console)) {
        console_switch_off(&app.console, is_at_standstill(&snapshot->output));
    }
    if (console_wants_bootloader(&app.console) &&
        console_request_bootloader(&app.console, is_at_standstill(&snapshot->output))) {
        stop_control();
    }
    if (console_has_accepted(&app.console)) {
        replace_configuration(snapshot);
    }
}

bool app_finish(void)
{
    const snapshot_t *snapshot = latest_snapshot();
    const report_status_t status = status_of(snapshot);
    const bool good = status.control && snapshot->output.fault_reason == REASON_NONE;
    console_status(&app.console, &status);
    text_t *line = console_line(&app.console);
    text_add(line, good ? "result: " : "result: FAILED, ");
    text_add(line, status.control ? operating_mode_text(snapshot->output.mode) : "BOOT");
    if (status.control) {
        text_add(line, ", ");
        text_add(line, reason_text(snapshot->output.fault_reason));
    }
    console_print(&app.console, line);
    for (int i = 0; i < FINISH_PASSES && !console_drained(&app.console); i++) {
        console_pump(&app.console, time_ms(), &status);
    }
    return good;
}
