# SPDX-License-Identifier: Apache-2.0
"""A winding sensor of every kind on the bench: read, broken, and one of another kind."""

from pathlib import Path

import hubsim
import pytest
from hubsim.reasons import identifier

LU2013 = Path(__file__).parents[4] / "tools" / "motors" / "lu2013.toml"
WINDINGS_C = (0.0, 25.0, 80.0, 130.0)
NTC = {"kind": 1.0, "ohm_25c": 10e3, "beta_k": 3380.0}
# R = R_25 (1 + a (T - 25) + b (T - 25)^2) is IEC 60751 within 0.1 K, and through the 498, 603 and
# 1 000 Ohm that the data sheet of the KTY84 has at 0, 25 and 100 degC; its 1 194 at 130 by 1 Ohm.
SENSORS = {
    "ntc": NTC,
    "pt1000": {
        **{"kind": 2.0, "ohm_25c": 1097.35, "linear_per_k": 3.5353e-3, "square_per_k2": -5.263e-7}
    },
    "kty84": {"kind": 2.0, "ohm_25c": 603.0, "linear_per_k": 7.4185e-3, "square_per_k2": 1.8131e-5},
    "table": NTC,
}
# Of an NTC of 10 kOhm and B = 3380 K, by hand.
POINTS = [
    [-20.0, 75.02e3],
    [0.0, 28.22e3],
    [25.0, 10e3],
    [60.0, 3.039e3],
    [90.0, 1.314e3],
    [150.0, 351.2],
]
POINTS_ERROR_K = 4.0  # between them ln R is a line in T


def seen(
    kind: str, fitted: dict[str, float], winding_c: float, fault: str = ""
) -> tuple[float, set[str]]:
    """Return what a sensor shows that is configured as a kind, and what the wheel warns of."""
    settings: dict[str, object] = {"monitor.winding_sensor": kind}
    if kind == "table":
        settings["monitor.winding_sensor_points"] = POINTS
    plant = {f"winding_sensor.{key}": value for key, value in fitted.items()}
    bench = hubsim.Bench(
        hubsim.load_configuration(LU2013, settings),
        None,
        plant=plant | {"winding_sensor.divider_ohm": 10e3},
        events={"broken": {"at_s": 0.1, "inject": f"winding_sensor_{fault}"}} if fault else {},
        record=("wheel0.winding_sensor_c", "wheel0.warning_reason"),
        initial_speed_kmh=20.0,
        record_interval_s=0.05,
        max_duration_s=0.6,
        winding_temperature_c=winding_c,
    )
    run = bench.run()
    return run["wheel0.winding_sensor_c"][-1], {identifier(c) for c in run["wheel0.warning_reason"]}


@pytest.mark.parametrize("winding_c", WINDINGS_C)
@pytest.mark.parametrize("kind", SENSORS)
def test_a_sensor_of_the_configured_kind_shows_the_winding(kind: str, winding_c: float) -> None:
    shown_c, warnings = seen(kind, SENSORS[kind], winding_c)
    error_k = POINTS_ERROR_K if kind == "table" else 2.5
    assert shown_c == pytest.approx(winding_c, abs=error_k)
    assert warnings == {"NONE"}


@pytest.mark.parametrize("fault", ["open", "shorted"])
@pytest.mark.parametrize("kind", SENSORS)
def test_an_open_and_a_shorted_line_are_named(kind: str, fault: str) -> None:
    shown_c, warnings = seen(kind, SENSORS[kind], 60.0, fault)
    assert shown_c > 250.0
    assert "WINDING_SENSOR" in warnings


@pytest.mark.parametrize(
    ("kind", "fitted", "shown_c"),
    [
        ("pt1000", "ntc", None),
        ("pt1000", "kty84", None),
        ("kty84", "ntc", None),
        ("kty84", "pt1000", 115.0),  # 1 097 Ohm
        ("ntc", "pt1000", 97.2),  # 1/(1/298.15 + ln(0.1097)/3380) - 273.15
        ("ntc", "kty84", 123.3),  # 603 Ohm
    ],
)
def test_a_sensor_of_another_kind_is_named_where_no_whole_one_has_its_resistance(
    kind: str, fitted: str, shown_c: float | None
) -> None:
    """At 25 degC: elsewhere it is a motor that was hot at its restart, and cannot be known."""
    shown, warnings = seen(kind, SENSORS[fitted], 25.0)
    if shown_c is None:
        assert "WINDING_SENSOR" in warnings
    else:
        assert shown == pytest.approx(shown_c, abs=2.5)
        assert "WINDING_SENSOR" not in warnings


@pytest.mark.parametrize("fault", ["", "open", "shorted"])
def test_without_a_sensor_nothing_at_its_pin_is_a_finding(fault: str) -> None:
    _, warnings = seen("none", NTC, 60.0, fault)
    assert "WINDING_SENSOR" not in warnings
