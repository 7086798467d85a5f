# SPDX-License-Identifier: Apache-2.0
"""An FMU as used by an importer, for both versions of the standard."""

import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

FOLDER = Path(os.environ["HUBFOC_BUILD_DIR"]) / "host_sim" / "fmu"
VERSIONS = (2, 3)


def path_of(kind: str, fmi: int) -> Path:
    return FOLDER / f"hubfoc_{kind}_fmi{fmi}.fmu"


class Unit:
    """One instance that has been initialised with some start values."""

    def _passed_as(self, kind: str) -> str:
        """Return as what the standard passes values of a type."""
        return ("Integer" if self.fmi == 2 else "Int64") if kind == "Enumeration" else kind

    def __init__(self, path: Path, starts: Mapping[str, float] | None = None) -> None:
        self.description: Any = fmpy.read_model_description(str(path))
        self.fmi = 2 if self.description.fmiVersion == "2.0" else 3
        self.folder = fmpy.extract(str(path))
        self.messages: list[str] = []
        names = {
            "modelIdentifier": self.description.coSimulation.modelIdentifier,
            "unzipDirectory": self.folder,
            "instanceName": "x",
        }
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.slave: Any = (FMU2Slave if self.fmi == 2 else FMU3Slave)(
            guid=self.description.guid, **names
        )
        self.slave.instantiate()
        for name, value in (starts or {}).items():
            self.set(name, value)
        self.time_s = 0.0
        if self.fmi == 2:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def set(self, name: str, value: float) -> None:
        v = self.variables[name]
        write = getattr(self.slave, f"set{self._passed_as(v.type)}")
        write([v.valueReference], [value if v.type in {"Real", "Float64"} else int(value)])

    def get(self, name: str) -> float:
        v = self.variables[name]
        return float(getattr(self.slave, f"get{self._passed_as(v.type)}")([v.valueReference])[0])

    def get_all(self, names: Sequence[str]) -> list[float]:
        return [self.get(name) for name in names]

    def outputs(self) -> list[str]:
        return [str(name) for name, v in self.variables.items() if v.causality == "output"]

    def step(self, step_s: float) -> None:
        self.slave.doStep(currentCommunicationPoint=self.time_s, communicationStepSize=step_s)
        self.time_s += step_s
