/* SPDX-License-Identifier: Apache-2.0 */
#include "app/installer.h"

#include <stddef.h>

#include "app/board_check.h"
#include "app/config_store.h"
#include "app/report.h"
#include "hal/inverter.h"

enum { CANCEL = 0x03 };

void installer_init(installer_t *installer)
{
    installer->state = INSTALLER_CLOSED;
}

config_t *installer_staging(installer_t *installer)
{
    return installer->state == INSTALLER_CLOSED ? &installer->image.config : NULL;
}

config_result_t installer_check_staging(installer_t *installer)
{
    config_t *config = &installer->image.config;
    config->crc32 = config_crc32(config, (uint32_t)offsetof(config_t, crc32));
    return board_check_config(config, (uint32_t)sizeof *config);
}

void installer_accept_staging(installer_t *installer)
{
    if (installer_check_staging(installer).code == CONFIG_RESULT_OK) {
        installer->hex.size_bytes = (uint32_t)sizeof(config_t);
        installer->state = INSTALLER_ACCEPTED;
    }
}

void installer_open(installer_t *installer, uint32_t now_ms)
{
    intel_hex_init(&installer->hex, installer->image.bytes,
                   (uint32_t)sizeof installer->image.bytes);
    installer->received_ms = now_ms;
    installer->state = INSTALLER_RECEIVING;
}

static void validate(installer_t *installer)
{
    installer->state = INSTALLER_REFUSED;
    if (installer->hex.problem == INTEL_HEX_GOOD) {
        installer->config_result =
            board_check_config(&installer->image.config, installer->hex.size_bytes);
        if (installer->config_result.code == CONFIG_RESULT_OK) {
            installer->state = INSTALLER_ACCEPTED;
        }
    }
}

void installer_receive(installer_t *installer, uint8_t byte, uint32_t now_ms)
{
    installer->received_ms = now_ms;
    if (byte == (uint8_t)CANCEL) {
        installer->state = INSTALLER_CANCELLED;
    } else if (intel_hex_receive(&installer->hex, byte)) {
        validate(installer);
    }
}

void installer_tick(installer_t *installer, uint32_t now_ms)
{
    if (installer->state == INSTALLER_RECEIVING &&
        now_ms - installer->received_ms >= INSTALLER_TIMEOUT_ms) {
        installer->state = INSTALLER_CANCELLED;
    }
}

void installer_text(const installer_t *installer, text_t *line)
{
    if (installer->state == INSTALLER_ACCEPTED) {
        text_add(line, "accepted: ");
        report_identity(&installer->image.config, line);
        return;
    }
    if (installer->state == INSTALLER_CANCELLED) {
        text_add(line, "given up; the configuration is as it was");
        return;
    }
    if (installer->hex.problem != INTEL_HEX_GOOD) {
        text_add(line, "refused: record ");
        text_add_integer(line, (int32_t)installer->hex.record);
        text_add(line, ": ");
        text_add(line, intel_hex_text(installer->hex.problem));
    } else {
        report_refusal(&installer->config_result, line);
    }
    text_add(line, "; the configuration is as it was");
}

bool installer_write(const installer_t *installer, text_t *line)
{
    inverter_trip();
    switch (config_store_replace(installer->image.bytes, installer->hex.size_bytes)) {
    case FLASH_OK:
        text_add(line, "written, restarting");
        return true;
    case FLASH_UNSUPPORTED:
        text_add(line, "FAILED: this port has no memory to write to");
        break;
    case FLASH_TOO_LARGE:
        text_add(line, "FAILED: larger than the memory");
        break;
    case FLASH_BRIDGE_ON:
        text_add(line, "FAILED: the bridge switches");
        break;
    case FLASH_ERASE_FAILED:
    case FLASH_WRITE_FAILED:
        text_add(line, "FAILED: the memory did not take it");
        break;
    }
    text_add(line, "; the configuration is as it was; restarting");
    return false;
}
