/* SPDX-License-Identifier: Apache-2.0 */
#include "app/report.h"

#include <stddef.h>

#include "app/commit.h"
#include "app/config_lines.h"
#include "core/fault.h"
#include "core/findings.h"
#include "motor/feasible_torque.h"

#if !defined(HUBFOC_VERSION) || !defined(HUBFOC_PORT_NAME)
#error "HUBFOC_VERSION and HUBFOC_PORT_NAME come from the build"
#endif

void report_version(text_t *line)
{
    text_add(line, "hubfoc " HUBFOC_VERSION " (" HUBFOC_COMMIT ") on " HUBFOC_PORT_NAME);
}

void report_identity(const config_t *config, text_t *line)
{
    text_add(line, "configuration ");
    text_add(line, config->name);
    text_add(line, " ");
    text_add_hex(line, config->crc32);
}

void report_banner(const boot_report_t *boot, text_t *line)
{
    report_version(line);
    if (boot->config_result.code == CONFIG_RESULT_OK) {
        text_add(line, ", ");
        report_identity(boot->config, line);
        text_add(line, ", wheel ");
        text_add(line, messages_wheel_text((messages_wheel_t)boot->config->vehicle.wheel_position));
    }
}

void report_refusal(const config_result_t *result, text_t *line)
{
    text_add(line, "configuration refused: ");
    const char *const texts[] = {CONFIG_RESULT_TEXTS(result)};
    for (uint32_t k = 0; k < sizeof texts / sizeof texts[0]; k++) {
        text_add(line, texts[k]);
    }
    switch (result->code) {
    case CONFIG_RESULT_RANGE:
        text_add(line, " is ");
        text_add_integer(line, result->value);
        text_add(line, ", accepted ");
        text_add_integer(line, result->lowest);
        text_add(line, " .. ");
        text_add_integer(line, result->highest);
        break;
    case CONFIG_RESULT_RELATION:
        text_add(line, " does not hold");
        break;
    case CONFIG_RESULT_MAGIC:
    case CONFIG_RESULT_VERSION:
    case CONFIG_RESULT_SIZE:
    case CONFIG_RESULT_CRC:
    case CONFIG_RESULT_NAME:
    case CONFIG_RESULT_OK:
        text_add(line, " is not what this firmware expects");
        break;
    }
}

static const char *inverter_text(inverter_status_t status)
{
    switch (status) {
    case INVERTER_FREQUENCY_UNSUPPORTED:
        return "configuration refused: this board's timer does not make drive.pwm_frequency_Hz";
    case INVERTER_DEAD_TIME_UNSUPPORTED:
        return "configuration refused: drive.dead_time_ns is too long for this board's timer or "
               "too short for its "
               "switches";
    case INVERTER_TIMER_UNREADY:
        return "self-test failed: the PWM timer does not update at the top of its count";
    case INVERTER_CONVERTER_UNREADY:
        return "self-test failed: the analog converters did not start";
    case INVERTER_DRIVER_UNREADY:
        return "self-test failed: the gate driver does not hold its settings; has it its supply?";
    case INVERTER_OVERCURRENT_UNREADY:
        return "self-test failed: the over-current comparators do not answer";
    case INVERTER_OK:
        break;
    }
    return "inverter ready";
}

static void add_config_result(const boot_report_t *boot, text_t *line)
{
    if (boot->config_result.code != CONFIG_RESULT_OK) {
        report_refusal(&boot->config_result, line);
    } else if (boot->inverter != INVERTER_OK) {
        text_add(line, inverter_text(boot->inverter));
    } else if (boot->rotor_sensor_missing) {
        text_add(line, "configuration refused: rotor.sensor is not on this board");
    } else {
        text_add(line, "configuration accepted");
    }
}

void report_start(reset_cause_t cause, text_t *line)
{
    static const char *const NAMES[RESET_CAUSES] = {
        [RESET_UNKNOWN] = "",
        [RESET_POWER] = "supply",
        [RESET_BROWN_OUT] = "low supply",
        [RESET_WATCHDOG] = "watchdog",
        [RESET_WINDOW_WATCHDOG] = "window watchdog",
        [RESET_LOW_POWER] = "low-power mode",
        [RESET_PROGRAM] = "program",
        [RESET_OPTION_BYTES] = "option bytes",
        [RESET_PIN] = "reset pin",
    };
    text_add(line, "started by ");
    text_add(line, NAMES[cause]);
}

bool report_boot(const boot_report_t *boot, uint32_t number, text_t *line)
{
    const char *const words[] = {
        boot->brown_out_low ? "brown-out level is below 3: ./tools/dev flash sets it" : NULL,
        boot->clock_good ? NULL : "clock fault: crystal or PLL did not start, staying in BOOT",
        boot->ram_good ? "self-test RAM: good" : "self-test RAM: FAILED",
        boot->firmware_good ? "self-test firmware CRC: good" : "self-test firmware CRC: FAILED",
    };
    uint32_t left = number;
    if (boot->reset_cause != RESET_UNKNOWN) {
        if (left == 0) {
            report_start(boot->reset_cause, line);
            return true;
        }
        left--;
    }
    for (uint32_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (words[i] == NULL) {
            continue;
        }
        if (left == 0) {
            text_add(line, words[i]);
            return true;
        }
        left--;
    }
    if (left > 0) {
        return false;
    }
    add_config_result(boot, line);
    return true;
}

static const char NO_CONTROL[] =
    "BOOT, bridge off: no control without an accepted configuration and a good clock";

static void add_driver_status(uint32_t bits, text_t *line)
{
    static const char *const WORDS[INVERTER_DRIVER_BITS] = {"over-current low c",
                                                            "over-current high c",
                                                            "over-current low b",
                                                            "over-current high b",
                                                            "over-current low a",
                                                            "over-current high a",
                                                            "warm",
                                                            "hot",
                                                            "supply low",
                                                            "gate supply low",
                                                            "gate supply high",
                                                            "settings lost"};
    text_add(line, bits != 0 ? "; gate driver:" : "");
    for (uint32_t i = 0; i < INVERTER_DRIVER_BITS; i++) {
        if ((bits >> i & 1U) != 0) {
            text_add(line, " ");
            text_add(line, WORDS[i]);
        }
    }
}

void report_status(const report_status_t *status, text_t *line)
{
    if (!status->control) {
        text_add(line, NO_CONTROL);
        return;
    }
    const slow_output_t *o = status->output;
    text_add(line, operating_mode_text(o->mode));
    text_add(line, ", ");
    text_add(line,
             reason_text(o->fault_reason != REASON_NONE ? o->fault_reason : o->torque_reason));
    if (o->waits_for != WAITS_FOR_NONE) {
        text_add(line, ", waits for ");
        text_add(line, waits_for_text(o->waits_for));
    }
    text_add(line, "; ");
    text_add_decimal(line, o->motor_torque_estimate_mNm, 3);
    text_add(line, " N m of ");
    text_add_decimal(line, o->motor_torque_command_mNm, 3);
    text_add(line, ", ");
    text_add_decimal(line, o->speed_mrad_s, 3);
    text_add(line, " rad/s, ");
    text_add_decimal(line, o->bus_voltage_mV, 3);
    text_add(line, " V, ");
    text_add_decimal(line, o->bus_current_mA, 3);
    text_add(line, " A; fast step ");
    text_add_integer(line, (int32_t)status->fast_cycles_worst);
    text_add(line, " cycles, stack ");
    text_add_integer(line, (int32_t)status->stack_free_bytes);
    text_add(line, " B free, demand ");
    text_add(line, e2e_link_text(status->node->demand.link));
    add_driver_status(status->driver_status, line);
}

enum { FAULT_TIME_CHARS = 47 }; /* of one configuration field's name */

enum { DRIVING_COLUMN = 16, BRAKING_COLUMN = 30, REASON_COLUMN = 44 };

static void add_winner(text_t *line, const char *side, const limit_t lines[TORQUE_LINE_COUNT])
{
    const torque_line_t tightest = torque_limits_tightest_line(lines);
    text_add(line, side);
    text_add_decimal(line, lines[tightest].torque_mNm, 3);
    text_add(line, " N m, ");
    text_add(line, torque_limits_line_text(tightest));
    text_add(line, ": ");
    text_add(line, reason_text(lines[tightest].reason));
}

static void add_bound(text_t *line, const limit_t lines[TORQUE_LINE_COUNT], torque_line_t at)
{
    if (lines[at].torque_mNm == FEASIBLE_UNBOUNDED) {
        text_add(line, "-");
        return;
    }
    text_add_decimal(line, lines[at].torque_mNm, 3);
    text_add(line, at == torque_limits_tightest_line(lines) ? " *" : "");
}

/* A line has one reason; a side that it does not bound has none. */
static void add_limit(text_t *line, const torque_limits_t *limits, torque_line_t at)
{
    const limit_t *driving = &limits->driving[at];
    const limit_t *braking = &limits->braking[at];
    text_add(line, torque_limits_line_text(at));
    text_add_until(line, DRIVING_COLUMN);
    add_bound(line, limits->driving, at);
    text_add_until(line, BRAKING_COLUMN);
    add_bound(line, limits->braking, at);
    if (driving->torque_mNm != FEASIBLE_UNBOUNDED || braking->torque_mNm != FEASIBLE_UNBOUNDED) {
        text_add_until(line, REASON_COLUMN);
        text_add(line, reason_text(braking->torque_mNm != FEASIBLE_UNBOUNDED ? braking->reason
                                                                             : driving->reason));
    }
}

bool report_limits(const report_status_t *status, const torque_limits_t *limits, uint32_t number,
                   text_t *line)
{
    enum { DRIVING, BRAKING, HEADING, FIRST_LINE };
    if (!status->control) {
        text_add(line, NO_CONTROL);
        return number == 0;
    }
    switch (number) {
    case DRIVING:
        add_winner(line, "driving ", limits->driving);
        return true;
    case BRAKING:
        add_winner(line, "braking ", limits->braking);
        return true;
    case HEADING:
        text_add(line, "line");
        text_add_until(line, DRIVING_COLUMN);
        text_add(line, "driving N m");
        text_add_until(line, BRAKING_COLUMN);
        text_add(line, "braking N m");
        text_add_until(line, REASON_COLUMN);
        text_add(line, "reason");
        return true;
    default:
        if (number - FIRST_LINE >= TORQUE_LINE_COUNT) {
            return false;
        }
        add_limit(line, limits, (torque_line_t)(number - FIRST_LINE));
        return true;
    }
}

static void add_count(text_t *line, const char *words, uint32_t count)
{
    text_add(line, words);
    text_add_integer(line, (int32_t)(count & (uint32_t)INT32_MAX));
}

static void add_sender(const char *name, const e2e_receiver_t *receiver, text_t *line)
{
    const e2e_counts_t *c = &receiver->counts;
    text_add(line, name);
    text_add(line, e2e_link_text(receiver->link));
    add_count(line, "; used ", c->used);
    add_count(line, ", lost ", c->lost);
    add_count(line, ", repeated ", c->repeated);
    add_count(line, ", out of sequence ", c->wrong_sequence);
    add_count(line, ", damaged ", c->damaged);
    add_count(line, ", implausible ", c->implausible);
    add_count(line, ", timeouts ", c->timeouts);
}

bool report_can(const report_status_t *status, uint32_t number, text_t *line)
{
    if (!status->control) {
        text_add(line, NO_CONTROL);
        return number == 0;
    }
    switch (number) {
    case 0:
        add_sender("demand ", &status->node->demand, line);
        return true;
    case 1:
        add_sender("battery ", &status->node->battery, line);
        return true;
    case 2:
        add_sender("battery peak ", &status->node->peak, line);
        return true;
    case 3:
        add_sender("hydraulic ", &status->node->hydraulic, line);
        return true;
    case 4:
        text_add(line, status->bus_off ? "bus off" : "bus on");
        add_count(line, ", foreign frames ", status->node->foreign);
        return true;
    default:
        return false;
    }
}

/* A word that is a configuration field is followed by its value, as `config` shows it. */
static void add_time(const boot_report_t *boot, const char *time, text_t *line)
{
    const bool accepted = boot->config_result.code == CONFIG_RESULT_OK;
    while (*time != '\0') {
        char word[FAULT_TIME_CHARS + 1];
        uint32_t length = 0;
        bool field = false;
        for (; *time != '\0' && *time != ' ' && length < FAULT_TIME_CHARS; time++) {
            field = field || *time == '.';
            word[length++] = *time;
        }
        word[length] = '\0';
        if (!accepted || !field || !config_lines_get(boot->config, word, 0, line)) {
            text_add(line, word);
        }
        if (*time == ' ') {
            text_add(line, " ");
            time++;
        }
    }
}

/* A fault of the table: its text, and one line for each check that finds it. The fast monitor's
 * trips have the row TRIP in common. */
static bool add_fault(const boot_report_t *boot, reason_t reason, uint32_t *left, text_t *line)
{
    if (*left == 0) {
        text_add_integer(line, (int32_t)reason);
        text_add(line, " ");
        text_add(line, reason_name(reason));
        text_add(line, ": ");
        text_add(line, reason_text(reason));
        text_add(line, "; ");
        text_add(line, fault_driver_text(fault_driver(reason)));
        return true;
    }
    (*left)--;
    bool listed = false;
    for (finding_t k = 0; k <= FINDING_COUNT; k++) {
        const bool last = k == FINDING_COUNT;
        const finding_row_t row = findings_row(last ? FINDING_TRIP : k);
        if (last ? listed : row.reason != reason) {
            continue;
        }
        listed = true;
        if (*left == 0) {
            text_add(line, "   after ");
            add_time(boot, row.time.qualify, line);
            text_add(line, ": ");
            text_add(line, findings_reaction_text(row.reaction));
            text_add(line, "; ends ");
            text_add(line, fault_clearing_text(fault_clearing(reason)));
            if (fault_clearing(reason) == FAULT_CLEARING_HEALS) {
                text_add(line, ", ");
                add_time(boot, row.time.heal, line);
            }
            return true;
        }
        (*left)--;
    }
    return false;
}

bool report_faults(const boot_report_t *boot, const char *prefix, uint32_t number, text_t *line)
{
    uint32_t left = number;
    reason_t reason = REASON_NONE;
    for (uint32_t place = 0; fault_listed(place, &reason); place++) {
        if (text_begins_with(reason_name(reason), prefix) && add_fault(boot, reason, &left, line)) {
            return true;
        }
    }
    return false;
}

bool report_config(const boot_report_t *boot, const char *prefix, uint32_t number, text_t *line)
{
    if (boot->config_result.code != CONFIG_RESULT_OK) {
        report_refusal(&boot->config_result, line);
        return number == 0;
    }
    if (number > 0) {
        return config_lines_get(boot->config, prefix, number - 1U, line);
    }
    report_identity(boot->config, line);
    text_add(line, ", format ");
    text_add_integer(line, (int32_t)boot->config->format_version);
    text_add(line, ", generator ");
    text_add_hex(line, boot->config->generator_version);
    return true;
}
