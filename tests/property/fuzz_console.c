/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The console under a coverage-guided fuzzer: line editor, command parser, every command's answer
 * and the installer, on a serial line that takes as few bytes as it likes. Address and
 * undefined-behaviour sanitizers watch the arithmetic; the checks are properties of every run: what
 * is sent is text, only a permitted installation touches the flash, what is accepted has its own
 * checksum, and the shell answers after anything.
 *
 * The input is a script: bytes below 0x80 are keys, the others are actions with the bytes after
 * them as their arguments. A fuzzer hardly guesses a command or a checksum, so both are actions.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/config_store.h"
#include "app/console.h"
#include "flash_fake.h"
#include "fuzz_bytes.h"
#include "hal/analog.h"
#include "hal/inverter.h"
#include "hal/power.h"
#include "hal/serial.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { KEYS_MAX = 32768, SCREEN_MAX = 4096, ESCAPE = 0x1B, CANCEL = 0x03, LAST_PUMPS = 4 };

/* Of a board that takes any configuration. */
analog_scale_t analog_scale(void)
{
    const analog_scale_t any = {.switch_25C_code = 0};
    return any;
}

uint32_t inverter_dead_time_least_ns(void)
{
    return 0;
}

static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};

static console_t console;
static boot_report_t boot;
static slow_output_t output;
static node_t node;
static torque_limits_t limits;
static recorder_memory_t box;
static fault_journal_t journal;
static report_status_t status;
static crash_record_t crash;
static bool crashed, tripped;
static uint32_t now_ms;
static uint8_t keys[KEYS_MAX];
static uint32_t keys_typed, keys_read, line_takes;
static char screen[SCREEN_MAX]; /* the latest bytes sent */
static uint32_t screen_bytes;

/* ---- the board ---- */

uint32_t serial_write(const char *bytes, uint32_t size)
{
    const uint32_t taken = size < line_takes ? size : line_takes;
    for (uint32_t i = 0; i < taken; i++) {
        const char c = bytes[i];
        const bool control = c == '\r' || c == '\n' || c == '\a' || c == '\b' || c == ESCAPE;
        require(control || (c >= ' ' && c <= '~') || !console_xcp_lets_text(&console.xcp));
        if (screen_bytes == SCREEN_MAX - 1) {
            memmove(screen, screen + SCREEN_MAX / 2, SCREEN_MAX / 2);
            screen_bytes -= SCREEN_MAX / 2;
        }
        screen[screen_bytes++] = c;
        screen[screen_bytes] = '\0';
    }
    return taken;
}

bool serial_read(uint8_t *byte)
{
    if (keys_read == keys_typed) {
        keys_read = 0;
        keys_typed = 0;
        return false;
    }
    *byte = keys[keys_read++];
    return true;
}

const crash_record_t *crash_record(void)
{
    return crashed ? &crash : NULL;
}

void inverter_trip(void)
{
    tripped = true;
}

bool power_off(void)
{
    return crashed;
}

bool power_request_bootloader(void)
{
    return crashed;
}

/* ---- actions ---- */

static void type(uint8_t key)
{
    if (keys_typed < KEYS_MAX) {
        keys[keys_typed++] = key;
    }
}

static void type_text(const char *text)
{
    while (*text != '\0') {
        type((uint8_t)*text++);
    }
}

static void pump(void)
{
    console_pump(&console, now_ms, &status);
    uint32_t length;
    const uint8_t *packet = console_xcp_packet(&console.xcp, &length);
    if (packet != NULL) {
        require(length > 0 && length <= XCP_PACKET_BYTES);
        console_xcp_answer(&console.xcp, packet, length);
    }
    require(!console_xcp_has_ended(&console.xcp) || console.xcp.use == CONSOLE_TEXT);
}

static void type_command(uint32_t which)
{
    static const char *const LINES[] = {
        "help", "reasons", "status", "watch",   "limits",  "faults",  "blackbox",   "crash",
        "can",  "boot",    "config", "faults ", "version", "install", "bootloader", "xcp",
    };
    type_text(LINES[which % 16U]);
    if (which < 16U) {
        type('\r');
    }
}

static void type_byte_as_hex(uint8_t byte, uint8_t *sum)
{
    static const char DIGITS[] = "0123456789ABCDEF";
    type((uint8_t)DIGITS[byte >> 4]);
    type((uint8_t)DIGITS[byte & 0x0FU]);
    *sum = (uint8_t)(*sum + byte);
}

static void type_record(uint32_t address, uint8_t kind, const uint8_t *data, uint8_t length)
{
    uint8_t sum = 0;
    type(':');
    type_byte_as_hex(length, &sum);
    type_byte_as_hex((uint8_t)(address >> 8), &sum);
    type_byte_as_hex((uint8_t)address, &sum);
    type_byte_as_hex(kind, &sum);
    for (uint32_t i = 0; i < length; i++) {
        type_byte_as_hex(data[i], &sum);
    }
    type_byte_as_hex((uint8_t)-sum, &sum);
    type('\n');
}

static void type_any_record(bytes_t *bytes)
{
    uint8_t data[256];
    const uint8_t length = take8(bytes);
    const uint8_t kind = take8(bytes) % 8U;
    const uint16_t address = take16(bytes);
    for (uint32_t i = 0; i < length; i++) {
        data[i] = take8(bytes);
    }
    type_record(address, kind, data, length);
}

/* A configuration with some words of it changed, and in most cases its checksum after that; in half
 * of them only its first records. */
static void type_configuration(bytes_t *bytes)
{
    static config_t image;
    const uint8_t how = take8(bytes);
    change_words(&image, CONFIGS[how & 3U], bytes);
    if ((how & 0x1CU) != 0) {
        image.crc32 = crc_of(&image, offsetof(config_t, crc32));
    }
    const uint8_t length = (uint8_t)(16U + (how & 0x60U) * 2U);
    const uint8_t *const at = (const uint8_t *)&image;
    const uint32_t end = how < 0x80U ? (uint32_t)sizeof image : 4U * length;
    for (uint32_t from = 0; from < end; from += length) {
        const uint32_t left = (uint32_t)sizeof image - from;
        type_record(0x8000U + from, 0, at + from, (uint8_t)(left < length ? left : length));
    }
    type_record(0, 1, NULL, 0);
}

static void install(bool permitted)
{
    if (!console_has_accepted(&console)) {
        return;
    }
    const config_t *const image = &console.installer.image.config;
    require(image->magic == CONFIG_MAGIC && image->size_bytes == sizeof(config_t));
    require(image->crc32 == crc_of(image, offsetof(config_t, crc32)));
    require(memchr(image->name, '\0', sizeof image->name) != NULL);
    const uint32_t operations = fake.operations;
    tripped = false;
    console_install(&console, permitted);
    require(permitted || fake.operations == operations);
    require(tripped == permitted);
    if (permitted && !fake.bridge_on && fake.fails_at == 0) {
        const config_store_t now = config_store_in_force();
        require(now.sequence > 0 && memcmp(now.image.begin, image, sizeof *image) == 0);
    }
}

static void change_board(bytes_t *bytes)
{
    const uint8_t what = take8(bytes);
    switch (what % 8U) {
    case 0:
        crashed = take8(bytes) % 2U != 0;
        crash.value[take8(bytes) % CRASH_VALUES] = take32(bytes);
        break;
    case 1:
        status.control = take8(bytes) % 4U != 0;
        status.black_box = status.control && what < 128U ? &box : NULL;
        break;
    case 2: /* the phase is what recorder_init() leaves: one of the enumeration */
        change_bytes(&box, sizeof box, bytes);
        box.phase %= RECORDER_SEALED + 1U;
        break;
    case 3:
        output.mode = (operating_mode_t)(take8(bytes) % 8U);
        output.fault_reason = (reason_t)take8(bytes);
        output.torque_reason = (reason_t)take8(bytes);
        output.speed_mrad_s = (int32_t)take32(bytes);
        output.bus_voltage_mV = (int32_t)take32(bytes);
        break;
    case 4: {
        limit_t *const line = what < 128U ? limits.driving : limits.braking;
        line[take8(bytes) % TORQUE_LINE_COUNT].torque_mNm = (int32_t)take32(bytes);
        break;
    }
    case 5:
        fake.bridge_on = take8(bytes) % 2U != 0;
        fake.fails_at = take8(bytes) % 3U == 0 ? fake.operations + take8(bytes) : 0;
        break;
    case 6:
        boot.ram_good = take8(bytes) % 2U != 0;
        boot.clock_good = take8(bytes) % 2U != 0;
        boot.inverter = (inverter_status_t)(take8(bytes) % 6U);
        break;
    default:
        status.fast_cycles_worst = take32(bytes);
        status.stack_free_bytes = take32(bytes);
        status.driver_status = take32(bytes);
        break;
    }
}

static void act(uint8_t action, bytes_t *bytes)
{
    if (action < 0x80U || action >= 0xC0U) {
        type(action);
        return;
    }
    if (action < 0xA0U) {
        type_command(action & 0x1FU);
        return;
    }
    switch (action & 7U) {
    case 0:
        type_any_record(bytes);
        break;
    case 1:
        type_text("install\r");
        pump();
        type_configuration(bytes);
        break;
    case 2:
        install(take8(bytes) % 4U != 0);
        break;
    case 3:
        change_board(bytes);
        break;
    case 4:
        now_ms += 16U * take8(bytes);
        line_takes = take8(bytes);
        /* Mostly a part: a line that takes more only makes longer answers. */
        line_takes = line_takes < 240U ? line_takes : 100U * (line_takes - 230U);
        pump();
        break;
    case 5:
        type_text("off\r");
        pump();
        if (console_wants_off(&console)) {
            console_switch_off(&console, take8(bytes) % 2U != 0);
        }
        break;
    case 6:
        if (console_wants_bootloader(&console)) {
            (void)console_request_bootloader(&console, take8(bytes) % 2U != 0);
        }
        break;
    default:
        console_status(&console, &status);
        break;
    }
}

/* A tool that is silent loses the line. */
static void end_xcp(void)
{
    for (int i = 0; i < KEYS_MAX && console_xcp_has_line(&console.xcp); i++) {
        now_ms += SXI_SILENCE_ms;
        pump();
    }
}

/* ^C ends an answer and a reception, any key a repeated line; of those typed ahead 128 bytes may
 * hold 16. Once one has come to the shell itself, it is as at the start. */
static void require_answer(void)
{
    line_takes = SCREEN_MAX / 2;
    type('q');
    bool to_shell;
    int cancels = 0;
    do {
        end_xcp();
        to_shell = console.installer.state == INSTALLER_CLOSED;
        type(CANCEL);
        pump();
        cancels++;
    } while (cancels < 17 && !(to_shell && console_drained(&console)));
    /* An accepted configuration waits for console_has_accepted(). */
    (void)console_has_accepted(&console);
    for (int i = 0; i < LAST_PUMPS && !console_drained(&console); i++) {
        pump();
    }
    require(console_drained(&console));
    screen_bytes = 0;
    screen[0] = '\0';
    type_text("version\r");
    for (int i = 0; i < 3; i++) {
        pump();
    }
    require(console_drained(&console));
    require(strstr(screen, "version\r\nhubfoc ") != NULL);
}

static void begin(bytes_t *bytes)
{
    const boot_report_t good = {.clock_good = true,
                                .ram_good = true,
                                .firmware_good = true,
                                .config_result = {.field = ""},
                                .config = CONFIGS[take8(bytes) % 4U]};
    boot = good;
    memset(&output, 0, sizeof output);
    memset(&crash, 0, sizeof crash);
    memset(&node, 0, sizeof node);
    memset(&box, 0xA5, sizeof box);
    torque_limits_state_t state;
    torque_limits_init(&state, &limits);
    fake_deliver(boot.config, sizeof *boot.config);
    fault_journal_init(&journal);
    recorder_t recorder;
    const recorder_start_t start = {.pwm_frequency_Hz = 20000};
    recorder_init(&recorder, &box, &start);
    const report_status_t running = {.output = &output,
                                     .limits = &limits,
                                     .node = &node,
                                     .black_box = &box,
                                     .journal = &journal,
                                     .control = true};
    status = running;
    crashed = false;
    now_ms = UINT32_MAX - 2000U; /* over the wrap of the clock */
    keys_typed = 0;
    keys_read = 0;
    line_takes = 200;
    screen_bytes = 0;
    memset(&console, 0xA5, sizeof console);
    console_init(&console, &boot);
    console_greet(&console);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes_t bytes = {data, size};
    begin(&bytes);
    while (bytes.left > 0) {
        act(take8(&bytes), &bytes);
    }
    require_answer();
    return 0;
}
