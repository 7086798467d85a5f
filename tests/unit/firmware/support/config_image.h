/* SPDX-License-Identifier: Apache-2.0 */
/* config_image.h: the configuration that this build's firmware carries, under one name whatever it
 * is called. */
#ifndef TEST_CONFIG_IMAGE_H
#define TEST_CONFIG_IMAGE_H

#include <stddef.h>

#include "config/config.h"

extern const config_t CONFIG_IMAGE;

#endif
