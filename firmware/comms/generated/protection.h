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
};

#define PROTECTION_P2_DATA_IDS {0x00, 0x90, 0xaa, 0x3a, 0xc0, 0x50, 0x6a, 0xfa, 0x60, 0xf0, 0xca, 0x5a, 0xa0, 0x30, 0x0a, 0x9a}

#endif
