# SPDX-License-Identifier: Apache-2.0
"""Loss models, optimum, and the configuration and table generator of hubfoc.

Conventions of the whole package, stated once: motor signs (torque < 0 and power < 0 brake and feed
the battery), speeds in ELECTRICAL rad/s unless the name says mechanical, currents, voltages and
flux linkage in PEAK PHASE, amplitude-invariant quantities, so that P = 1.5 (u_d i_d + u_q i_q) and
T = 1.5 p (psi_d i_q - psi_q i_d).
"""

from regen_table import installation

__version__ = installation.version()

STRATEGIES = ("parallel_ratio", "parallel_free_travel", "series_optimal")  # of brake blending
SETTLED, DYNAMIC = "settled", "dynamic"  # how the battery's RC branch is carried through a trace
BATTERIES = (SETTLED, DYNAMIC)
# limits that an ideal stop can keep, by name (limited_stop)
STOP_LIMITS = (
    "phase_current",
    "voltage",
    "charge_current",
    "fold_back",
    "winding_temperature",
    "torque_rate",
    "blend_out",
)
