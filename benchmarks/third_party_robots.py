"""Third-party humanoids, URDF and MJCF: init, check, generate, validate, reasons of failures.

pip install "mgs[robots]"   installs the first two packages; the others are used if installed
python benchmarks/third_party_robots.py [-o DIR [--resume]] [--path SITE_PACKAGES] [NAME ...]

Every step is a command of mgs; no file is edited between the commands. Robots whose package is not
installed are named and skipped. Prints the Markdown table of docs/robots.md; the columns of the
engines show the replay with ideal servos and the one with PD servos, and the column `lab` in how
many of 20 random replays in MuJoCo the robot stays up with ideal and with PD servos. With
--resume, rows that an earlier run has left in DIR are printed as they are.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

DATA = "cmeel.prefix/share/example-robot-data/robots"
PLAYGROUND = "mujoco_playground/_src/locomotion"
FOURIER = "fourier_robot_descriptions/assets/urdf"
ROBOTS = {  # in the order of packages: example-robot-data, icub-models, fourier, others
    "TALOS": f"{DATA}/talos_data/robots/talos_reduced.urdf",
    "TALOS, fingers": f"{DATA}/talos_data/robots/talos_full_v2.urdf",
    "Romeo": f"{DATA}/romeo_description/urdf/romeo_small.urdf",
    "Romeo, fingers": f"{DATA}/romeo_description/urdf/romeo.urdf",
    "Unitree G1": f"{DATA}/g1_description/urdf/g1_29dof_rev_1_0.urdf",
    "Unitree G1, fingers": f"{DATA}/g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
    "Alexander, legs": f"{DATA}/alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf",
    "iCub (example-robot-data)": f"{DATA}/icub_description/robots/icub.urdf",
    "iCub 2.5": "share/iCub/robots/iCubGazeboV2_5/model.urdf",
    "iCub 2.7": "share/iCub/robots/iCubGazeboV2_7/model.urdf",
    "iCub Genova11": "share/iCub/robots/iCubGenova11/model.urdf",
    "Fourier GR1-T1": f"{FOURIER}/gr1t1.urdf",
    "Fourier GR1-T2, fingers": f"{FOURIER}/gr1t2_fourier_hand_6dof.urdf",
    "Fourier GR2": f"{FOURIER}/gr2t2.urdf",
    "Fourier GR3": f"{FOURIER}/gr3.urdf",
    "Qinglong": f"{FOURIER}/qinglong.urdf",
    "JVRC-1": "jvrc_description/urdf/jvrc1.urdf",
    "ARMAR-4": "armar/description/urdf/armar4.urdf",
    "Unitree G1 (mjlab)": "mjlab/asset_zoo/robots/unitree_g1/xmls/g1.xml",
    "Unitree G1 (holosoma)": "holosoma/data/robots/g1/g1_29dof.xml",
    "Booster T1 (holosoma)": "holosoma/data/robots/t1/t1_29dof.xml",
    "Apptronik Apollo": f"{PLAYGROUND}/apollo/xmls/scene_mjx_feetonly_flat_terrain.xml",
    "Berkeley Humanoid": f"{PLAYGROUND}/berkeley_humanoid/xmls/scene_mjx_feetonly_flat_terrain.xml",
    "Unitree G1 (playground)": f"{PLAYGROUND}/g1/xmls/scene_mjx_feetonly_flat_terrain.xml",
    "Unitree H1": f"{PLAYGROUND}/h1/xmls/scene_mjx_feetonly.xml",
    "ROBOTIS OP3": f"{PLAYGROUND}/op3/xmls/scene_mjx_feetonly.xml",
    "Booster T1 (playground)": f"{PLAYGROUND}/t1/xmls/scene_mjx_feetonly_flat_terrain.xml",
    "Humanoid (dm_control)": "dm_control/suite/humanoid.xml",
    "Humanoid CMU (dm_control)": "dm_control/suite/humanoid_CMU.xml",
    "Humanoid CMU, walker": "dm_control/locomotion/walkers/assets/humanoid_CMU_V2020.xml",
    "Humanoid (gymnasium)": "gymnasium/envs/mujoco/assets/humanoid.xml",
    "Humanoid (brax)": "brax/envs/assets/humanoid.xml",
    "simple_humanoid": f"{DATA}/simple_humanoid_description/urdf/simple_humanoid.urdf",
    "human": f"{DATA}/human_description/robots/human.urdf",
    "Alex, upper body": f"{DATA}/alex_description/urdf/alex_nub_hands.urdf",
    "ARMAR-6": "armar/description/urdf/armar6.urdf",
    "TIAGo": f"{DATA}/tiago_description/robots/tiago.urdf",
    "ANYmal": f"{DATA}/anymal_b_simple_description/robots/anymal.urdf",
    "Bolt": f"{DATA}/bolt_description/robots/bolt.urdf",
    "Cassie": f"{DATA}/cassie_description/robots/cassie_v2.sdf",
}
COLUMNS = ("joints", "mass", "sole", "walk", "PyBullet", "MuJoCo", "lab", "verdict")
COMMAND = [sys.executable, "-c", "from mgs.cli import main; main()"]


def main() -> None:
    """Run all robots and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="names of robots; default: all")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        help="folder for robot folders and motions; default: a temporary one",
    )
    parser.add_argument("--draws", type=int, default=20, help="random replays; 0: none")
    parser.add_argument("--resume", action="store_true", help="keep the rows of an earlier run")
    parser.add_argument("--path", type=Path, action="append", default=[], help="folder of packages")
    arguments = parser.parse_args()
    folders = [*arguments.path, *(Path(entry) for entry in sys.path if entry)]
    print(f"| robot | {' | '.join(COLUMNS)} |\n| --- | ---: | ---: |{' --- |' * 6}")
    with tempfile.TemporaryDirectory() as scratch:
        output = arguments.output or Path(scratch)
        for name in arguments.names or ROBOTS:
            cells = row(name, folders, output, arguments)
            print(f"| {name} | {' | '.join(cells)} |", flush=True)


def row(name: str, folders: list[Path], output: Path, arguments: argparse.Namespace) -> list[str]:
    """Table cells of a robot, from an earlier run or a new one."""
    kept = output / "rows" / f"{name}.json"
    if arguments.resume and kept.is_file():
        return list(json.loads(kept.read_text()))
    source = find(ROBOTS[name], folders)
    if source is None:
        return [*[""] * (len(COLUMNS) - 1), "not installed"]
    cells = walked(source, output / name, arguments.draws)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(cells))
    return cells


def find(path: str, folders: list[Path]) -> Path | None:
    """Path of a file in the first folder that contains it, or in one of their parent folders."""
    for folder in folders:
        for root in (folder, *list(folder.parents)[:3]):
            if (root / path).is_file():
                return root / path
    return None


def walked(urdf: Path, folder: Path, draws: int) -> list[str]:
    """Table cells of one robot: joints, mass, sole, walk, engines, verdict."""
    code, text = run("robot", "init", str(urdf), "-o", str(folder), "--force", "--json")
    if code:
        return [*[""] * (len(COLUMNS) - 1), f"refused: {reason(text, urdf)}"]
    found = json.loads(text)
    joints = json.loads(run("robot", "show", str(folder), "--json")[1])["joints"]
    length, width = found["soles"]["left"]
    cells = [str(len(joints)), f"{found['mass']:.1f} kg", f"{1e3 * length:.0f} x {1e3 * width:.0f}"]
    _, text = run("robot", "check", str(folder), "--json")
    unsound = [f["name"] for f in json.loads(text)["findings"] if not f["ok"]]
    told = f"check: {', '.join(unsound)}; " if unsound else ""
    motion = folder / "walk.mcap"
    code, text = run("generate", "walk", "--robot", str(folder), "-o", str(motion), "--force")
    if code:
        return [*cells, "", "", "", "", f"{told}not generated: {reason(text, urdf)}"]
    return [*cells, *validated(motion, told, draws)]


def validated(motion: Path, told: str, draws: int) -> list[str]:
    """Table cells of a motion: walk, engines, random replays, verdict."""
    _, text = run("validate", str(motion), "--json")
    if not text.startswith("{"):
        return ["", "", "", "", f"{told}not simulated: {reason(text, motion)}"]
    verdict = json.loads(text)
    fates: dict[str, list[str]] = {}
    for replay in verdict["replays"]:  # ideal servos, then PD servos
        fates.setdefault(replay["engine"], []).append(fate(replay))
    planned = verdict["replays"][0]["planned_distance"][0] if verdict["replays"] else 0.0
    failed = [
        f"{c['name']} {c['value']:.3g} of {c['limit']:.3g} {c['unit']} ({c['where']})"
        for c in verdict["checks"]
        if not c["ok"]
    ]
    end = "passes" if not failed else f"fails: {'; '.join(failed)}"
    engines = [" / ".join(fates.get(engine, [])) for engine in ("pybullet", "mujoco")]
    kinds = ("ideal", "pd") if draws else ()
    drawn = " / ".join(survivals(motion, servo, draws) for servo in kinds)
    return [f"{planned:.2f} m", *engines, drawn, f"{told}{end}"]


def survivals(motion: Path, servo: str, draws: int) -> str:
    """Number of random replays in which the robot stays up."""
    options = ["--physics", "mujoco", "--servo", servo, "--ranges", "lab"]
    _, text = run("validate", str(motion), "--json", "--monte-carlo", str(draws), *options)
    return f"{json.loads(text)['monte_carlo']['survived']}" if text.startswith("{") else "none"


def fate(replay: dict[str, float]) -> str:
    """Result of a replay: stays up, or the time of the fall."""
    return f"fell at {replay['fall_time']:.1f} s" if replay["fell"] else "stays up"


def run(*arguments: str) -> tuple[int, str]:
    """Exit code and output of an mgs command; its error messages if it failed."""
    done = subprocess.run([*COMMAND, *arguments], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout or done.stderr


def reason(text: str, file: Path) -> str:
    """Message of a failed command, without file names."""
    lines = [line for line in text.splitlines() if line.startswith("Error:")]
    message = (lines or text.splitlines() or ["no message"])[-1].removeprefix("Error:").strip()
    return message.replace(f"{file}: ", "").replace("|", "/")


if __name__ == "__main__":
    main()
