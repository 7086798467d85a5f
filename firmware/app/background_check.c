/* SPDX-License-Identifier: Apache-2.0 */
#include "app/background_check.h"

#include <stddef.h>

#include "config/validate.h"

void background_check_init(background_check_t *check, const config_t *config,
                           flash_image_t firmware, uint32_t firmware_crc32)
{
    const background_check_t fresh = {
        .config = config, .firmware = firmware, .firmware_crc32 = firmware_crc32};
    *check = fresh;
}

bool background_check_step(background_check_t *check, uint32_t stack_free_bytes)
{
    const uint8_t *image = check->in_firmware ? check->firmware.begin : (const void *)check->config;
    const uint32_t size_bytes =
        check->in_firmware ? check->firmware.size_bytes : (uint32_t)offsetof(config_t, crc32);
    const uint32_t left_bytes = size_bytes - check->at_bytes;
    const uint32_t part_bytes =
        left_bytes < BACKGROUND_CHECK_BYTES ? left_bytes : BACKGROUND_CHECK_BYTES;
    check->crc = config_crc32_continue(check->crc, &image[check->at_bytes], part_bytes);
    check->at_bytes += part_bytes;
    if (check->at_bytes == size_bytes) {
        const uint32_t right = check->in_firmware ? check->firmware_crc32 : check->config->crc32;
        const bool differs = check->crc != right;
        check->damaged = check->damaged || differs;
        check->config_damaged = check->config_damaged || (differs && !check->in_firmware);
        check->in_firmware = !check->in_firmware;
        check->at_bytes = 0;
        check->crc = 0;
    }
    check->damaged = check->damaged || stack_free_bytes < BACKGROUND_CHECK_STACK_bytes;
    return !check->damaged;
}
