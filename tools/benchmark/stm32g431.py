# SPDX-License-Identifier: Apache-2.0
"""The STM32G431 around its flashable image, and its PWM interrupt.

    python -m benchmark.stm32g431 IMAGE

The image boots from its reset vector, calibrates, and takes the ride of benchmark.interrupt with
the wheel of tools/motors/bench: its own clock tree, converters, FDCAN and timer, as far as the
firmware waits for them, reads them or acts on them. Exit status 1 if its clock, its timer, the
moment of its sample or its bit rates are not as documented, if it does not come to drive, or if the
interrupt takes more instructions than its budget.
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from benchmark import cycles, elf, interrupt
from benchmark.build import BenchError
from benchmark.chip import (
    CORE_BYTES,
    CORE_PERIPHERALS,
    PERIPHERALS,
    PERIPHERALS_BYTES,
    TIM_ARR,
    TIM_BDTR,
    Chip,
)

# RM0440: addresses of the registers that do more than store.
RCC_CR, RCC_CFGR, RCC_PLLCFGR, FLASH_ACR = 0x40021000, 0x40021008, 0x4002100C, 0x40022000
PWR_CR5, PWR_CR5_NO_BOOST = 0x40007080, 1 << 8
TIM1_CCMR2, TIM1_CCR4 = 0x40012C1C, 0x40012C40
ADC1, ADC2 = 0x50000000, 0x50000100
ADC_ISR, ADC_CR, ADC_JDR = 0x00, 0x08, 0x80
ADC_READY, ADC_ON, ADC_CALIBRATES = 1 << 0, 1 << 0, 1 << 31
FDCAN_CCCR, FDCAN_PSR, FDCAN_RXF0S, FDCAN_RXF0A = 0x40006418, 0x40006444, 0x40006490, 0x40006494
FDCAN_FIFO_0 = 0x4000A400 + 0xB0
BUS_IDLE = 1 << 3
FDCAN_NBTP, USART2_BRR, ADC1_SMPR1, ADC1_JSQR = 0x4000641C, 0x4000440C, 0x50000014, 0x5000004C
DAC_DHR, DAC_DOR = (0x50001008, 0x50001014), (0x5000102C, 0x50001030)
COMPARATORS = {0x40010200: DAC_DHR[0], 0x40010204: DAC_DHR[1], 0x4001020C: DAC_DHR[1]}
"""Their control registers, and the threshold of each."""
COMPARATOR_HIGH, LEVEL_CODE = 1 << 30, 128
CRYSTAL_HZ = 8e6
SAMPLING_CYCLES = (2.5, 6.5, 12.5, 24.5, 47.5, 92.5, 247.5, 640.5)
LATENCY_CYCLES, CONVERTER_CLOCKS = 2.125, 4
GPIOB_IDR = 0x48000410
MIDDLE_CODE, GROUND_OHM, THERMISTOR_OHM = 2048, 4700, 10000
"""The board's thermistor is 10 kOhm at the ride's 25 degC, over 4.7 kOhm."""

MEDIAN_AT_MOST, MAX_AT_MOST = 520, 880


@dataclass
class ChipG431(Chip):
    """One STM32G431 on a B-G431B-ESC1 with an image in its flash."""

    MAPPED: ClassVar[tuple[tuple[int, int], ...]] = (
        (PERIPHERALS, PERIPHERALS_BYTES),
        (CORE_PERIPHERALS, CORE_BYTES),
        (0x48000000, 0x2000),
        (0x50000000, 0x2000),
    )
    TIM1: ClassVar[int] = 0x40012C00
    INPUTS: ClassVar[dict[str, int]] = {"B": GPIOB_IDR}
    CLOCK_HZ: ClassVar[float] = 170e6

    def _reads(self) -> dict[int, Callable[[], int]]:
        return {
            RCC_CR: lambda: self._ready_bits(RCC_CR, ((16, 17), (24, 25))),
            RCC_CFGR: lambda: self._ready_bits(RCC_CFGR, ((0, 2), (1, 3))),
            ADC1 + ADC_CR: self._converter_control(ADC1),
            ADC2 + ADC_CR: self._converter_control(ADC2),
            ADC1 + ADC_ISR: self._converter_status(ADC1),
            ADC2 + ADC_ISR: self._converter_status(ADC2),
            FDCAN_PSR: lambda: 0 if self.registers.get(FDCAN_CCCR, 1) & 1 else BUS_IDLE,
            FDCAN_RXF0S: lambda: min(len(self.frames), 3),
            **{FDCAN_FIFO_0 + 4 * i: self._of_element(i) for i in range(4)},
            **{each: self._comparator(each) for each in COMPARATORS},
            **{out: self._of(code) for out, code in zip(DAC_DOR, DAC_DHR, strict=True)},
        }

    def _writes(self) -> dict[int, Callable[[int], None]]:
        return {FDCAN_RXF0A: self._acknowledge_frame}

    def _of(self, address: int) -> Callable[[], int]:
        return lambda: self.registers.get(address, 0)

    def _comparator(self, control: int) -> Callable[[], int]:
        """Return the reader of a comparator whose input is at the level without current."""
        return lambda: (
            self.registers.get(control, 0)
            | (COMPARATOR_HIGH if self.registers.get(COMPARATORS[control], 0) < LEVEL_CODE else 0)
        )

    def _converter_control(self, converter: int) -> Callable[[], int]:
        """Return the reader of a control register: a calibration ends at once."""
        return lambda: self.registers.get(converter + ADC_CR, 0) & ~ADC_CALIBRATES

    def _converter_status(self, converter: int) -> Callable[[], int]:
        """Return the reader of a status register: a converter that is on is ready."""
        return lambda: ADC_READY if self.registers.get(converter + ADC_CR, 0) & ADC_ON else 0

    def _acknowledge_frame(self, _index: int) -> None:
        if self.frames:
            self.frames.popleft()

    def _of_element(self, word: int) -> Callable[[], int]:
        """Word 0 to 3 of the oldest frame's element."""
        return lambda: self._element()[word]

    def _element(self) -> tuple[int, ...]:
        if not self.frames:
            return 0, 0, 0, 0
        identifier, data = self.frames[0]
        return identifier << 18, len(data) << 16, *struct.unpack("<2I", data)

    def sample(
        self, current_codes: tuple[int, int, int], bus_code: int, temperature_code: int
    ) -> None:
        """Results of the two converters; the board measures currents a and b."""
        if temperature_code != MIDDLE_CODE:
            raise BenchError("the thermistor of the ride is at 25 degC")
        self.registers[ADC1 + ADC_JDR] = current_codes[0]
        self.registers[ADC2 + ADC_JDR] = current_codes[1]
        self.registers[ADC1 + ADC_JDR + 4] = bus_code
        self.registers[ADC1 + ADC_JDR + 8] = 4096 * GROUND_OHM // (GROUND_OHM + THERMISTOR_OHM)

    def halls(self, state: int) -> None:
        """Levels of the three hall inputs, PB6 to PB8."""
        self.registers[GPIOB_IDR] = 0xFFFF & ~(7 << 6) | state << 6


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
    top = registers[ChipG431.TIM1 + TIM_ARR]
    dead = dead_time_clocks(registers[ChipG431.TIM1 + TIM_BDTR] & 0xFF)
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


def check_timing(image: Path) -> None:
    """Boot the image; raise BenchError for a frequency or a moment that is not as documented."""
    chip = ChipG431(image)
    chip.registers[PWR_CR5] = PWR_CR5_NO_BOOST  # after reset
    chip.boot(elf.symbols(image)["app_background"].address)
    found = timing(chip.registers)
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
        measured = interrupt.measure(Path(image), chip_type=ChipG431, machine=cycles.STM32G431)
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
    if not met:
        print(f"more than {MEDIAN_AT_MOST} and {MAX_AT_MOST}", file=sys.stderr)
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
