# SPDX-License-Identifier: Apache-2.0
"""What is counted, by name."""

CURRENT_LOOP = "foc_current_step"
FAST_STEP = "controller_fast_step"
SLOW_STEP = "controller_slow_step"
INTERRUPT = "pwm_interrupt"
IMAGE_CORE = "stm32f405"
FUNCTIONS = {CURRENT_LOOP: "current loop", FAST_STEP: "whole fast step", SLOW_STEP: "slow step"}
OTHER_ROTORS = {f"{FAST_STEP}_encoder": 2, f"{FAST_STEP}_angle": 0}
"""The fast step with other sensors than halls, by their numbers in the configuration."""
