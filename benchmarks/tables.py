"""Markdown tables of the results of `run.py`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

MINIMUM_MEDIAN = ("minimum", "median")
MEMORY_BOUND = 500  # [MB] largest memory of a walk of 160 000 samples
NAMES = {  # labels of results in the tables
    "with the gravity task": "with gravity task",
    "without": "without gravity task",
    "its imports": "imports of mgs generate",
    "python alone": "python without imports",
}


def report(figures: dict[str, Any]) -> str:
    """All tables, in the order of the measurements."""
    machine = figures["machine"]
    head = (
        f"{machine['cores']} cores, {machine['architecture']}, Python {machine['python']}, "
        f"NumPy {machine['numpy']}, SciPy {machine['scipy']}, Pinocchio {machine['pin']}."
    )
    sections = [
        head,
        _ik(figures),
        _stages(figures),
        _command(figures),
        _growth(figures),
        _placo(figures["placo"]),
    ]
    return "\n\n".join(section for section in sections if section)


def table(header: list[str], rows: Iterable[list[str]]) -> str:
    """Markdown table; the first column is left-aligned, all others are right-aligned."""
    rule = ["---", *["---:"] * (len(header) - 1)]
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, rule, *rows])


def _us(seconds: float) -> str:
    return f"{1e6 * seconds:.1f}"


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.1f}"


def _ik(figures: dict[str, Any]) -> str:
    rows, ik = [], figures["ik"]
    for name, found in ik.items():
        for label, key in (
            ("CPU time of a run / samples", "per_run"),
            ("single steps", "step"),
            ("single steps in which it is active", "gravity_step"),
        ):
            times = found[key]
            if times is not None:
                cells = [_us(times[k]) for k in ("least", "median", "p99")]
                rows.append([f"{NAMES[name]}: {label}", *cells])
    for label, key in (
        ("kinematics and Jacobians", "kinematics"),
        ("gravity derivative", "gravity"),
    ):
        times = ik["without"][key]
        cells = [_us(times[k]) for k in ("least", "median", "p99")]
        rows.append([f"Pinocchio in a single step: {label}", *cells])
    title = f"IK step on {figures['walk']} [us]"
    return f"{table([title, 'minimum', 'median', 'p99'], rows)}\n\n{_shares(ik)}"


def _shares(ik: dict[str, Any]) -> str:
    """Ratios of the medians of single steps, which are measured alternately."""
    found = ik["without"]
    kinematics, gravity = found["kinematics"]["median"], found["gravity"]["median"]
    plain, heavy = found["step"]["median"], ik["with the gravity task"]["gravity_step"]["median"]
    return (
        f"Ratios of medians: Pinocchio takes {kinematics / plain:.0%} of a single step without "
        f"gravity task and {(kinematics + gravity) / heavy:.0%} of a single step with gravity "
        f"task. A step with gravity task takes {heavy / plain:.2f} times as long as one without it."
    )


def _stages(figures: dict[str, Any]) -> str:
    found = figures["stages"]
    n = found["samples"]
    rows = [
        [name, _ms(t["least"]), _ms(t["median"]), _us(t["median"] / n)]
        for name, t in found["seconds"].items()
    ]
    title = f"stage, {figures['walk']}, {n} samples, {found['bytes'] / 1e6:.1f} MB"
    return table([title, "minimum [ms]", "median [ms]", "per sample [us]"], rows)


def _command(figures: dict[str, Any]) -> str:
    found = figures["command"]
    whole = found["mgs generate"]["cpu"]["median"]
    rows = []
    for name, times in found.items():
        wall, cpu = times["wall"], times["cpu"]
        share = f"{cpu['median'] / whole:.0%}"
        cells = [*(_ms(t[k]) for t in (wall, cpu) for k in ("least", "median")), share]
        rows.append([NAMES.get(name, name), *cells])
    wall_and_cpu = [f"{time}, {value} [ms]" for time in ("wall", "CPU") for value in MINIMUM_MEDIAN]
    return table([f"process, {figures['walk']}", *wall_and_cpu, "share of CPU time"], rows)


def _growth(figures: dict[str, Any]) -> str:
    runs = figures["growth"]
    if not runs:
        return ""
    names = [name for name in runs[0]["seconds"] if name != "total"]
    rows = []
    for run in runs:
        per_sample = [_us(run["seconds"][name] / run["samples"]) for name in names]
        memory = [f"{run[key] / 1e6:.0f}" for key in ("bytes_before", "bytes_peak", "bytes_file")]
        total = f"{run['seconds']['total']:.1f}"
        rows.append([str(run["n_steps"]), str(run["samples"]), *per_sample, total, *memory])
    stages = [f"{name.replace('_', ' ')} [us]" for name in names]
    memory = ["memory after imports [MB]", "peak memory [MB]", "file size [MB]"]
    first = f"number of steps, {figures['long_walk']}"
    header = [first, "samples", *stages, "total [s]", *memory]
    peak = max(run["bytes_peak"] for run in runs) / 1e6
    verdict = "below" if peak < MEMORY_BOUND else "ABOVE"
    return (
        f"{table(header, rows)}\n\nTimes of the stages are per sample, from one run each. The "
        "largest "
        f"peak memory is {peak:.0f} MB, {verdict} the bound of {MEMORY_BOUND} MB."
    )


def _placo(found: dict[str, Any] | None) -> str:
    if found is None:
        return "placo was not measured; use --placo-python with an interpreter that has it."
    times, ratios = {"mgs, without gravity task": found["mgs"]}, [1.0]
    for name, placo in found["placo"].items():
        times[f"placo {found['version']}, {name}"] = placo
        ratios.append(found["ratio"][name])
    rows = [
        [name, _us(t["least"]), _us(t["median"]), f"{ratio:.2f}"]
        for (name, t), ratio in zip(times.items(), ratios, strict=True)
    ]
    ratio_column = "time of mgs / time in this row"
    header = ["mean IK step of a run, CPU time [us]", "minimum", "median", ratio_column]
    return (
        f"{table(header, rows)}\n\nLargest errors of placo after a step: CoM "
        f"{1e6 * found['com_error']:.1f} um, feet {1e6 * found['foot_error']:.1f} um."
    )
