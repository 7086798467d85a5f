/* SPDX-License-Identifier: Apache-2.0 */
/* Operational amplifiers (RM0440 section 25) as the board wires them: input VINP0, gain by the
 * inner divider whose lower end is at VINM0, output on a pin. */
#include "analog.h"

enum { INPUT_OF_PIN = 0, GAIN_INSIDE = 2, WITH_BIAS = 1 };

typedef struct {
    uint32_t control;
    uint8_t in, out;
    char port;
} amplifier_t;
static const amplifier_t AMPLIFIERS[3] = {{CHIP_OPAMP_OPAMP1_CSR, 1, 2, 'A'},
                                          {CHIP_OPAMP_OPAMP2_CSR, 7, 6, 'A'},
                                          {CHIP_OPAMP_OPAMP3_CSR, 0, 1, 'B'}};

/* PGA_GAIN (25.5.1): 2, 4 .. 64 by its lower three bits; the upper two say what is at VINM0. */
double amplifier_V(const chip_t *chip, unsigned number)
{
    const amplifier_t *amplifier = &AMPLIFIERS[number - 1U];
    const uint32_t settings = chip_get(chip, amplifier->control);
    const uint32_t gain = (settings & CHIP_OPAMP_OPAMP1_CSR_PGA_GAIN) /
                          (CHIP_OPAMP_OPAMP1_CSR_PGA_GAIN & -CHIP_OPAMP_OPAMP1_CSR_PGA_GAIN);
    if ((settings & CHIP_OPAMP_OPAMP1_CSR_OPAEN) == 0 ||
        (settings & CHIP_OPAMP_OPAMP1_CSR_OPAINTOEN) != 0 ||
        (settings & CHIP_OPAMP_OPAMP1_CSR_VP_SEL) != INPUT_OF_PIN ||
        (settings & CHIP_OPAMP_OPAMP1_CSR_VM_SEL) >> 5 != GAIN_INSIDE || gain >> 3 != WITH_BIAS ||
        (gain & 7U) > 5U || !chip_pin_is_analog(chip, amplifier->port, amplifier->in) ||
        !chip_pin_is_analog(chip, amplifier->port, amplifier->out)) {
        return 0.0;
    }
    const double most = ANALOG_REFERENCE_uV / 1e6;
    const double times = 2U << (gain & 7U);
    const double out = times * analog_pin_V(chip, amplifier->port, amplifier->in) -
                       (times - 1.0) * chip->fault.amplifier_bias_mV / 1e3;
    return out < 0.0 ? 0.0 : (out > most ? most : out);
}
