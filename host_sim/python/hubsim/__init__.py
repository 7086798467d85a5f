# SPDX-License-Identifier: Apache-2.0
"""The simulated vehicle: scenarios, runs and reports in front of the C engine that holds firmware and plant.

Units are part of every name. Torques are per driven wheel; motor torque is signed, positive driving
forward; braking demands and hydraulic torques are magnitudes. Energies are those of the whole
vehicle.

    hubsim.load_configuration(path)   what a controller believes and a plant is made of
    hubsim.Bench(...)                 the vehicle, driven from Python
    hubsim.Controller(...)            the controller of one wheel alone
    hubsim.parameters()               everything about the simulated world that can be set
"""

from regen_table import __version__

from hubsim.bench import Bench, Recording
from hubsim.configuration import Configuration
from hubsim.configuration import load as load_configuration
from hubsim.controller import Controller
from hubsim.engine import parameters
from hubsim.errors import HubsimError
from hubsim.variables import Values, Variable

__all__ = [
    "Bench",
    "Configuration",
    "Controller",
    "HubsimError",
    "Recording",
    "Values",
    "Variable",
    "__version__",
    "load_configuration",
    "parameters",
]
