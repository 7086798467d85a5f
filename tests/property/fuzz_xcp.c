/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The XCP slave under a coverage-guided fuzzer: any packets in any order at any time, with the
 * right key now and then. The sanitizers watch every read and write, and these are properties of
 * every run: the page in force and what lies around the staging page never change, the staging page
 * only when unlocked, the key is neither changed nor in an answer, an answer fits its packet. Both
 * steps of DAQ and scope run between the packets: a packet of DAQ fits the line that was connected,
 * and nothing around the scope's memory changes.
 *
 * A packet is its length and what it is, time since the one before, its bytes. Addresses are
 * guessed hardly ever, so they can be given.
 */
#include <stddef.h>

#include "comms/mac.h"
#include "comms/xcp.h"
#include "fuzz_bytes.h"

enum {
    GET_SEED = 0xF8,
    GUARD = 64,
    SIGNALS_COUNT = 5,
    SCOPE_MEMORY = 256,
    RIGHT_KEY = 0x10,
    GIVEN_ADDRESS = 0x20,
    GONE = 0x40,
    ANY_LENGTH = 0x80
};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct {
    uint8_t before[GUARD];
    config_t config;
    uint8_t after[GUARD];
} guarded_t;

/* What DAQ and scope have between two packets of the tool. */
typedef struct {
    daq_t daq;
    uint8_t before[GUARD];
    uint8_t memory[SCOPE_MEMORY];
    uint8_t after[GUARD];
    scope_t scope;
    findings_t findings;
} steps_t;

static void begin_steps(steps_t *steps, uint8_t memory)
{
    static const finding_times_t TIMES[FINDING_COUNT];
    memset(steps, 0xA5, sizeof *steps);
    daq_init(&steps->daq);
    findings_init(&steps->findings, TIMES, false);
    scope_init(&steps->scope, steps->memory, memory % 4U == 0 ? 0U : SCOPE_MEMORY, 20000);
}

static void step(steps_t *steps, const xcp_access_t *access, uint8_t what)
{
    uint8_t packet[DAQ_PACKET_BYTES];
    for (uint32_t i = 0; i < what % 8U; i++) {
        steps->findings.present[0] = (uint32_t)what << 13U;
        if (daq_runs_slow(&steps->daq)) {
            daq_slow_step(&steps->daq, &access->table, access->slow_steps);
        }
        if (scope_runs(&steps->scope)) {
            scope_slow_step(&steps->scope, &access->table, &steps->findings);
        }
        for (uint32_t k = 0; k < 8U && scope_runs(&steps->scope); k++) {
            scope_fast_step(&steps->scope);
        }
    }
    for (uint32_t i = 0; i < what / 8U; i++) {
        const uint32_t length = daq_next(&steps->daq, &steps->scope, packet);
        require(length <= access->line->packet_bytes);
        if (length > 0) {
            require((packet[0] & ~(uint32_t)DAQ_OVERLOAD) < DAQ_ODTS);
            daq_taken(&steps->daq, &steps->scope);
        }
    }
    for (uint32_t i = 0; i < GUARD; i++) {
        require(steps->before[i] == 0xA5 && steps->after[i] == 0xA5);
    }
    require(scope_record_bytes(&steps->scope) <= SCOPE_MEMORY);
}

static const uint32_t KEY[CONFIG_SERVICE_KEY_WORDS] = {0x9E3779B9, 0x7F4A7C15, 0xF39CC060,
                                                       0x5CEDC834};

static void require_guards(const guarded_t *page)
{
    for (uint32_t i = 0; i < GUARD; i++) {
        require(page->before[i] == 0xA5 && page->after[i] == 0xA5);
    }
    require(memcmp(page->config.service_key, KEY, sizeof KEY) == 0);
}

static void guard(guarded_t *page)
{
    memset(page, 0xA5, sizeof *page);
    memset(&page->config, 0x11, sizeof page->config);
    memcpy(page->config.service_key, KEY, sizeof KEY);
}

/* The key has no byte in common with the rest of the pages, so four of it in a row are no chance.
 */
static void require_silent_about_key(const uint8_t *answer, uint32_t bytes)
{
    for (uint32_t at = 1; at + 4U <= bytes; at++) {
        for (uint32_t k = 0; k < CONFIG_SERVICE_KEY_WORDS; k++) {
            require(memcmp(&answer[at], &KEY[k], 4) != 0);
        }
    }
}

/* A signal's as an entry of DAQ, a setting of the scope, or its record. */
static uint32_t scope_address(const uint8_t *packet)
{
    return packet[5] < 96U    ? XCP_SIGNALS_ADDRESS + 4U * (packet[4] % (SIGNALS_COUNT + 1U))
           : packet[5] < 208U ? XCP_SCOPE_ADDRESS + 4U * (packet[4] % 24U)
                              : XCP_RECORD_ADDRESS + packet[4];
}

/* The scope's settings hold what the tool has written, and that may be anything. */
static bool shows_settings(const xcp_t *slave)
{
    const uint32_t end = XCP_SCOPE_ADDRESS + (uint32_t)sizeof(scope_page_t) + XCP_PACKET_BYTES;
    return slave->mta >= XCP_SCOPE_ADDRESS && slave->mta < end;
}

/* Commands of DAQ and settings of the scope as they are meant, by the lower bits of `what`. */
static void make_meant(uint8_t what, uint8_t *packet)
{
    static const uint8_t OFTEN[16] = {0,    0,    0,    0,    0xE2, 0xE1, 0xE1, 0xE0,
                                      0xDE, 0xDD, 0xF6, 0xF6, 0xF0, 0xF0, 0xF0, 0xF5};
    const uint8_t list = packet[2] % 2U;
    if (OFTEN[what % 16U] == 0) {
        return;
    }
    packet[0] = OFTEN[what % 16U];
    if (packet[0] == 0xF0) { /* a word: a place, a trigger, rows, run */
        packet[1] = 4;
        packet[2] %= 8U;
        packet[3] = packet[4] = packet[5] = 0;
        return;
    }
    const bool writes = packet[0] == 0xE1;
    const uint32_t address = writes ? XCP_SIGNALS_ADDRESS + 4U * (packet[4] % SIGNALS_COUNT)
                                    : XCP_SCOPE_ADDRESS + 4U * (packet[4] % 16U);
    packet[1] = writes ? 0xFF : packet[0] == 0xE0 ? 0x10 : packet[1] % 3U;
    packet[2] = writes ? (uint8_t)(1U << packet[2] % 3U) : list;
    packet[3] = 0;
    for (uint32_t i = 0; i < 4U && (writes || packet[0] == 0xF6); i++) {
        packet[4U + i] = (uint8_t)(address >> 8U * i);
    }
    if (packet[0] == 0xE0) {
        packet[4] = list;
        packet[5] = 0;
    } else if (packet[0] == 0xE2) {
        packet[4] %= 9U;
        packet[5] %= 9U;
    }
}

static uint32_t packet_of(const xcp_t *slave, bytes_t *bytes, uint8_t what, uint8_t *packet)
{
    const uint32_t length = (what & ANY_LENGTH) != 0 ? what % 10U : XCP_PACKET_BYTES;
    for (uint32_t i = 0; i < length; i++) {
        packet[i] = take8(bytes);
    }
    packet[0] |= (what & ANY_LENGTH) != 0 ? 0U : 0xC0U; /* where the commands are */
    if ((what & RIGHT_KEY) != 0) {
        const uint64_t right = mac_of(KEY, slave->seed);
        packet[0] = 0xF7;
        packet[1] = 6;
        for (uint32_t i = 0; i < 6U; i++) {
            packet[2U + i] = (uint8_t)(right >> 8U * i);
        }
        return 8;
    }
    if ((what & ANY_LENGTH) == 0) {
        make_meant(what, packet);
    }
    if ((what & GIVEN_ADDRESS) != 0) {
        const uint32_t around = packet[4] % 32U - 8U; /* of the beginning, or of the end */
        const uint32_t page_end = XCP_PAGE_ADDRESS + (uint32_t)offsetof(config_t, crc32);
        const uint32_t address = packet[6] % 2U == 0 ? scope_address(packet)
                                 : packet[5] < 64U   ? XCP_SIGNALS_ADDRESS + around
                                 : packet[5] < 128U  ? page_end + around
                                 : packet[5] < 192U
                                     ? XCP_PAGE_ADDRESS + around
                                     : XCP_PAGE_ADDRESS + packet[5] * packet[4] / 16U;
        packet[1] %= 9U; /* bytes to read */
        packet[3] = 0;   /* extension */
        for (uint32_t i = 0; i < 4U; i++) {
            packet[4U + i] = (uint8_t)(address >> 8U * i);
        }
    }
    return length;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static guarded_t in_force, staging;
    static config_t in_force_before, staging_before;
    static const xcp_signal_t SIGNALS[SIGNALS_COUNT] = {
        {0, 4, 0}, {4, 1, 1}, {6, 2, 0}, {0, 4, 3}, {2, 2, 3}};
    static const uint32_t RECORD[2] = {0x04030201, 0x08070605};
    static const daq_line_t LINES[2] = {
        {.packet_bytes = XCP_PACKET_BYTES, .packets_a_ms = 1},
        {.packet_bytes = DAQ_PACKET_BYTES, .packets_a_ms = 16, .carries_fast_list = true}};
    static steps_t steps;
    bytes_t bytes = {data, size};
    uint32_t now_ms = UINT32_MAX - 1000U * take8(&bytes);
    xcp_t slave;
    guard(&in_force);
    guard(&staging);
    in_force_before = in_force.config;
    xcp_init(&slave);
    begin_steps(&steps, take8(&bytes));
    const daq_line_t *line = &LINES[bytes.left % 8U / 4U];
    slave.connected = bytes.left % 4U != 0;
    while (bytes.left > 0) {
        uint8_t packet[10] = {0};
        uint8_t answer[XCP_PACKET_BYTES];
        const uint8_t what = take8(&bytes);
        const uint8_t pause = take8(&bytes);
        const uint32_t length = packet_of(&slave, &bytes, what, packet);
        const xcp_access_t access = {.table = {.signals = SIGNALS,
                                               .signals_count = SIGNALS_COUNT,
                                               .record = {RECORD, RECORD, RECORD, RECORD}},
                                     .slow_steps = (uint16_t)now_ms,
                                     .line = line,
                                     .daq = &steps.daq,
                                     .scope = &steps.scope,
                                     .in_force = &in_force.config,
                                     .staging = (what & GONE) != 0 ? NULL : &staging.config,
                                     .identification = "fuzzed"};
        now_ms += pause < 200U ? pause : 400U * pause;
        xcp_tick(&slave, &access, now_ms);
        if (xcp_wants_seed(&slave)) {
            xcp_give_seed(&slave, take32(&bytes));
        }
        const bool unlocked = slave.unlocked;
        const bool unlocking = packet[0] == 0xF7;
        staging_before = staging.config;
        uint32_t answered = xcp_command(&slave, &access, now_ms, packet, length, answer);
        if (slave.store_wanted) {
            require(slave.unlocked && answered == 0);
            answered = xcp_store(&slave, pause % 2U == 0 ? XCP_ERROR_NONE : XCP_ERROR_OUT_OF_RANGE,
                                 answer);
        }
        require(answered <= XCP_PACKET_BYTES);
        if (packet[0] != GET_SEED && !shows_settings(&slave)) { /* the fuzzer gives the seed */
            require_silent_about_key(answer, answered);
        }
        require(memcmp(&in_force.config, &in_force_before, sizeof in_force_before) == 0);
        require(unlocked || unlocking ||
                memcmp(&staging.config, &staging_before, sizeof staging_before) == 0);
        require_guards(&in_force);
        require_guards(&staging);
        step(&steps, &access, pause);
    }
    return 0;
}
