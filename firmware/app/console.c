/* SPDX-License-Identifier: Apache-2.0 */
#include "app/console.h"

#include "hal/crash.h"
#include "hal/power.h"
#include "hal/serial.h"

enum {
    STATUS,
    WATCH,
    LIMITS,
    FAULTS,
    BLACKBOX,
    CRASH,
    CAN,
    BOOT,
    CONFIG,
    VERSION,
    INSTALL,
    OFF,
    BOOTLOADER,
    XCP,
    COMMANDS_COUNT
};

static const shell_command_t COMMANDS[COMMANDS_COUNT] = {
    [STATUS] = {"status", "", "mode, reason, torque, speed, bus"},
    [WATCH] = {"watch", "", "the status every second, until the next key"},
    [LIMITS] = {"limits", "", "every torque limit, which one is the tightest, and why"},
    [FAULTS] = {"faults", "[PREFIX]", "the faults whose names begin so: times, reaction, clearing"},
    [BLACKBOX] = {"blackbox", "",
                  "the first fault's record, for hubsim blackbox; counts of faults"},
    [CRASH] = {"crash", "", "the latest fault of the core or failed check"},
    [CAN] = {"can", "", "received frames and errors of each sender"},
    [BOOT] = {"boot", "", "what the self-tests found"},
    [CONFIG] = {"config", "[PREFIX]", "the configuration's fields that begin so"},
    [VERSION] = {"version", "", "program, version, commit, port"},
    [INSTALL] = {"install", "", "another configuration: send it as Intel HEX, the wheel at rest"},
    [OFF] = {"off", "", "lets the board's supply go, the wheel at rest"},
    [BOOTLOADER] = {"bootloader", "", "restarts in the chip's own, the wheel at rest"},
    [XCP] = {"xcp", "", "the line is XCP's until DISCONNECT or 2 s of silence"},
};

static const char REFUSED[] = "refused: only with the wheel known to be at rest and switched off";

static bool answer_boot(const console_t *console, uint32_t number, text_t *line)
{
    if (number > 0) {
        return report_boot(console->boot, number - 1U, line);
    }
    report_banner(console->boot, line);
    return true;
}

static bool answer_status(const console_t *console, uint32_t number, text_t *line)
{
    if (number > 0) {
        return console->status.control &&
               energy_line(&console->status.journal->energy, number - 1U, line);
    }
    report_status(&console->status, line);
    return true;
}

/* The whole answer shows the table of one slow step, however long the line takes. */
static bool answer_limits(console_t *console, uint32_t number, text_t *line)
{
    if (number == 0 && console->status.control) {
        console->limits = *console->status.limits;
    }
    return report_limits(&console->status, &console->limits, number, line);
}

static bool answer_xcp(console_t *console, uint32_t number, text_t *line)
{
    const bool opens =
        number == 0 && console->status.control && console_xcp_open(&console->xcp, console->now_ms);
    text_add(line, opens ? "XCP" : "not here");
    return number == 0;
}

static bool answer(console_t *console, const shell_request_t *asked, text_t *line)
{
    switch (asked->command) {
    case STATUS:
        return answer_status(console, asked->number, line);
    case WATCH:
        console->watching = true;
        text_add(line, "any key ends it");
        return asked->number == 0;
    case LIMITS:
        return answer_limits(console, asked->number, line);
    case FAULTS:
        return report_faults(console->boot, asked->argument, asked->number, line);
    case BLACKBOX:
        return report_black_box(&console->status, asked->number, line);
    case CRASH:
        return report_crash(crash_record(), asked->number, line);
    case CAN:
        return report_can(&console->status, asked->number, line);
    case BOOT:
        return answer_boot(console, asked->number, line);
    case CONFIG:
        return report_config(console->boot, asked->argument, asked->number, line);
    case VERSION:
        report_version(line);
        return asked->number == 0;
    case INSTALL:
        installer_open(&console->installer, console->now_ms);
        text_add(line, "send the configuration as Intel HEX; ^C gives up");
        return asked->number == 0;
    case OFF:
        console->off_wanted = console->off_wanted || asked->number == 0;
        text_add(line, "only with the wheel at rest");
        return asked->number == 0;
    case BOOTLOADER:
        console->bootloader_wanted = console->bootloader_wanted || asked->number == 0;
        text_add(line, "only with the wheel at rest");
        return asked->number == 0;
    case XCP:
        return answer_xcp(console, asked->number, line);
    default:
        return false;
    }
}

void console_init(console_t *console, const boot_report_t *boot)
{
    shell_init(&console->shell, COMMANDS, COMMANDS_COUNT);
    const report_status_t initial = {.control = false};
    console->boot = boot;
    console->status = initial;
    console->watched_ms = 0;
    console->watching = false;
    console->off_wanted = false;
    console->bootloader_wanted = false;
    console->now_ms = 0;
    console_xcp_init(&console->xcp);
    installer_init(&console->installer);
}

text_t *console_line(console_t *console)
{
    return shell_line(&console->shell);
}

void console_print(console_t *console, const text_t *line)
{
    shell_print(&console->shell, line);
}

void console_greet(console_t *console)
{
    text_t *line = console_line(console);
    report_banner(console->boot, line);
    console_print(console, line);
    text_clear(line);
    for (uint32_t i = 0; report_boot(console->boot, i, line); i++) {
        console_print(console, line);
        text_clear(line);
    }
    if (crash_record() != 0 && report_crash(crash_record(), 0, line)) {
        console_print(console, line);
    }
}

void console_status(console_t *console, const report_status_t *status)
{
    text_t *line = console_line(console);
    report_status(status, line);
    console_print(console, line);
}

bool console_drained(const console_t *console)
{
    return shell_idle(&console->shell);
}

static void answer_requests(console_t *console)
{
    shell_request_t asked;
    while (shell_next_request(&console->shell, &asked)) {
        text_t *line = console_line(console);
        if (answer(console, &asked, line)) {
            shell_answer(&console->shell, line);
        } else {
            shell_answered(&console->shell);
        }
    }
}

/* INSTALLER_ACCEPTED stays until console_has_accepted() has returned it. */
static void print_installer_result(console_t *console)
{
    const installer_state_t state = console->installer.state;
    if (state != INSTALLER_CANCELLED && state != INSTALLER_REFUSED) {
        return;
    }
    text_t *line = console_line(console);
    installer_text(&console->installer, line);
    console_print(console, line);
    console->installer.state = INSTALLER_CLOSED;
}

bool console_has_accepted(console_t *console)
{
    const bool accepted = console->installer.state == INSTALLER_ACCEPTED;
    if (accepted) {
        text_t *line = console_line(console);
        installer_text(&console->installer, line);
        console_print(console, line);
        console->installer.state = INSTALLER_CLOSED;
    }
    return accepted;
}

void console_refuse_staging(console_t *console, const config_result_t *result)
{
    text_t *line = console_line(console);
    text_add(line, "XCP: ");
    report_refusal(result, line);
    console_print(console, line);
}

void console_install(console_t *console, bool permitted)
{
    text_t *line = console_line(console);
    if (permitted) {
        (void)installer_write(&console->installer, line);
    } else {
        text_add(line, REFUSED);
        text_add(line, "; the configuration is as it was");
    }
    console_print(console, line);
}

bool console_wants_off(console_t *console)
{
    const bool wanted = console->off_wanted;
    console->off_wanted = false;
    return wanted;
}

void console_switch_off(console_t *console, bool permitted)
{
    text_t *line = console_line(console);
    if (permitted) {
        text_add(line, power_off() ? "the supply is let go" : "this board keeps its supply");
    } else {
        text_add(line, REFUSED);
    }
    console_print(console, line);
}

bool console_wants_bootloader(console_t *console)
{
    const bool wanted = console->bootloader_wanted;
    console->bootloader_wanted = false;
    return wanted;
}

bool console_request_bootloader(console_t *console, bool permitted)
{
    const bool requested = permitted && power_request_bootloader();
    text_t *line = console_line(console);
    text_add(line, requested   ? "restarting in the chip's bootloader"
                   : permitted ? "this chip has no bootloader"
                               : REFUSED);
    console_print(console, line);
    return requested;
}

static void read_keys(console_t *console, uint32_t now_ms)
{
    uint8_t byte;
    while (!console_xcp_has_line(&console->xcp) && serial_read(&byte)) {
        console->watching = false;
        if (console->installer.state == INSTALLER_RECEIVING) {
            installer_receive(&console->installer, byte, now_ms);
        } else {
            shell_receive(&console->shell, byte);
        }
    }
}

/* True if there is none left. */
static bool send_text(console_t *console)
{
    const char *bytes;
    const uint32_t count = shell_pending(&console->shell, &bytes);
    if (count > 0) {
        shell_sent(&console->shell, serial_write(bytes, count));
    }
    return count == 0;
}

void console_pump(console_t *console, uint32_t now_ms, const report_status_t *status)
{
    console->status = *status;
    console->now_ms = now_ms;
    read_keys(console, now_ms);
    installer_tick(&console->installer, now_ms);
    print_installer_result(console);
    if (console->watching && now_ms - console->watched_ms >= CONSOLE_WATCH_PERIOD_ms) {
        console->watched_ms = now_ms;
        console_status(console, status);
    }
    answer_requests(console);
    const bool text_has_left = console_xcp_lets_text(&console->xcp) && send_text(console);
    console_xcp_pump(&console->xcp, now_ms, text_has_left);
}
