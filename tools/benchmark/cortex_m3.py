# SPDX-License-Identifier: Apache-2.0
"""Whether an STM32F103 at 64 MHz, a Cortex-M3, has the time for both loops.

    python -m benchmark.cortex_m3 IMAGE SLOW_STEP

IMAGE: the STM32F405's firmware compiled for a Cortex-M3 (HUBFOC_CPU), which takes the ride of
benchmark.interrupt on the model of the STM32F405; its peripherals cost what theirs would.
SLOW_STEP: instructions of the longest slow step on a Cortex-M3 over the envelope
(build/bench.json, cores). Cycles are those of the core's table with the longest refills, products
and divisions, and the waits of a flash without cache; what is read through registers from the flash
is not in them.
"""

from __future__ import annotations

import sys
from pathlib import Path

from benchmark import cycles, interrupt
from benchmark.build import BenchError

CLOCK_HZ, PWM_HZ, SHARE_AT_MOST = 64_000_000, 16_000, 0.60


def main(arguments: list[str]) -> int:
    """Measure an image and print the table of hal/README.md."""
    if len(arguments) != 2:
        print("usage: python -m benchmark.cortex_m3 IMAGE SLOW_STEP", file=sys.stderr)
        return 2
    found = interrupt.measure(Path(arguments[0]), machine=cycles.STM32F103)
    fast, slow = (
        found["cycles"][name]["cold"] for name in ("pwm_interrupt", "millisecond_interrupt")
    )
    each = found["cycles"]["cold_an_instruction"]
    worst_slow = max(slow["max"], round(each * int(arguments[1])))
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
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BenchError as error:
        sys.exit(f"error: {error}")
