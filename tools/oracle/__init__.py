# SPDX-License-Identifier: Apache-2.0
"""Hashes of everything the firmware computes, beside stored ones (tests/oracle/README.md)."""
