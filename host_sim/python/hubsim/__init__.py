# SPDX-License-Identifier: Apache-2.0
"""The simulated vehicle.

Scenarios, runs and reports in front of the C engine that holds firmware and plant.

Units are part of every name. Torques are per driven wheel; motor torque is signed, positive driving
forward; braking demands and hydraulic torques are magnitudes. Energies are those of the whole
vehicle.

    hubsim.load_configuration(path)   what a controller is configured with and a plant is made of
    hubsim.Bench(...)                 the vehicle, driven from Python
    hubsim.Controller(...)            the controller of one wheel alone
    hubsim.Plant(...)                 the vehicle without controllers, for those of one's own
    hubsim.parameters()               everything about the simulated world that can be set

Modules are in groups: ``scenario`` (what is to be done and shown), ``run`` (one run of it),
``sweep`` (many), ``report`` (the page and a controller's own records), ``fmu`` and ``cli``. What is
directly in the package is their common floor: the engine, one controller, files, errors.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from regen_table import __version__

    from hubsim.configuration import Configuration
    from hubsim.configuration import load as load_configuration
    from hubsim.controller import Controller
    from hubsim.engine import parameters
    from hubsim.errors import HubsimError
    from hubsim.run.bench import Bench, Recording
    from hubsim.run.external import Measurement, Plant
    from hubsim.variables import Values, Variable

# Loaded at first use: a command that needs none of it starts without NumPy and the engine, and
# ``can_protocol`` alone works where nothing else is installed.
_PLACES = {
    "Bench": ("hubsim.run.bench", "Bench"),
    "Configuration": ("hubsim.configuration", "Configuration"),
    "Controller": ("hubsim.controller", "Controller"),
    "HubsimError": ("hubsim.errors", "HubsimError"),
    "Measurement": ("hubsim.run.external", "Measurement"),
    "Plant": ("hubsim.run.external", "Plant"),
    "Recording": ("hubsim.run.bench", "Recording"),
    "Values": ("hubsim.variables", "Values"),
    "Variable": ("hubsim.variables", "Variable"),
    "__version__": ("regen_table", "__version__"),
    "load_configuration": ("hubsim.configuration", "load"),
    "parameters": ("hubsim.engine", "parameters"),
}

# Modules that can be had from the package itself, as ``from hubsim import stops``.
_MODULES = {
    "scenario": ("criteria", "cycles", "events", "expression", "faults", "keys", "overrides"),
    "run": (
        *("bench", "difference", "evaluation", "external", "plant", "plotjuggler", "recordings"),
        *("results", "stops"),
    ),
}
_GROUPS = {name: group for group, names in _MODULES.items() for name in names}

__all__ = [
    "Bench",
    "Configuration",
    "Controller",
    "HubsimError",
    "Measurement",
    "Plant",
    "Recording",
    "Values",
    "Variable",
    "__version__",
    "load_configuration",
    "parameters",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401, whatever is public
    if name in _GROUPS:
        found = importlib.import_module(f"hubsim.{_GROUPS[name]}.{name}")
    elif name in _PLACES:
        module, attribute = _PLACES[name]
        found = getattr(importlib.import_module(module), attribute)
    else:
        raise AttributeError(f"module 'hubsim' has no attribute {name!r}")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACES, *_GROUPS})
