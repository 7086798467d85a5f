# SPDX-License-Identifier: Apache-2.0
"""Whether an STM32F103, a Cortex-M3, has the time and the memory for the firmware.

    ./tools/dev python -m benchmark.cortex_m3 [SLOW_STEP]

Two programs are compiled for a Cortex-M3 (HUBFOC_CPU) into build/cortex_m3_PORT. The STM32F405's
takes the ride of benchmark.interrupt on the model of the STM32F405, whose peripherals cost what an
STM32F103's would; the clock is 64 MHz. SLOW_STEP: instructions of the longest slow step on a
Cortex-M3 over the envelope (build/bench.json, cores). Cycles are those of the core's table with the
longest refills, products and divisions, and the waits of a flash without cache; what is read
through registers from the flash is not in them. The STM32G431's is the smaller one, every file
compiled for size; its memory is compared with an STM32F103C8's.
"""

from __future__ import annotations

import sys
from pathlib import Path

from benchmark import build, cycles, interrupt, memory
from benchmark.build import ROOT, BenchError

CLOCK_HZ, PWM_HZ, SHARE_AT_MOST = 64_000_000, 16_000, 0.60
SLOW_STEP = 16_000
"""Instructions: the budget of the Cortex-M4 over the envelope, above what the M3 takes."""
FLASH_F103C8, RAM_F103C8 = 64 * 1024, 20 * 1024
CONFIGURATION = ".hubfoc_config"


def built(port: str) -> Path:
    """Compile a port's program for a Cortex-M3 and return the image."""
    directory, name = ROOT / "build" / f"cortex_m3_{port}", f"hubfoc_{port}"
    toolchain = ROOT / "tools" / "cmake" / "arm-none-eabi.cmake"
    build.run(
        ["cmake", "-S", str(ROOT), "-B", str(directory), "-G", "Ninja", f"-DHUBFOC_PORT={port}",
         "-DHUBFOC_CPU=cortex-m3", "-DCMAKE_BUILD_TYPE=Release", "-DHUBFOC_TESTS=ON",
         f"-DCMAKE_TOOLCHAIN_FILE={toolchain}"],
        f"configuring {name} for a Cortex-M3",
    )  # fmt: skip
    build.run(
        ["cmake", "--build", str(directory), "--target", name],
        f"building {name} for a Cortex-M3",
        timeout_s=1800.0,
    )
    return directory / f"{name}.elf"


def show_time(image: Path, slow_step: int) -> None:
    """Measure an image and print the table of hal/README.md."""
    found = interrupt.measure(image, machine=cycles.STM32F103, others=False)
    fast, slow = (
        found["cycles"][name]["cold"] for name in ("pwm_interrupt", "millisecond_interrupt")
    )
    each = found["cycles"]["cold_an_instruction"]
    worst_slow = max(slow["max"], round(each * slow_step))
    periods, millisecond = PWM_HZ // 1000, CLOCK_HZ // 1000
    for name, median, worst, of in (
        ("PWM interrupt", fast["median"], fast["max"], CLOCK_HZ // PWM_HZ),
        ("millisecond interrupt", slow["median"], worst_slow, millisecond),
        (
            "both",
            periods * fast["median"] + slow["median"],
            periods * fast["max"] + worst_slow,
            millisecond,
        ),
    ):
        print(
            f"{name}, of {of} cycles: median {median}, {100 * median / of:.0f} %,"
            f" worst {worst}, {100 * worst / of:.0f} %"
        )
    share = (periods * fast["max"] + worst_slow) / millisecond
    print(f"{'fits' if share <= SHARE_AT_MOST else 'does not fit'} {100 * SHARE_AT_MOST:.0f} %")


def show_memory(image: Path) -> None:
    """Compare program, two configurations and RAM with an STM32F103C8."""
    flash, ram, recordings = memory.sections(image)
    configuration, mark = memory.section(image, CONFIGURATION), 8
    program = flash - configuration - mark
    wanted = program + 2 * (configuration + mark)
    print(
        f"flash: program {program}, two configurations of {configuration + mark}: {wanted} of"
        f" {FLASH_F103C8} bytes, {abs(FLASH_F103C8 - wanted)}"
        f" {'missing' if wanted > FLASH_F103C8 else 'left'}"
    )
    wanted = ram - recordings
    print(
        f"RAM without the black box: {wanted} of {RAM_F103C8} bytes, {abs(RAM_F103C8 - wanted)}"
        f" {'missing' if wanted > RAM_F103C8 else 'left'}"
    )


def main(arguments: list[str]) -> int:
    """Build and measure both programs."""
    if len(arguments) > 1 or not all(argument.isdecimal() for argument in arguments):
        print("usage: python -m benchmark.cortex_m3 [SLOW_STEP]", file=sys.stderr)
        return 2
    show_time(built("stm32f405"), int(arguments[0]) if arguments else SLOW_STEP)
    show_memory(built("stm32g431"))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BenchError as error:
        sys.exit(f"error: {error}")
