/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/xcp.h"

#include <stddef.h>

#include "comms/mac.h"
#include "config/validate.h"
#include "xcp_exchange.h"

enum {
    FIRST_COMMAND = GET_DAQ_EVENT_INFO,
    POSITIVE = 0xFF,
    ERROR = 0xFE,
    RESOURCE_CALIBRATION = 0x01,
    RESOURCE_DAQ = 0x04,
    STATUS_DAQ_RUNNING = 0x40,
    COMM_MODE_OPTIONAL = 0x80, /* GET_COMM_MODE_INFO is there; little endian, bytes, no blocks */
    LAYER_VERSION = 0x01,      /* of protocol and transport */
    DRIVER_VERSION = 0x10,     /* 1.0 */
    STORE_CALIBRATION = 0x01,
    CHECKSUM_CRC_32 = 0x09,
    PAGE_OF_CONTROLLER = 0x01, /* modes of SET_CAL_PAGE and GET_CAL_PAGE */
    PAGE_OF_TOOL = 0x02,
    PAGE_OF_ALL = 0x80, /* segments */
    SEGMENTS = 1,
    ID_TEXT = 0,
    ID_A2L_NAME = 1,
    PAGE_BYTES = offsetof(config_t, crc32)
};

/* Bytes of each command, those without data. 0: there is no such command. */
static const uint8_t LENGTHS[CONNECT - FIRST_COMMAND + 1] = {
    [CONNECT - FIRST_COMMAND] = 2,
    [DISCONNECT - FIRST_COMMAND] = 1,
    [GET_STATUS - FIRST_COMMAND] = 1,
    [SYNCH - FIRST_COMMAND] = 1,
    [GET_COMM_MODE_INFO - FIRST_COMMAND] = 1,
    [GET_ID - FIRST_COMMAND] = 2,
    [SET_REQUEST - FIRST_COMMAND] = 4,
    [GET_SEED - FIRST_COMMAND] = 3,
    [UNLOCK - FIRST_COMMAND] = 2 + XCP_SEED_BYTES,
    [SET_MTA - FIRST_COMMAND] = 8,
    [UPLOAD - FIRST_COMMAND] = 2,
    [SHORT_UPLOAD - FIRST_COMMAND] = 8,
    [BUILD_CHECKSUM - FIRST_COMMAND] = 8,
    [DOWNLOAD - FIRST_COMMAND] = 3,
    [SET_CAL_PAGE - FIRST_COMMAND] = 4,
    [GET_CAL_PAGE - FIRST_COMMAND] = 3,
    [GET_PAG_PROCESSOR_INFO - FIRST_COMMAND] = 1,
    [COPY_CAL_PAGE - FIRST_COMMAND] = 5,
    [CLEAR_DAQ_LIST - FIRST_COMMAND] = 4,
    [SET_DAQ_PTR - FIRST_COMMAND] = 6,
    [WRITE_DAQ - FIRST_COMMAND] = 8,
    [SET_DAQ_LIST_MODE - FIRST_COMMAND] = 8,
    [GET_DAQ_LIST_MODE - FIRST_COMMAND] = 4,
    [START_STOP_DAQ_LIST - FIRST_COMMAND] = 4,
    [START_STOP_SYNCH - FIRST_COMMAND] = 2,
    [GET_DAQ_CLOCK - FIRST_COMMAND] = 1,
    [GET_DAQ_PROCESSOR_INFO - FIRST_COMMAND] = 1,
    [GET_DAQ_RESOLUTION_INFO - FIRST_COMMAND] = 1,
    [GET_DAQ_LIST_INFO - FIRST_COMMAND] = 4,
    [GET_DAQ_EVENT_INFO - FIRST_COMMAND] = 4,
};

static bool has_key(const config_t *config)
{
    uint32_t bits = 0;
    for (uint32_t i = 0; i < MAC_KEY_WORDS; i++) {
        bits |= config->service_key[i];
    }
    return bits != 0;
}

/* Those with a lock. */
static uint8_t locked_resources(const xcp_access_t *access)
{
    return has_key(access->in_force) ? RESOURCE_CALIBRATION : 0;
}

static uint8_t protected_resources(const exchange_t *x)
{
    return x->slave->unlocked ? 0 : locked_resources(x->access);
}

static void end_session(xcp_t *slave, const xcp_access_t *access)
{
    xcp_daq_end(access);
    slave->connected = false;
    slave->unlocked = false;
    slave->store_wanted = false;
    slave->page = XCP_PAGE_IN_FORCE;
    slave->text = NULL;
    slave->mta = 0;
    slave->daq_odt = DAQ_ODTS;
    slave->seed_given = false;
}

static xcp_error_t connect(exchange_t *x)
{
    end_session(x->slave, x->access);
    x->slave->connected = true;
    x->answer[1] = (uint8_t)(locked_resources(x->access) | RESOURCE_DAQ);
    x->answer[2] = COMM_MODE_OPTIONAL;
    x->answer[3] = XCP_PACKET_BYTES;              /* MAX_CTO */
    x->answer[4] = x->access->line->packet_bytes; /* MAX_DTO, two bytes */
    x->answer[5] = 0;
    x->answer[6] = LAYER_VERSION;
    x->answer[7] = LAYER_VERSION;
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_status(exchange_t *x)
{
    x->answer[1] = xcp_daq_runs(x->access) ? STATUS_DAQ_RUNNING : 0; /* no request is pending */
    x->answer[2] = protected_resources(x);
    x->answer[3] = 0;
    x->answer[4] = 0;
    x->answer[5] = 0;
    x->answer_bytes = 6;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_comm_mode_info(exchange_t *x)
{
    for (uint32_t i = 1; i < 7U; i++) {
        x->answer[i] = 0; /* no blocks, no interleaving */
    }
    x->answer[7] = DRIVER_VERSION;
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static uint32_t text_length(const char *text)
{
    uint32_t length = 0;
    while (text[length] != '\0') {
        length++;
    }
    return length;
}

static xcp_error_t get_id(exchange_t *x)
{
    const uint32_t kind = x->command[1];
    const bool known = kind == ID_TEXT || kind == ID_A2L_NAME;
    x->slave->mta = 0;
    x->slave->text = known ? x->access->identification : NULL;
    x->answer[1] = 0; /* to be uploaded */
    x->answer[2] = 0;
    x->answer[3] = 0;
    xcp_put(&x->answer[4], known ? text_length(x->access->identification) : 0, sizeof(uint32_t));
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static xcp_error_t set_request(exchange_t *x)
{
    if (x->command[1] != STORE_CALIBRATION) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (!x->slave->unlocked) {
        return XCP_ERROR_ACCESS_LOCKED;
    }
    x->slave->store_wanted = true; /* xcp_store() answers */
    return XCP_ERROR_NONE;
}

static bool is_paused(xcp_t *slave, uint32_t now_ms)
{
    if (slave->wrong_keys >= XCP_WRONG_KEYS &&
        now_ms - slave->paused_since_ms >= XCP_WRONG_KEYS_ms) {
        slave->wrong_keys = 0;
    }
    return slave->wrong_keys >= XCP_WRONG_KEYS;
}

static xcp_error_t get_seed(exchange_t *x)
{
    xcp_t *slave = x->slave;
    if (x->command[1] != 0) { /* the rest of a seed: one packet has the whole */
        return XCP_ERROR_SEQUENCE;
    }
    if (x->command[2] != RESOURCE_CALIBRATION || !has_key(x->access->in_force)) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (slave->unlocked) {
        x->answer[1] = 0;
        x->answer_bytes = 2;
        return XCP_ERROR_NONE;
    }
    if (is_paused(slave, x->now_ms) || !slave->seed_drawn || x->access->staging == NULL) {
        return XCP_ERROR_NOT_ACCESSIBLE_NOW;
    }
    x->answer[1] = XCP_SEED_BYTES;
    for (uint32_t i = 0; i < XCP_SEED_BYTES; i++) {
        x->answer[2U + i] = (uint8_t)(slave->seed >> 8U * i);
    }
    x->answer_bytes = 2U + XCP_SEED_BYTES;
    slave->seed_given = true;
    return XCP_ERROR_NONE;
}

/* In the same time for every key. */
static bool key_is_right(const exchange_t *x)
{
    const uint64_t right = mac_of(x->access->in_force->service_key, x->slave->seed);
    uint32_t differs = 0;
    for (uint32_t i = 0; i < XCP_SEED_BYTES; i++) {
        differs |= (uint32_t)x->command[2U + i] ^ (uint8_t)(right >> 8U * i);
    }
    return differs == 0;
}

/* A seed is used once, whatever key came for it. */
static xcp_error_t unlock(exchange_t *x)
{
    xcp_t *slave = x->slave;
    if (!slave->seed_given || x->command[1] != XCP_SEED_BYTES) {
        return XCP_ERROR_SEQUENCE;
    }
    if (x->access->staging == NULL) {
        return XCP_ERROR_NOT_ACCESSIBLE_NOW;
    }
    const bool right = key_is_right(x);
    slave->seed_given = false;
    slave->seed_drawn = false;
    if (!right) {
        slave->wrong_keys++;
        slave->paused_since_ms = x->now_ms;
        end_session(slave, x->access);
        return XCP_ERROR_ACCESS_LOCKED;
    }
    slave->wrong_keys = 0;
    slave->unlocks++;
    slave->unlocked = true;
    *x->access->staging = *x->access->in_force;
    x->answer[1] = protected_resources(x);
    x->answer_bytes = 2;
    return XCP_ERROR_NONE;
}

static xcp_error_t set_mta(exchange_t *x)
{
    if (x->command[3] != 0) { /* address extension */
        return XCP_ERROR_OUT_OF_RANGE;
    }
    x->slave->mta = word_at(&x->command[4]);
    x->slave->text = NULL;
    return XCP_ERROR_NONE;
}

/* The bytes [first, first + count) lie in [begin, begin + size). */
static bool is_within(uint32_t first, uint32_t count, uint32_t begin, uint32_t size)
{
    return first >= begin && first - begin <= size && count <= size - (first - begin);
}

static const uint8_t *page_of(const exchange_t *x)
{
    const config_t *page =
        x->slave->page == XCP_PAGE_STAGING ? x->access->staging : x->access->in_force;
    return (const uint8_t *)page;
}

/* Copies `count` bytes from an address to the answer, behind its first byte. */
static xcp_error_t read_memory(exchange_t *x, uint32_t address, uint32_t count)
{
    const xcp_table_t *table = &x->access->table;
    scope_t *scope = x->access->scope;
    if (count == 0 || count >= XCP_PACKET_BYTES) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (is_within(address, count, XCP_PAGE_ADDRESS, PAGE_BYTES)) {
        for (uint32_t i = 0; i < count; i++) {
            x->answer[1U + i] = page_of(x)[address - XCP_PAGE_ADDRESS + i];
        }
    } else if (is_within(address, count, XCP_SIGNALS_ADDRESS, 4U * table->signals_count)) {
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t at = address - XCP_SIGNALS_ADDRESS + i;
            x->answer[1U + i] = (uint8_t)(xcp_signal_value(table, at / 4U) >> 8U * (at % 4U));
        }
    } else if (is_within(address, count, XCP_SCOPE_ADDRESS, sizeof(scope_page_t))) {
        const uint8_t *page = (const uint8_t *)scope_page(scope);
        for (uint32_t i = 0; i < count; i++) {
            x->answer[1U + i] = page[address - XCP_SCOPE_ADDRESS + i];
        }
    } else if (is_within(address, count, XCP_RECORD_ADDRESS, scope_record_bytes(scope))) {
        for (uint32_t i = 0; i < count; i++) {
            x->answer[1U + i] = scope->memory[address - XCP_RECORD_ADDRESS + i];
        }
    } else {
        return XCP_ERROR_ACCESS_DENIED;
    }
    x->answer_bytes = 1U + count;
    return XCP_ERROR_NONE;
}

static xcp_error_t read_text(exchange_t *x, uint32_t count)
{
    if (count == 0 || count >= XCP_PACKET_BYTES) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (!is_within(x->slave->mta, count, 0, text_length(x->slave->text))) {
        return XCP_ERROR_ACCESS_DENIED;
    }
    for (uint32_t i = 0; i < count; i++) {
        x->answer[1U + i] = (uint8_t)x->slave->text[x->slave->mta + i];
    }
    x->answer_bytes = 1U + count;
    return XCP_ERROR_NONE;
}

static xcp_error_t upload(exchange_t *x)
{
    const uint32_t count = x->command[1];
    const xcp_error_t error =
        x->slave->text != NULL ? read_text(x, count) : read_memory(x, x->slave->mta, count);
    if (error == XCP_ERROR_NONE) {
        x->slave->mta += count;
    }
    return error;
}

static xcp_error_t short_upload(exchange_t *x)
{
    if (x->command[3] != 0) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    const uint32_t address = word_at(&x->command[4]);
    const xcp_error_t error = read_memory(x, address, x->command[1]);
    if (error == XCP_ERROR_NONE) {
        x->slave->mta = address + x->command[1];
        x->slave->text = NULL;
    }
    return error;
}

/* Of the page: CRC-32, so that of a whole page is config_t's own. */
static xcp_error_t build_checksum(exchange_t *x)
{
    const uint32_t count = word_at(&x->command[4]);
    xcp_t *slave = x->slave;
    if (slave->text != NULL || !is_within(slave->mta, count, XCP_PAGE_ADDRESS, PAGE_BYTES)) {
        return XCP_ERROR_ACCESS_DENIED;
    }
    const uint32_t crc = config_crc32(&page_of(x)[slave->mta - XCP_PAGE_ADDRESS], count);
    x->answer[1] = CHECKSUM_CRC_32;
    x->answer[2] = 0;
    x->answer[3] = 0;
    xcp_put(&x->answer[4], crc, sizeof(uint32_t));
    x->answer_bytes = 8;
    slave->mta += count;
    return XCP_ERROR_NONE;
}

/* One word of the scope's page. */
static xcp_error_t download_scope(exchange_t *x, uint32_t count)
{
    xcp_t *slave = x->slave;
    const uint32_t offset = slave->mta - XCP_SCOPE_ADDRESS;
    if (count != sizeof(int32_t) || offset % sizeof(int32_t) != 0) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    const xcp_error_t error =
        scope_write(x->access->scope, &x->access->table, offset / (uint32_t)sizeof(int32_t),
                    (int32_t)word_at(&x->command[2]));
    if (error == XCP_ERROR_NONE) {
        slave->mta += count;
    }
    return error;
}

static xcp_error_t download(exchange_t *x)
{
    xcp_t *slave = x->slave;
    const uint32_t count = x->command[1];
    if (count == 0 || count > XCP_PACKET_BYTES - 2U) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (x->length < 2U + count) {
        return XCP_ERROR_COMMAND_SYNTAX;
    }
    if (slave->text == NULL &&
        is_within(slave->mta, count, XCP_SCOPE_ADDRESS, sizeof(scope_page_t))) {
        return download_scope(x, count);
    }
    if (slave->text != NULL || !is_within(slave->mta, count, XCP_PAGE_ADDRESS, PAGE_BYTES)) {
        return XCP_ERROR_ACCESS_DENIED;
    }
    if (!slave->unlocked) {
        return has_key(x->access->in_force) ? XCP_ERROR_ACCESS_LOCKED : XCP_ERROR_WRITE_PROTECTED;
    }
    if (slave->page != XCP_PAGE_STAGING) {
        return XCP_ERROR_WRITE_PROTECTED;
    }
    uint8_t *page = (uint8_t *)x->access->staging;
    for (uint32_t i = 0; i < count; i++) {
        page[slave->mta - XCP_PAGE_ADDRESS + i] = x->command[2U + i];
    }
    slave->mta += count;
    return XCP_ERROR_NONE;
}

static xcp_error_t set_cal_page(exchange_t *x)
{
    const uint32_t mode = x->command[1];
    const uint32_t page = x->command[3];
    const bool of_controller = (mode & PAGE_OF_CONTROLLER) != 0;
    const bool of_tool = (mode & PAGE_OF_TOOL) != 0;
    const bool all_segments = (mode & PAGE_OF_ALL) != 0;
    if (!of_controller && !of_tool) {
        return XCP_ERROR_MODE_NOT_VALID;
    }
    if (!all_segments && x->command[2] >= SEGMENTS) {
        return XCP_ERROR_SEGMENT_NOT_VALID;
    }
    if (page >= XCP_PAGES) {
        return XCP_ERROR_PAGE_NOT_VALID;
    }
    if (page == XCP_PAGE_STAGING && of_controller) {
        return XCP_ERROR_MODE_NOT_VALID; /* its page changes at rest, by SET_REQUEST */
    }
    if (page == XCP_PAGE_STAGING && !x->slave->unlocked) {
        return XCP_ERROR_ACCESS_LOCKED;
    }
    x->slave->page = of_tool ? (xcp_page_t)page : x->slave->page;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_cal_page(exchange_t *x)
{
    const uint32_t mode = x->command[1];
    if (mode != PAGE_OF_CONTROLLER && mode != PAGE_OF_TOOL) {
        return XCP_ERROR_MODE_NOT_VALID;
    }
    if (x->command[2] >= SEGMENTS) {
        return XCP_ERROR_SEGMENT_NOT_VALID;
    }
    x->answer[1] = 0;
    x->answer[2] = 0;
    x->answer[3] = (uint8_t)(mode == PAGE_OF_TOOL ? x->slave->page : XCP_PAGE_IN_FORCE);
    x->answer_bytes = 4;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_page_processor_info(exchange_t *x)
{
    x->answer[1] = SEGMENTS;
    x->answer[2] = 0; /* no freezing */
    x->answer_bytes = 3;
    return XCP_ERROR_NONE;
}

static xcp_error_t copy_cal_page(exchange_t *x)
{
    const uint8_t *command = x->command;
    if (command[1] >= SEGMENTS || command[3] >= SEGMENTS) {
        return XCP_ERROR_SEGMENT_NOT_VALID;
    }
    if (command[2] >= XCP_PAGES || command[4] >= XCP_PAGES) {
        return XCP_ERROR_PAGE_NOT_VALID;
    }
    if (command[4] == XCP_PAGE_IN_FORCE) {
        return XCP_ERROR_WRITE_PROTECTED;
    }
    if (!x->slave->unlocked) {
        return XCP_ERROR_ACCESS_LOCKED;
    }
    if (command[2] == XCP_PAGE_IN_FORCE) {
        *x->access->staging = *x->access->in_force;
    }
    return XCP_ERROR_NONE;
}

static xcp_error_t execute(exchange_t *x)
{
    switch (x->command[0]) {
    case CONNECT:
        return connect(x);
    case DISCONNECT:
        end_session(x->slave, x->access);
        return XCP_ERROR_NONE;
    case GET_STATUS:
        return get_status(x);
    case GET_COMM_MODE_INFO:
        return get_comm_mode_info(x);
    case GET_ID:
        return get_id(x);
    case SET_REQUEST:
        return set_request(x);
    case GET_SEED:
        return get_seed(x);
    case UNLOCK:
        return unlock(x);
    case SET_MTA:
        return set_mta(x);
    case UPLOAD:
        return upload(x);
    case SHORT_UPLOAD:
        return short_upload(x);
    case BUILD_CHECKSUM:
        return build_checksum(x);
    case DOWNLOAD:
        return download(x);
    case SET_CAL_PAGE:
        return set_cal_page(x);
    case GET_CAL_PAGE:
        return get_cal_page(x);
    case GET_PAG_PROCESSOR_INFO:
        return get_page_processor_info(x);
    case COPY_CAL_PAGE:
        return copy_cal_page(x);
    case SYNCH:
        return XCP_ERROR_SYNCH;
    default: /* the rest has no length and does not come here */
        return xcp_daq_execute(x);
    }
}

static uint32_t answer_error(xcp_error_t error, uint8_t *answer)
{
    answer[0] = ERROR;
    answer[1] = (uint8_t)error;
    return 2;
}

void xcp_init(xcp_t *slave)
{
    const xcp_t fresh = {.connected = false, .daq_odt = DAQ_ODTS};
    *slave = fresh;
}

void xcp_tick(xcp_t *slave, const xcp_access_t *access, uint32_t now_ms)
{
    if (slave->connected && now_ms - slave->latest_ms >= XCP_IDLE_ms) {
        end_session(slave, access);
    }
    if (slave->unlocked && access->staging == NULL) {
        slave->unlocked = false;
        slave->page = XCP_PAGE_IN_FORCE;
    }
}

bool xcp_wants_seed(const xcp_t *slave)
{
    return slave->connected && !slave->seed_drawn;
}

void xcp_give_seed(xcp_t *slave, uint64_t seed)
{
    slave->seed = seed & XCP_SEED_MASK;
    slave->seed_drawn = true;
}

uint32_t xcp_command(xcp_t *slave, const xcp_access_t *access, uint32_t now_ms,
                     const uint8_t *command, uint32_t length, uint8_t answer[XCP_PACKET_BYTES])
{
    xcp_tick(slave, access, now_ms);
    if (length == 0 || length > XCP_PACKET_BYTES || (!slave->connected && command[0] != CONNECT)) {
        return 0;
    }
    exchange_t x = {.slave = slave,
                    .access = access,
                    .now_ms = now_ms,
                    .command = command,
                    .length = length,
                    .answer = answer,
                    .answer_bytes = 1};
    slave->latest_ms = now_ms;
    slave->store_wanted = false;
    const uint32_t needed = command[0] >= FIRST_COMMAND ? LENGTHS[command[0] - FIRST_COMMAND] : 0;
    if (needed == 0) {
        return answer_error(XCP_ERROR_COMMAND_UNKNOWN, answer);
    }
    if (length < needed) {
        return answer_error(XCP_ERROR_COMMAND_SYNTAX, answer);
    }
    answer[0] = POSITIVE;
    const xcp_error_t error = execute(&x);
    if (error != XCP_ERROR_NONE) {
        return answer_error(error, answer);
    }
    return slave->store_wanted ? 0 : x.answer_bytes;
}

uint32_t xcp_store(xcp_t *slave, xcp_error_t error, uint8_t answer[XCP_PACKET_BYTES])
{
    slave->store_wanted = false;
    if (error != XCP_ERROR_NONE) {
        return answer_error(error, answer);
    }
    slave->unlocked = false; /* what has been checked does not change any more */
    slave->page = XCP_PAGE_IN_FORCE;
    answer[0] = POSITIVE;
    return 1;
}
