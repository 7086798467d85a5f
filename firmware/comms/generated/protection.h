/* SPDX-License-Identifier: Apache-2.0 */
/* By generate.py: the numbers of the end-to-end protection (comms/e2e.h). */
/* clang-format off */
#ifndef COMMS_GENERATED_PROTECTION_H
#define COMMS_GENERATED_PROTECTION_H

enum {
    PROTECTION_P5_POLYNOMIAL = 0x1021,
    PROTECTION_P5_INITIAL = 0xffff,
    PROTECTION_P5_COUNTER_MASK = 0xff,
    PROTECTION_P2_POLYNOMIAL = 0x2f,
    PROTECTION_P2_INITIAL = 0xff,
    PROTECTION_P2_FINAL = 0xff,
    PROTECTION_P2_COUNTER_MASK = 0xf,
    PROTECTION_P5_DATA_ID = 0x1000,
};

#define PROTECTION_P2_DATA_IDS {0x40, 0xd0, 0xea, 0x7a, 0x80, 0x10, 0x2a, 0xba, 0x20, 0xb0, 0x8a, 0x1a, 0xe0, 0x70, 0x4a, 0xda}

#endif
