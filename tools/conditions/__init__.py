# SPDX-License-Identifier: Apache-2.0
"""Branches and conditions of the pure modules that their unit tests reach (MC/DC)."""
