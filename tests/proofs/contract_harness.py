# SPDX-License-Identifier: Apache-2.0
"""The C sources of a run of CBMC that proves the contracts of some functions (contracts.py).

One run takes one or more parts, a header with its sources. A number that CBMC chooses selects the
function to prove, so that one run proves all. Each part is one translation unit: it includes the
sources under proof, and calls of functions with a contract from elsewhere are renamed to
NAME_by_contract. Those are made here: they prove the preconditions, give any content to what the
function may write and any result, and assume the postconditions. A call of any other function
without a body is a failure of CBMC.
"""

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import contracts
import lemmas
from contracts import FIRMWARE, PROOFS, Contract, Parameter
from planted_errors import PlantedError

# What is proved together in one run: the functions of these headers, without HEAVY.
GROUPS: dict[str, tuple[str, ...]] = {
    "modes": ("modes/modes", "core/findings"),
    "pedals": ("config/demand_age", "pedals/pedals"),
    "monitor": ("monitor/monitor", "monitor/monitor_fast",
                "monitor/monitor_bus", "monitor/monitor_gain", "monitor/monitor_window",
                "monitor/monitor_current", "monitor/monitor_open",
                "monitor/monitor_stuck"),
    "recorder": ("app/recorder",),
    "controller": ("controller/angle_choice", "controller/bridge_choice",
                   "controller/current_expectation", "controller/temperatures"),
    "torque": ("torque/limit", "torque/lift_off", "torque/stop_lamp", "torque/foldback",
               "torque/demand", "torque/hill_hold", "torque/torque_command",
               "torque/hydraulic_model", "torque/torque_limits", "torque/closing_voltage",
               "core/fade"),
    "torque_models": ("motor/motor_model", "torque/hydraulic_feedback", "torque/road",
                      "torque/brake_blending", "torque/available_ahead", "motor/thermal_model",
                      "torque/charge_trim"),
}  # fmt: skip
# With `./tools/dev test --full` only: these groups, and one by one the functions of HEAVY.
FULL = (
    "recorder", "torque", "feasible_torque", "torque_init", "motor_model", "motor_constants",
    "heat_and_brake", "loss_braking", "speed_and_emf",
    "short", "safe_state", "shorted", "short_surges", "exit_fits",
    "grid", "map_row",
    "feasible_points", "feasible_parts", "available_ahead",
    "measure", "controller_init", "controller_slow", "controller_fast",
    "operating_point", "controller_ends", "black_box",
)  # fmt: skip
HEAVY: tuple[str, ...] = (
    "torque_limits_winding", "torque_limits_switch", "torque_limits_max_speed",
    "torque_limits_at_most", "torque_limits_tightest", "torque_limits_tightest_line",
    "lift_off_split", "monitor_open_step", "motor_model_x_of_i_q_b",
)  # fmt: skip
# Of these the postconditions are proved with arithmetic that wraps around, not that none overflows:
# their products and quotients of 64 bits are too hard for the solvers (SOUNDNESS.md, Values only).
VALUES: dict[str, tuple[str, ...]] = {
    "torque_limits_step": ("torque_limits_step",),
    "torque_limits_plain": ("torque_limits_plain",),
    "torque_bounds": (
        "torque_limits_ends", "torque_limits_drawn", "torque_limits_returned",
        "current_setpoint_step", "torque_limits_of",
    ),
    "brake_blending": ("brake_blending_step", "brake_blending_report"),
    "torque_step": ("torque_step",),
    "monitor_whole": ("monitor_step",),
    "torque_init": ("torque_init", "torque_hold", "torque_start_hold"),
    "feasible_torque": (
        "torque_command_step", "motor_model_at", "motor_model_around", "motor_model_move",
        "motor_model_point",
        "feasible_set_at", "feasible_set_around", "feasible_side_at",
        "feasible_magnitude_mNm", "feasible_power_b", "feasible_weaken_cap",
        "feasible_by_voltage_mNm", "feasible_by_voltage_and_current", "feasible_by_drawn_at",
        "feasible_by_returned_at", "feasible_forced", "feasible_by_current_mNm",
        "loss_maps_row_at", "loss_maps_torque_mNm", "loss_braking_at", "loss_braking_torque_mNm",
        "observer_error_explains", "observer_error_torque_mNm", "torque_uncertainty_mNm",
    ),
    "motor_model": (
        "motor_model_torque_mNm", "motor_model_bus_current_mA",
        "motor_model_switching_current_mA",
        "motor_model_airgap_b", "motor_model_x_of_airgap_b", "motor_model_airgap_per_x",
        "motor_model_airgap_per_d", "motor_model_x_per_d",
    ),
    "motor_constants": ("motor_constants_init",),
    "heat_and_brake": ("thermal_model_step", "hydraulic_model_step", "hydraulic_feedback_step"),
    "loss_braking": ("loss_braking_setpoint",),
    "speed_and_emf": (
        "monitor_emf_step", "monitor_speed_step", "monitor_bus_swings", "monitor_gain_step",
    ),
    # One by one: together they do not finish.
    "short": ("safe_state_short",),
    "safe_state": ("safe_state_step",),
    "shorted": ("safe_state_shorted",),
    "short_surges": ("safe_state_short_surges",),
    "exit_fits": ("short_exit_fits",),
    "grid": ("grid_interpolate", "grid_weights", "grid_weighted"),
    "map_row": ("loss_maps_row_rise_mA", "loss_maps_row_d_mA"),
    "feasible_points": ("feasible_holds", "feasible_excess_b", "feasible_point"),
    "feasible_parts": ("feasible_circle_d_b", "feasible_ellipse_root"),
    "available_ahead": ("available_ahead_step",),
    "controller_init": ("controller_init", "finding_times"),
    "controller_slow": ("controller_slow_step",),
    "measure": ("measure_init", "measure_step", "measure_setpoint"),
    "controller_fast": (
        "controller_fast_step", "controller_limits", "controller_temperatures",
        "controller_start_warm", "controller_warmest_cC", "controller_start_hold",
        "controller_hold",
    ),
    "operating_point": (
        "operating_point_init", "operating_point_rotor",
        "operating_point_of", "operating_point_setpoint", "operating_point_initial_setpoint",
    ),
    "controller_ends": (
        "controller_initial_setpoint", "controller_fast_report", "controller_fast_report_copy",
        "controller_fast_report_complete", "controller_fast_view",
    ),
    "black_box": ("recorder_init", "recorder_slow", "recorder_seal"),
}  # fmt: skip
# Each function of these groups has a run of its own: together they do not finish.
APART = ("feasible_torque", "feasible_points")
# Of core: not proved but tested with random and extreme inputs (test_contracts.py).
TESTED: tuple[str, ...] = (
    "q_scale", "q15_share_of", "scaled_multiply", "scaled_constant", "scaled_ratio", "scaled_root",
    "divide_by_thousand", "divide_by_million", "divide_by_billion",
)  # fmt: skip

# Sources of a part, where they are not the one of the header's name.
SOURCES = {
    "controller/controller": ("fast_step.c", "controller.c"),
    "monitor/monitor": ("monitor_fast.c", "monitor.c"),
    "monitor/monitor_fast": (),
    "motor/motor_model": ("motor_constants.c", "motor_model.c"),
    "motor/feasible_torque": (
        "feasible_torque.c",
        "feasible_circle.c",
        "feasible_power.c",
    ),
}
# Of core, as they are, where they have no contract.
CORE_SOURCES = ("angle", "drive_direction", "fault", "findings", "grid", "isqrt", "divide",
                "scaled", "words")  # fmt: skip
# Sources of functions without a contract that a part calls as they are.
BODIES = {
    "controller/controller": ("foc/report.c", "foc/sense.c"),
    "torque/torque_limits": ("config/pack_share.c",),
}
# Members that point to an object of their own.
POINTEES = {
    "motor_model_t": {"constants": "motor_constants_t", "config": "config_t"},
    "feasible_set_t": {"model": "motor_model_t"},
    "feasible_side_t": {"set": "feasible_set_t"},
    "recorder_t": {"memory": "recorder_memory_t"},
    "measured_t": {
        "report": "fast_report_t",
        "in": "slow_input_t",
        "battery": "battery_limits_t",
    },
}
CHECKS = (
    "--signed-overflow-check",
    "--undefined-shift-check",
    "--div-by-zero-check",
    "--bounds-check",
    "--pointer-check",
    "--unwinding-assertions",
)
# Of a loop; some functions have longer ones, as those that see the findings, and one has a shorter
# one whose passes the checker does not know as a constant.
UNWIND = 20
UNWIND_OF_TYPE = {"findings_t": 65, "controller_t": 65, "controller_slow_t": 65}
UNWIND_OF = {"finding_times": 65, "loss_braking_setpoint": 5,
             "recorder_init": 401, "recorder_slow": 70,
             "thermal_model_init": 34, "thermal_model_step": 34,
             "loss_maps_row_d_mA": 131, "loss_maps_row_rise_mA": 131}  # fmt: skip
OVERFLOW_CHECKS = ("--signed-overflow-check", "--undefined-shift-check")
CORE_HEADERS = tuple(path.name for path in sorted(FIRMWARE.glob("core/include/core/*.h")))


def only_values() -> list[str]:
    """Return the functions of which only the values are proved."""
    return [name for group in VALUES.values() for name in group]


def _replaceable(values: bool) -> dict[str, Contract]:
    """Return what is replaced where it is called.

    Pure modules have no globals: without a contract any result, and any content of what the
    parameters let a function write.
    """
    return contracts.known() | (contracts.without_promise() if values else {})


def functions_of(chosen: str) -> list[str]:
    """Return the functions of a group, or the one of that name."""
    if chosen in VALUES:
        return list(VALUES[chosen])
    if chosen not in GROUPS:
        return [contracts.known()[chosen].name]
    elsewhere = (*HEAVY, *TESTED, *only_values())
    return [one.name for one in contracts.known().values()
            if one.part in GROUPS[chosen] and one.name not in elsewhere]  # fmt: skip


def _include(header: Path) -> str:
    name = header.as_posix()
    return f'#include "{name.split("/include/")[1] if "/include/" in name else header.name}"'


def _unwind(name: str) -> int:
    given = [parameter.type for parameter in contracts.known()[name].parameters]
    return max(UNWIND_OF.get(name, UNWIND), *(UNWIND_OF_TYPE.get(kind, 0) for kind in given), 0)


def sources_of(part: str) -> list[Path]:
    """Return the sources under proof of a part."""
    module, own = part.split("/")
    paths = [FIRMWARE / module / name for name in SOURCES.get(part, (f"{own}.c",))]
    return [path for path in paths if path.is_file()]


def _declared(parameter: Parameter) -> str:
    const = "const " if parameter.const else ""
    if parameter.count:
        return f"{const}{parameter.type} {parameter.name}[{parameter.count}]"
    return f"{const}{parameter.type} {'*' if parameter.pointer else ''}{parameter.name}"


def _prototype(one: Contract) -> str:
    given = ", ".join(_declared(parameter) for parameter in one.parameters) or "void"
    return f"{one.result} {one.name}_by_contract({given})"


def _terms(clauses: Iterable[str]) -> list[str]:
    return [term.strip() for line in clauses for term in line.split("&&")]


def _linked(one: Contract) -> list[tuple[str, str, str]]:
    """Return holder, member and parameter where a precondition says that one points to the other.

    For example `set->model == model`, of two parameters.
    """
    kinds = {parameter.name: parameter.type for parameter in one.parameters}
    found = [re.fullmatch(r"(\w+)->(\w+) == (\w+)", term) for term in _terms(one.pre)]
    return [(match[1], match[2], match[3]) for match in found
            if match and match[3] in kinds and match[2] in POINTEES.get(kinds.get(match[1], ""), {})
            ]  # fmt: skip


def _copied(one: Contract) -> list[Parameter]:
    """Return the parameters that a substitute copies, writes and copies back.

    The checker takes long to follow a pointer to a member of a large object. What another
    parameter or the result points to is written where it is.
    """
    shared = {target for _, _, target in _linked(one)}
    shared |= {target for _, target in _same_pointers(one)}
    return [parameter for parameter in one.parameters
            if parameter.written and not parameter.count and parameter.name not in shared
            ]  # fmt: skip


def _definition(one: Contract) -> list[str]:
    """Return the head of a substitute, with the copies of what it may write."""
    copied = [parameter.name for parameter in _copied(one)]
    given = ", ".join(
        _declared(replace(parameter, name=f"to_{parameter.name}") if parameter.name in copied
                  else parameter) for parameter in one.parameters)  # fmt: skip
    lines = [f"{one.result} {one.name}_by_contract({given or 'void'})", "{"]
    for parameter in _copied(one):
        name = parameter.name
        lines += [f"    {parameter.type} copy_{name} = *to_{name};",
                  f"    {parameter.type} *const {name} = &copy_{name};"]  # fmt: skip
    return lines


class _Conditions:
    """Postconditions with what they take from before the call."""

    def __init__(self, post: Iterable[str]) -> None:
        self.olds: list[str] = []
        self.post = [re.sub(r"\bold\(((?:[^()]|\([^()]*\))*)\)", self._kept, line) for line in post]

    def _kept(self, match: re.Match[str]) -> str:
        self.olds.append(match[1])
        return f"old_{len(self.olds)}"

    def before(self) -> list[str]:
        return [f"    const __typeof__({old}) old_{n} = {old};"
                for n, old in enumerate(self.olds, 1)]  # fmt: skip


def _pointees(kind: str, path: str, object_name: str) -> list[str]:
    lines = []
    for member, inner in POINTEES.get(kind, {}).items():
        if inner == "config_t":
            lines.append(f"    {path}.{member} = &proof_config;")
            continue
        name = f"{object_name}_{member}"
        lines += [f"    {inner} {name};", *_pointees(inner, name, name)]
        lines.append(f"    {path}.{member} = &{name};")
    return lines


def _in_the_map(row: str) -> list[str]:
    """Return what lets a row point to two rows of a map, as loss_maps_row_at() does."""
    lines = [f"    ASSUME(row_fits({row}));"]
    for member in ("cold_lsb", "hot_lsb"):
        map_part = f"{row}_{member}"
        lines += [
            f"    int16_t {map_part}[2 * MOST_ROW_POINTS];",
            f"    ASSUME(every(i, 2 * MOST_ROW_POINTS, entry_holds({map_part}[i])));",
            f"    {row}.{member} = {map_part} + 2 * (MOST_ROW_POINTS - {row}.points);",
        ]
    return lines


def _argument(parameter: Parameter) -> list[str]:
    kind, name = parameter.type, parameter.name
    if parameter.count:
        return [f"    {kind} {name}[{parameter.count}];"]
    if not parameter.pointer:
        return [f"    {kind} {name};"]
    if kind == "config_t":
        return [f"    const config_t *const {name} = &proof_config;"]
    lines = [f"    {kind} {name}_object;"]
    lines += _pointees(kind, f"{name}_object", f"{name}_object")
    if kind == "loss_maps_row_t":
        lines += _in_the_map(f"{name}_object")
    return [*lines, f"    {kind} *const {name} = &{name}_object;"]


def harness(one: Contract) -> str:
    """Return a proof: any parameters that meet the preconditions, the call, what follows."""
    conditions = _Conditions(one.post)
    lines = [f"void prove_{one.name}(void)", "{"]
    for parameter in one.parameters:
        lines += _argument(parameter)
    lines += [f"    {holder}_object.{member} = {target};"
              for holder, member, target in _linked(one)]  # fmt: skip
    lines += [f"    ASSUME({line});" for line in one.pre]
    lines += conditions.before()
    call = f"{one.name}({', '.join(parameter.name for parameter in one.parameters)});"
    lines.append(
        f"    {call}" if one.result == "void" else f"    {one.result} const result = {call}"
    )
    lines += lemmas.assumed(one.name)
    lines += [f"    PROVE({line});" for line in conditions.post]
    lines.append(f'    CONTRACT_END("the end of {one.name} is reached");')
    return "\n".join([*lines, "}", ""])


def _same_pointers(one: Contract) -> list[tuple[str, str]]:
    """Return members of the result that a postcondition makes equal to a parameter, with it."""
    made = [re.fullmatch(r"result\.(\w+) == (&?[\w>-]+(?:\.\w+)?)", term)
            for term in _terms(one.post)]  # fmt: skip
    return [(match[1], match[2]) for match in made
            if match and match[1] in POINTEES.get(one.result, {})]  # fmt: skip


def with_a_chosen_index(condition: str) -> str:
    """Return a condition that is assumed, whose whole is some(): the solvers need no search."""
    if not condition.startswith("some("):
        return condition
    depth = [condition[:n].count("(") - condition[:n].count(")")
             for n in range(len("some("), len(condition))]  # fmt: skip
    return f"chosen_{condition}" if 0 not in depth else condition


def substitute(one: Contract, values: bool = False) -> str:
    """Return what replaces a function for its callers: any behaviour that the contract allows.

    values: without the preconditions of functions that are only tested.
    """
    conditions = _Conditions(one.post)
    lines = _definition(one)
    if not (values and one.name in TESTED):
        lines += [f"    PROVE({line});" for line in one.pre]
    lines += [f"    PROVE({parameter.name} == &proof_config);"
              for parameter in one.parameters if parameter.type == "config_t"]  # fmt: skip
    lines += conditions.before()
    for parameter in one.parameters:
        if parameter.written and parameter.count:
            lines += [
                f"    for (int at_{parameter.name} = 0; at_{parameter.name} < {parameter.count}; "
                f"at_{parameter.name}++) {{",
                f"        {parameter.type} any;",
                f"        {parameter.name}[at_{parameter.name}] = any;",
                "    }",
            ]
        elif parameter.written:
            lines += [
                f"    {parameter.type} any_{parameter.name};",
                *[f"    any_{parameter.name}.{member} = {parameter.name}->{member};"
                  for member in POINTEES.get(parameter.type, {})],
                f"    *{parameter.name} = any_{parameter.name};",
            ]  # fmt: skip
    if one.result != "void":
        lines += [f"    {one.result} result;"]
        lines += [f"    result.{member} = {target};" for member, target in _same_pointers(one)]
    assumed = [line for line in conditions.post if "each(" not in line]
    lines += [f"    ASSUME({with_a_chosen_index(line)});" for line in assumed]
    lines += [f"    *to_{parameter.name} = copy_{parameter.name};" for parameter in _copied(one)]
    if one.result != "void":
        lines.append("    return result;")
    return "\n".join([*lines, "}", ""])


def _core_includes() -> list[str]:
    return ['#include "proof.h"', *(f'#include "core/{name}"' for name in CORE_HEADERS),
            '#include "contract.h"', '#include "invariants.h"']  # fmt: skip


def with_calls_by_contract(source: str, names: Iterable[str]) -> str:
    """Return a C source in which calls of some functions, not their definitions, are renamed."""
    calls = re.compile(rf"(?m)^([ \t].*)\b({'|'.join(names)})\(")
    while calls.search(source):
        source = calls.sub(r"\1\2_by_contract(", source)
    return source


def _included(
    folder: Path, path: Path, others: list[Contract], planted: PlantedError | None
) -> str:
    errs = planted is not None and path == FIRMWARE / planted.source
    original = path.read_text(encoding="utf-8")
    text = lemmas.cut(path, FIRMWARE, original)
    if not others and not errs and text == original:
        return f'#include "{path}"'
    copy = folder / f"calls_{path.name}"
    if planted is not None and errs:
        assert text.count(planted.right) == 1, planted
        text = text.replace(planted.right, planted.wrong)
    if others:
        text = with_calls_by_contract(text, [one.name for one in others])
    copy.write_text(text, encoding="utf-8")
    return f'#include "{copy}"'


def _unit(folder: Path, part: str, names: list[str], planted: PlantedError | None) -> str:
    """Return the translation unit of a part: its sources and the proofs of its functions.

    Where only values are proved, calls of functions of the same sources are replaced as well.
    """
    values = names[0] in only_values()
    known = _replaceable(values)
    others = [one for one in known.values() if values and one.part == part and not one.inline]
    elsewhere = [one for one in known.values() if one.part != part]
    elsewhere = [one for one in elsewhere if not one.inline or one.part.startswith("core/")]
    lines = _core_includes()
    lines += [f"{_prototype(one)};" for one in elsewhere if one.part.startswith("core/")]
    lines += [f"#define {one.name} {one.name}_by_contract" for one in elsewhere]
    header = next(one.header for one in known.values() if one.part == part)
    lines += [_include(header), *(f"{_prototype(one)};" for one in others)]
    lines += [_included(folder, path, others, planted) for path in sources_of(part)]
    lines += [harness(known[name]) for name in names]
    return "\n".join([*lines, ""])


def _substitutes(names: Iterable[str], values: bool) -> str:
    known = _replaceable(values)
    replaced = [one for one in known.values() if not one.inline or one.part.startswith("core/")]
    headers = {one.header: None for one in replaced}
    lines = [*_core_includes(), "config_t proof_config;",
             "int proof_any_index;", *map(_include, headers)]  # fmt: skip
    lines += [substitute(one, values) for one in replaced]
    lines += [f"void prove_{name}(void);" for name in names]
    lines += ["void prove_all(void)", "{", "    any_configuration();", "    int any_index;",
              "    proof_any_index = any_index;", "    uint8_t which;"]  # fmt: skip
    lines.append("    switch (which) {")
    for number, name in enumerate(names):
        lines += [f"    case {number}:", f"        prove_{name}();", "        break;"]
    return "\n".join([*lines, "    default:", "        break;", "    }", "}", ""])


def _write_without_products(folder: Path, planted: PlantedError | None) -> None:
    """Write headers whose products are not interpreted, which are included in place of theirs."""
    for name in lemmas.PRODUCTS:
        text = (FIRMWARE / name).read_text(encoding="utf-8")
        if planted is not None and planted.source == name:
            assert text.count(planted.right) == 1, planted
            text = text.replace(planted.right, planted.wrong)
        copy = folder / name.split("/include/")[1]
        copy.parent.mkdir(exist_ok=True)
        copy.write_text(lemmas.without_products(text), encoding="utf-8")


def _write_inline(folder: Path, names: Iterable[str]) -> None:
    """Write headers of inline functions under proof that call others by their contracts."""
    known = contracts.known()
    for one in (known[name] for name in names if known[name].inline):
        text = one.header.read_text(encoding="utf-8")
        called = [other for other in known.values()
                  if not other.inline and re.search(rf"\b{other.name}\(", text)]  # fmt: skip
        if not called or not one.part.startswith("core/"):
            continue
        text = with_calls_by_contract(text, [other.name for other in called])
        end = text.rindex("#include")
        end = text.index("\n", end) + 1
        declared = "".join(f"{_prototype(other)};\n" for other in called)
        copy = folder / one.header.as_posix().split("/include/")[1]
        copy.parent.mkdir(exist_ok=True)
        copy.write_text(text[:end] + declared + text[end:], encoding="utf-8")


def command(
    folder: Path, names: list[str], ends: bool, planted: PlantedError | None = None
) -> list[str]:
    """Write the sources of a run into a folder and return CBMC's arguments.

    With `ends` the end of each harness is a check as well, which must fail. planted: an error to
    put into a source.
    """
    known = contracts.known()
    parts: dict[str, list[str]] = {}
    for name in names:
        parts.setdefault(known[name].part, []).append(name)
    values = names[0] in only_values()
    checks = [check for check in CHECKS if not values or check not in OVERFLOW_CHECKS]
    files = [folder / "substitutes.c"]
    files[0].write_text(_substitutes(names, values), encoding="utf-8")
    for part, own in parts.items():
        files.append(folder / f"{part.replace('/', '_')}.c")
        files[-1].write_text(_unit(folder, part, own, planted), encoding="utf-8")
    if set(names) & set(lemmas.LAWS):
        _write_without_products(folder, planted)
    _write_inline(folder, names)
    includes = [folder, PROOFS, *FIRMWARE.glob("*/include")]
    includes += [path for path in FIRMWARE.iterdir() if path.is_dir()]
    core = [FIRMWARE / "core" / f"{name}.c" for name in CORE_SOURCES]
    core = [path for path in core if f"core/{path.stem}" not in parts]
    core += [FIRMWARE / body for part in parts for body in BODIES.get(part, ())]
    return [
        "--function",
        "prove_all",
        *(f"-I{path}" for path in includes),
        *map(str, files),
        *map(str, core),
        *checks,
        *(f"--no{check[1:]}" for check in OVERFLOW_CHECKS if values),
        *(["-DCONTRACT_ENDS"] if ends else []),
        *(["--slice-formula"] if values else []),
        "--unwind",
        str(max(map(_unwind, names))),
        "--verbosity",
        "4",
    ]
