# SPDX-License-Identifier: Apache-2.0
"""By what a controller was started, by the code that black box and journal keep."""

CAUSES = (
    *("", "SUPPLY", "LOW_SUPPLY", "WATCHDOG", "WINDOW_WATCHDOG", "LOW_POWER_MODE", "PROGRAM"),
    *("OPTION_BYTES", "RESET_PIN"),
)
"""In the order of reset_cause_t in hal/include/hal/watchdog.h."""


def name(code: int) -> str:
    """Return the cause, empty if it is not known."""
    return CAUSES[code] if code < len(CAUSES) else f"unknown {code}"
