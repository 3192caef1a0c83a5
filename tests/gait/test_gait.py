"""Gait files: what they hold, what ships, and values that do not fit each other."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from pydantic import ValidationError

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_SAMPLES
from mgs.core.shipped import shipped_folder
from mgs.gait import (
    BalanceGait,
    WalkGait,
    find_gait,
    list_gaits,
    load_gait,
    parse_gait,
)
from tests.support.strategies import (
    balance_gait,
    balances,
    constant,
    figure_eight,
    legal_gaits,
    sine,
    walk_gait,
)

NAMES = ["melson/walk_5cm", "melson/walk_30_steps", "melson/walk_practical", "melson/walk_fastest"]


@given(legal_gaits())
def test_a_gait_written_and_read_back_is_the_same(gait):
    assert parse_gait(gait.to_yaml(), "resolved") == gait


def test_a_written_gait_holds_every_default():
    tree = yaml.safe_load(walk_gait().to_yaml())
    assert list(tree) == ["mgs", "robot", "motion", "dt", "walk", "com", "ik"]
    for block in ("walk", "com", "ik"):
        assert set(tree[block]) == set(walk_gait().model_dump()[block])


def test_the_gaits_of_the_paper_ship():
    assert set(NAMES) <= set(list_gaits())


@pytest.mark.parametrize("name", list_gaits())
def test_every_shipped_gait_loads_by_name_and_by_path(name: str):
    assert load_gait(name) == load_gait(shipped_folder("gaits") / f"{name}.yaml")
    assert find_gait(name).is_absolute()


def test_a_file_of_the_user_hides_a_shipped_gait_of_the_same_name(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.yaml").write_text("mgs: 1\nmotion: walk\nwalk: {n_steps: 7}")
    assert load_gait("mine.yaml").walk.n_steps == 7


def test_gait_names_do_not_lead_out_of_the_shipped_folder():
    outside = shipped_folder("gaits").parent / "robots" / "melson" / "robot"
    assert outside.with_suffix(".yaml").is_file()
    with pytest.raises(ConfigError, match="no gait of that name"):
        find_gait("../robots/melson/robot")


@pytest.mark.parametrize(
    ("name", "gains"), [("s1", (0.0, 0.0)), ("s2", (1.0, 0.0)), ("s3", (0.35, 1.6))]
)
def test_the_scenarios_of_the_article_on_melson_have_its_settings(name: str, gains: tuple):
    """Section 5: two steps of 5 cm in 12 s at 0.01 s, gains gamma of three scenarios.

    Section 3 has one linear step per sample, Section 4.2 neither a task for the torso nor a
    minimization of torques in double support, Section 2 preview control without a second stage.
    """
    gait = load_gait(f"melson/{name}")
    walk, ik, com = gait.walk, gait.ik, gait.com
    assert (gait.dt, walk.n_steps, walk.step_length) == (0.01, 2, 0.05)
    assert (ik.solver, ik.gamma_joint, ik.gamma_grav) == ("clik", *gains)
    assert (ik.iterations, ik.torso, ik.double_support) == (0, "free", "off")
    assert ik.on_limit != "hold"  # Section 3.2: limits are avoided by the secondary task alone
    assert (com.generator, com.passes, walk.zmp_offset) == ("preview", 0, [0.0, 0.0])
    steps = walk.n_steps * (walk.double_support + walk.single_support) + walk.double_support
    assert walk.lead_in + steps + walk.lead_out == pytest.approx(12.0)


def test_the_scenarios_of_the_article_differ_in_their_gains_only():
    first = load_gait("melson/s1")
    for name, gains in {"s2": (1.0, 0.0), "s3": (0.35, 1.6)}.items():
        changed = (f"ik.gamma_joint={gains[0]}", f"ik.gamma_grav={gains[1]}")
        assert load_gait(first, changed) == load_gait(f"melson/{name}")


def test_walk_practical_takes_4_cm_in_at_most_0_8_s():
    walk = load_gait("melson/walk_practical").walk
    assert walk.step_length >= 0.04
    assert walk.single_support + walk.double_support <= 0.8


def test_a_gait_of_one_key_has_the_documented_defaults():
    gait = parse_gait("mgs: 1\nmotion: walk\nwalk: {n_steps: 2}", "a.yaml")
    assert gait.model_dump() == {
        "mgs": 1,
        "robot": None,
        "motion": "walk",
        "dt": 0.01,
        "walk": {
            "n_steps": 2,
            "steps": None,
            "footsteps": None,
            "goal": None,
            "sizes": "given",
            "step_length": 0.0,
            "lateral": 0.0,
            "step_yaw": 0.0,
            "step_width": None,
            "first_support": None,
            "last_support": None,
            "lead_in": 0.3,
            "double_support": 0.2,
            "single_support": 0.5,
            "lead_out": 0.3,
            "step_height": 0.02,
            "swing_profile": "minimum_jerk",
            "landing": 0.2,
            "foot_roll": None,
            "com_height": None,
            "leg_stretch": None,
            "com_tolerance": 2e-4,
            "zmp_offset": [0.0, 0.0],
            "zmp_travel": 0.0,
            "arm_swing": 0.0,
            "hands": "held",
            "boxes": [],
            "clearance": 0.005,
        },
        "com": {
            "generator": "qp",
            "preview": 1.6,
            "weight_error": 1.0,
            "weight_jerk": 1e-4,
            "margin": None,
            "passes": 3,
            "zmp_tolerance": 2e-4,
            "parameters": {},
        },
        "ik": {
            "solver": "clik",
            "gamma_joint": 0.35,
            "gamma_grav": 0.0,
            "gamma_grav_ramp": 0.2,
            "gamma_momentum": 0.0,
            "double_support": "shared",
            "iterations": None,
            "torso": "upright",
            "on_limit": "hold",
            "faraji": {
                "hard": ["soles", "torso", "hands"],
                "soft": {"com": [1.0, 1.0, 1.0]},
                "damping": 1e-4,
                "gamma": 10.0,
                "gamma_rows": "soft",
                "region": "ellipse",
                "speed_max": None,
                "margin": 0.0,
                "descent": "gauss_newton",
                "bent_start": None,
                "reserve": True,
                "posture_weight": None,
            },
            "prioritized": {
                "critical": ["soles", "com_xy"],
                "functional": ["hands"],
                "extraneous": ["torso", "com_z"],
                "null_space": "tracking",
                "catch_up": 0.5,
                "feedback": 0.5,
                "handover": 0.1,
            },
            "trajectory": {
                "start": "free",
                "weight_joint": 0.35,
                "weight_grav": 1.6,
                "weight_acceleration": 3e-5,
                "weight_limit": 0.003,
                "iterations": 20,
                "tolerance": 1e-3,
            },
            "parameters": {},
        },
    }


@pytest.mark.parametrize(
    ("key", "allowed", "refused"),
    [
        ("dt", [1e-4, 0.1], [0.9e-4, 0.101, 0.0, -0.01]),
        ("walk.n_steps", [1, 20_000], [0, 20_001]),
        ("walk.step_length", [-1.0, 1.0], [-1.001, 1.001]),
        ("walk.lateral", [-1.0, 1.0], [-1.001, 1.001]),
        ("walk.step_yaw", [-1.0, 1.0], [-1.001, 1.001]),
        ("walk.step_width", [1e-3, 2.0, None], [0.0, 2.01]),
        ("walk.lead_in", [1.6, 60.0], [0.0, 60.1]),
        ("walk.double_support", [1e-3, 60.0], [0.0, 60.1]),
        ("walk.single_support", [1e-3, 60.0], [0.0, 60.1]),
        ("walk.lead_out", [1.6, 60.0], [0.0, 60.1]),
        ("walk.step_height", [1e-3, 0.5], [0.0, 0.501]),
        ("walk.landing", [0.0, 0.5], [-1e-9, 0.501]),
        ("walk.com_height", [1e-3, 3.0, None], [0.0, 3.01]),
        ("walk.zmp_offset", [[1.0, -1.0]], [[1.001, 0.0], [0.0, -1.001], [0.0], [0.0, 0.0, 0.0]]),
        ("com.preview", [0.1, 1.8], [0.09, 10.1]),
        ("com.weight_error", [1e-300, 1e12], [0.0, 1.01e12]),
        ("com.weight_jerk", [1e-300, 1e6], [0.0, 1.01e6]),
        ("ik.gamma_joint", [0.0, 1e3], [-1e-9, 1001.0]),
        ("ik.gamma_grav", [0.0, 1e3], [-1e-9, 1001.0]),
        ("ik.gamma_grav_ramp", [1e-4, 10.0], [0.0, 10.1]),
        ("ik.iterations", [0, 50, None], [-1, 51]),
        ("ik.trajectory.weight_joint", [0.0, 1e3], [-1e-9, 1001.0]),
        ("ik.trajectory.weight_grav", [0.0, 1e3], [-1e-9, 1001.0]),
        ("ik.trajectory.weight_acceleration", [1e-9, 1e3], [0.0, 1001.0]),
        ("ik.trajectory.weight_limit", [0.0, 1e3], [-1e-9, 1001.0]),
        ("ik.trajectory.iterations", [0, 1000], [-1, 1001]),
        ("ik.trajectory.tolerance", [1e-12, 1.0], [0.0, 1.1]),
    ],
)
def test_every_number_has_its_range(key: str, allowed: list, refused: list):
    def read(value: object) -> None:
        steps = "walk.n_steps=2" if key != "dt" else "walk.n_steps=1"
        parse_gait("mgs: 1\nmotion: walk\nwalk: {}", "a", (steps, f"{key}={yaml_of(value)}"))

    for value in allowed:
        read(value)
    for value in refused:
        with pytest.raises(ConfigError, match=re.escape(key)):
            read(value)


def yaml_of(value: object) -> str:
    return yaml.safe_dump(value, default_flow_style=True).removesuffix("...\n").strip()


def test_a_gait_cannot_be_changed():
    gait = walk_gait()
    with pytest.raises(ValidationError, match="frozen"):
        gait.walk.n_steps = 3


# --- values that do not fit each other -------------------------------------------------------


def refusal(**blocks: object) -> str:
    tree = {"mgs": 1, "motion": "walk", "walk": {"n_steps": 2}} | blocks
    with pytest.raises(ConfigError) as caught:
        parse_gait(yaml.safe_dump(tree), "a.yaml")
    return str(caught.value)


def test_preview_control_is_refused_a_rest_at_the_end_shorter_than_its_window():
    message = refusal(com={"generator": "preview"}, walk={"n_steps": 2, "lead_out": 1.0})
    assert "walk.lead_out = 1 s is shorter than the preview window com.preview = 1.6 s" in message
    com = {"generator": "preview", "preview": 8.01}
    message = refusal(com=com, walk={"n_steps": 2, "lead_out": 8.0})
    assert "walk.lead_out = 8 s is shorter" in message


@pytest.mark.parametrize("generator", ["preview", "qp"])
def test_a_short_rest_at_the_start_is_enough(generator: str):
    gait = walk_gait(lead_in=0.1, lead_out=0.7, com={"generator": generator, "preview": 0.7})
    assert parse_gait(gait.to_yaml(), "a.yaml") == gait


def test_more_samples_than_fit_into_memory_are_refused_with_the_remedy():
    message = refusal(dt=1e-4, walk={"n_steps": 400, "single_support": 0.5})
    assert f"{MAX_SAMPLES:g} allowed" in message
    assert "walk.n_steps" in message
    assert walk_gait(dt=1e-4, n_steps=250).walk.n_steps == 250  # 1.8e6 samples


def test_a_single_step_that_would_go_somewhere_is_refused():
    for key in ("step_length", "lateral", "step_yaw"):
        assert "walk: n_steps = 1" in refusal(walk={"n_steps": 1, key: 0.01})
    assert walk_gait(n_steps=1).walk.n_steps == 1


# --- balance motions -------------------------------------------------------------------------

BALANCE = """
mgs: 1
motion: balance
balance:
  duration: 4.0
  channels:
    - {task: com_y, wave: sine, amplitude: 0.02, frequency: 0.5}
"""


def balance_refusal(*channels: object, **balance: object) -> str:
    tree = yaml.safe_load(BALANCE)
    tree["balance"] |= balance
    if channels:
        tree["balance"]["channels"] = list(channels)
    with pytest.raises(ConfigError) as caught:
        parse_gait(yaml.dump(tree, Dumper=NoAliases), "a.yaml")
    assert caught.value.exit_code == 2
    return str(caught.value).replace("a.yaml: ", "")


class NoAliases(yaml.SafeDumper):
    def ignore_aliases(self, data: object) -> bool:
        return True


@given(balances())
def test_a_balance_motion_written_and_read_back_is_the_same(gait: BalanceGait):
    again = parse_gait(gait.to_yaml(), "resolved")
    assert isinstance(again, BalanceGait)
    assert again == gait


def test_a_balance_motion_of_one_channel_has_the_documented_defaults():
    gait = parse_gait(BALANCE, "a.yaml")
    tree = gait.model_dump()
    assert list(tree) == ["mgs", "robot", "motion", "dt", "balance", "ik"]
    assert (tree["motion"], tree["dt"], tree["robot"]) == ("balance", 0.01, None)
    assert tree["ik"] == walk_gait().model_dump()["ik"]
    assert tree["balance"] == {
        "sizes": "given",
        "duration": 4.0,
        "rest": 0.5,
        "ease": 1.0,
        "com_height": None,
        "com_tolerance": 2e-4,
        "channels": [
            {"task": "com_y", "wave": "sine", "amplitude": 0.02, "frequency": 0.5, "phase": 0.0}
        ],
    }
    eight = {"wave": "figure_eight", "task": "com", "width": 0.1, "height": 0.1, "frequency": 1.0}
    assert balance_gait(eight).model_dump()["balance"]["channels"][0]["plane"] == "yz"


def test_the_motion_decides_what_kind_of_gait_it_is():
    assert isinstance(parse_gait(BALANCE, "a.yaml"), BalanceGait)
    assert isinstance(parse_gait("mgs: 1\nmotion: walk\nwalk: {n_steps: 2}", "a"), WalkGait)


def test_both_kinds_tell_the_room_of_the_com():
    walk = walk_gait(n_steps=3)
    assert walk.com_tolerance == balance_gait(sine("com_y", 0.02)).com_tolerance == 2e-4
    assert balance_gait(sine("com_y", 0.02), com_tolerance=0.1).com_tolerance == 0.1


@pytest.mark.parametrize(
    ("key", "allowed", "refused"),
    [
        ("duration", [3.01, 36_000.0], [0.0, -1.0, 36_001.0]),
        ("rest", [0.0, 0.9], [-0.1, 60.1]),
        ("ease", [1e-3, 1.4], [0.0, 60.1]),
        ("com_height", [1e-3, 3.0, None], [0.0, 3.01]),
        ("com_tolerance", [1e-9, 1.0], [0.0, 1.01]),
    ],
)
def test_every_number_of_a_balance_motion_has_its_range(key: str, allowed: list, refused: list):
    for value in allowed:
        dt = 0.1 if key == "duration" else 0.01
        assert (
            getattr(balance_gait(sine("com_y", 0.02), dt=dt, **{key: value}).balance, key) == value
        )
    for value in refused:
        assert balance_refusal(**{key: value}).startswith(f"balance.{key}: ")


@pytest.mark.parametrize(
    ("channel", "message"),
    [
        (
            sine("com_y", 2.01),
            "amplitude: input should be less than or equal to 2 [m] or [rad], found 2.01",
        ),
        (sine("com_y", 0.1, 0.0), "frequency: input should be greater than 0 [Hz], found 0.0"),
        (sine("com_y", 0.1, 20.1), "frequency: input should be less than or equal to 20 [Hz]"),
        (sine("com_y", 0.1, phase=10.1), "phase: input should be less than or equal to 10 [rad]"),
        (
            constant("com_y", -2.01),
            "value: input should be greater than or equal to -2 [m] or [rad], found -2.01",
        ),
        (constant("com", 0.1), "task: input should be 'com_x', 'com_y', "),
        (
            {"task": "com_x", "wave": "ramp", "value": 0.1, "start": -0.1, "end": 1.0},
            "start: input should be greater than or equal to 0 [s], found -0.1",
        ),
        (
            {"task": "com", "wave": "figure_eight", "plane": "yy", "width": 0.1, "height": 0.1,
             "frequency": 1.0},
            "plane: input should be 'xy', 'xz', 'yx', 'yz', 'zx' or 'zy', found 'yy'",
        ),
        (
            figure_eight("com_x", "yz", 0.1, 0.1),
            "task: input should be 'com', 'left_hand' or 'right_hand', found 'com_x'",
        ),
        ({"task": "com_x", "wave": "sine", "amplitude": 0.1}, "frequency: missing"),
        (sine("com_y", 0.1) | {"width": 0.1}, "width: unknown key; known here: amplitude, frequ"),
    ],
)  # fmt: skip
def test_a_bad_channel_is_named_by_its_number_and_key(channel: dict, message: str):
    told = balance_refusal(sine("com_x", 0.01), channel)
    assert told.startswith(f"balance.channels.1.{message}")


@pytest.mark.parametrize("end", [1.0, 0.5])
def test_a_ramp_that_ends_before_it_starts_is_refused(end: float):
    channel = {"task": "com_x", "wave": "ramp", "value": 0.1, "start": 1.0, "end": end}
    assert balance_refusal(channel) == (
        f"balance.channels.0: end = {end:g} s is not after start = 1 s"
    )


@pytest.mark.parametrize("duration", [2.0, 3.0])
def test_a_duration_without_room_between_the_ends_is_refused_with_the_remedy(duration: float):
    message = balance_refusal(duration=duration)
    assert message.startswith(f"balance: duration = {duration:g} s leaves no time for the motion")
    assert "2 (rest + ease) = 3 s; use a longer duration" in message


def test_no_channel_at_all_and_more_than_a_hundred_are_refused():
    assert "balance.channels: list should have at least 1 item" in balance_refusal(channels=[])
    many = [constant("com_x", 1e-6)] * 101
    assert "balance.channels: list should have at most 100 items" in balance_refusal(*many)
    assert len(balance_gait(*many[:100]).balance.channels) == 100


def test_more_samples_of_a_balance_motion_than_fit_into_memory_are_refused():
    tree = yaml.safe_load(BALANCE) | {"dt": 1e-4}
    tree["balance"]["duration"] = 201.0
    with pytest.raises(ConfigError, match=r"shorter balance\.duration") as caught:
        parse_gait(yaml.safe_dump(tree), "a.yaml")
    assert f"{MAX_SAMPLES:g} allowed" in str(caught.value)


def test_a_walk_block_has_no_place_in_a_balance_motion_nor_the_other_way_round():
    with pytest.raises(ConfigError) as caught:
        parse_gait(BALANCE + "walk: {n_steps: 2}\n", "a.yaml")
    assert "walk: unknown key; known here: balance, dt, ik, mgs, motion, robot" in str(caught.value)
    assert "com: unknown key" in refusal_of(BALANCE + "com: {preview: 1.0}\n")
    assert "balance: unknown key" in refusal(balance={"duration": 4.0})


def refusal_of(text: str) -> str:
    with pytest.raises(ConfigError) as caught:
        parse_gait(text, "a.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("faraji: {hard: [com]}", "ik.faraji: com is both a hard and a soft task"),
        ("faraji: {hard: []}", "ik.faraji: hard and soft need at least one task each"),
        (
            "faraji: {soft: {com_z: [1.0, 1.0, 1.0]}}",
            "ik.faraji.soft.com_z: input should be 'soles'",
        ),
        ("faraji: {soft: {com: [1.0, 1.0]}}", "ik.faraji.soft.com: list should have at least 3"),
        ("faraji: {soft: {com: [1.0, 1.0, 0.0]}}", "ik.faraji.soft.com.2: input should be greater"),
        ("prioritized: {critical: [com]}", "ik.prioritized: com_z is in two levels"),
        ("prioritized: {critical: [com_xy]}", "ik.prioritized: soles must be in critical"),
        ("prioritized: {feedbak: 0.3}", "ik.prioritized.feedbak: unknown key; did you mean 'feedb"),
    ],
)
def test_tasks_of_a_solver_that_do_not_fit_each_other_are_refused(block: str, message: str):
    assert f"a.yaml: {message}" in refusal_of(BALANCE + f"ik: {{{block}}}\n")
