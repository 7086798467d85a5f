# SPDX-License-Identifier: Apache-2.0
"""Counts and sizes of the firmware: instructions of a step, bytes of code, depth of the stack."""
