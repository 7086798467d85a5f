# SPDX-License-Identifier: Apache-2.0
"""The virtual vehicle: simulated wheels with the whole application on a CAN bus, in real time."""
