# SPDX-License-Identifier: Apache-2.0
"""What the registers of the STM32G431's image mean, and its PWM interrupt.

    python -m benchmark.stm32g431 IMAGE

The image boots on the model of its chip (tests/target/chip) and takes the ride of
benchmark.interrupt. Exit status 1 if its clock, its timer, the moment of its sample or its bit
rates are not as documented, if it does not come to drive, or if the interrupt takes more
instructions or the load more of the core than its budget.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from benchmark import cycles, interrupt
from benchmark.build import BenchError

# RM0440: addresses of the registers that are read back.
RCC_CFGR, RCC_PLLCFGR, FLASH_ACR = 0x40021008, 0x4002100C, 0x40022000
PWR_CR5, PWR_CR5_NO_BOOST = 0x40007080, 1 << 8
TIM1_CCMR2, TIM1_ARR, TIM1_CCR4, TIM1_BDTR = 0x40012C1C, 0x40012C2C, 0x40012C40, 0x40012C44
FDCAN_NBTP, USART2_BRR, ADC1_SMPR1, ADC1_JSQR = 0x4000641C, 0x4000440C, 0x50000014, 0x5000004C
CRYSTAL_HZ = 8e6
SAMPLING_CYCLES = (2.5, 6.5, 12.5, 24.5, 47.5, 92.5, 247.5, 640.5)
LATENCY_CYCLES, CONVERTER_CLOCKS = 2.125, 4

MEDIAN_AT_MOST, MAX_AT_MOST = 505, 830
PORT = interrupt.PORTS["stm32g431"]


def dead_time_clocks(code: int) -> int:
    """DTG of TIM1_BDTR (RM0440 section 28.6.20)."""
    if code < 0x80:
        return code
    if code < 0xC0:
        return 2 * (64 + (code & 0x3F))
    return (8 if code < 0xE0 else 16) * (32 + (code & 0x1F))


def timing(registers: dict[int, int]) -> dict[str, float]:
    """Return what the registers of a chip that has booted mean, by the reference manual."""
    pll = registers[RCC_PLLCFGR]
    core = CRYSTAL_HZ / ((pll >> 4 & 0xF) + 1) * (pll >> 8 & 0x7F) / (2 * ((pll >> 25 & 3) + 1))
    if registers[RCC_CFGR] & 3 != 3 or registers[RCC_CFGR] >> 4 & 8 or pll & 3 != 3:
        core = 0.0  # not from the crystal and the PLL, or divided
    bit = registers[FDCAN_NBTP]
    quanta = 3 + (bit >> 8 & 0xFF) + (bit & 0x7F)
    top = registers[TIM1_ARR]
    dead = dead_time_clocks(registers[TIM1_BDTR] & 0xFF)
    # Mode 2 rises at its value on the way up, mode 1 one below it on the way down.
    up = registers[TIM1_CCMR2] >> 12 & 7 == 7
    trigger = registers[TIM1_CCR4] - top if up else top - registers[TIM1_CCR4] + 1
    channel = registers[ADC1_JSQR] >> 9 & 0x1F
    sampling = SAMPLING_CYCLES[registers[ADC1_SMPR1] >> 3 * channel & 7]
    sample_clocks = trigger + CONVERTER_CLOCKS * (LATENCY_CYCLES + sampling)
    return {
        "core_hz": core,
        "flash_wait_states": registers[FLASH_ACR] & 0xF,
        "boost": not registers[PWR_CR5] & PWR_CR5_NO_BOOST,
        "pwm_hz": core / (2 * top),
        "dead_time_s": dead / core if core else 0.0,
        "sample_off_middle_clocks": sample_clocks - dead / 2,
        "can_bit_hz": CRYSTAL_HZ / ((bit >> 16 & 0x1FF) + 1) / quanta,
        "serial_bit_hz": core / registers[USART2_BRR],
    }


def registers_of(image: Path) -> dict[int, int]:
    """Return the registers of the peripherals of a chip that has booted."""
    with tempfile.TemporaryDirectory() as scratch:
        output = Path(scratch) / "registers"
        interrupt.drive(image, PORT, "registers", output)
        pairs = (line.split() for line in output.read_text().splitlines())
        return {int(address, 16): int(value, 16) for address, value in pairs}


def check_timing(image: Path) -> None:
    """Boot the image; raise BenchError for a frequency or a moment that is not as documented."""
    found = timing(registers_of(image))
    for name, wanted, tolerance in (
        ("core_hz", 170e6, 0.0),
        ("flash_wait_states", 4, 0.0),
        ("boost", True, 0.0),
        ("pwm_hz", 20e3, 1.0),
        ("dead_time_s", 0.5e-6, 6e-9),
        ("sample_off_middle_clocks", 0.0, 1.5),
        ("can_bit_hz", 500e3, 0.0),
        ("serial_bit_hz", 115200.0, 100.0),
    ):
        if not abs(found[name] - wanted) <= tolerance:
            raise BenchError(f"{name} is {found[name]:g}, not {wanted:g}")


def main(image: str) -> int:
    """Drive the image and report."""
    try:
        check_timing(Path(image))
        measured = interrupt.measure(Path(image), PORT, others=False)
    except BenchError as error:
        print(f"stm32g431: {error}", file=sys.stderr)
        return 1
    counted = measured["instructions"]
    taken = measured["cycles"]
    print(f"stm32g431: {measured['config']}: booted, calibrated, drove and braked")
    warm = taken["pwm_interrupt"]["most"]["max"]
    print(
        f"PWM interrupt: median {counted['median']}, worst {counted['max']} instructions"
        f" ({measured['worst_state']}); warm at most {warm} cycles,"
        f" load {taken['load_warm']:.1%} of the core"
    )
    met = counted["median"] <= MEDIAN_AT_MOST and counted["max"] <= MAX_AT_MOST
    load = cycles.judge_load(taken)
    if not met:
        print(f"more than {MEDIAN_AT_MOST} and {MAX_AT_MOST}", file=sys.stderr)
    if not load["met"]:
        print(f"more load than {load['share_at_most']:.0%}", file=sys.stderr)
    return 0 if met and load["met"] else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
