"""Leader files: what is read, and the sentence every kind of bad file gets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files.leader import load_leader, save_leader
from greywhale.files.trajectory import POT_RANGE_RAD
from greywhale.loop import human_reaches, multi_steps

HEADER = "time_s,leader_0,leader_1,leader_2,leader_3\n"


def write(folder: Path, text: str) -> Path:
    path = folder / "leader.csv"
    path.write_text(text)
    return path


def test_saved_motion_comes_back(tmp_path: Path) -> None:
    motion = human_reaches(seed=3, duration_s=5.0)
    save_leader(tmp_path / "leader.csv", motion)
    read = load_leader(tmp_path / "leader.csv")
    np.testing.assert_allclose(read.time_s, motion.time_s, atol=1e-4)
    np.testing.assert_allclose(read.angles, motion.angles, atol=1e-5)
    assert [path.name for path in tmp_path.iterdir()] == ["leader.csv"]


def test_time_starts_at_the_first_row(tmp_path: Path) -> None:
    motion = load_leader(write(tmp_path, HEADER + "5.0,0,0,0,0\n5.5,0.1,0.2,0.3,0.4\n"))
    assert motion.time_s.tolist() == [0.0, 0.5]


def test_a_log_is_a_leader_file(tmp_path: Path) -> None:
    names = [*(f"{what}_{joint}" for what in ("leader", "follower", "voltage") for joint in range(4)), "state"]
    rows = ["# firmware 0.1.0", "time_s," + ",".join(names)]
    rows += [f"{time},0.1,0.2,0.3,0.4,9,9,9,9,9,9,9,9,following" for time in (0.0, 0.001)]
    motion = load_leader(write(tmp_path, "\n".join(rows) + "\n"))
    np.testing.assert_allclose(motion.angles, [[0.1, 0.2, 0.3, 0.4]] * 2)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (HEADER + "0,0,0,0,0\n", ["1 row of"]),
        (HEADER + "0,0,0,0,0\n1,0,0,0,0\n1,0,0,0,0\n", ["line 4", "time_s", "increase"]),
        (HEADER + "0,0,0,0,0\n1,0,0,0,2.41\n", ["line 3", "leader_3", "2.41 rad", "[-2.4, 2.4]"]),
        (HEADER + "0,0,0,0,0\n3601,0,0,0,0\n", ["line 3", "time_s", "3601 s is more than 3600 s"]),
        (HEADER + "0,0,0,0,0\n1,0,0,0,0\n1.003,0,1,0,0\n", ["line 4", "leader_1", "faster than 250 rad/s"]),
        (HEADER + "\n0,0,0,0,0\n1,0,-3.1,0,0\n", ["line 4", "leader_1", "-3.1 rad"]),
    ],
)
def test_bad_files_get_one_sentence(tmp_path: Path, text: str, parts: list[str]) -> None:
    path = write(tmp_path, text)
    with pytest.raises(UserError) as caught:
        load_leader(path)
    assert [part for part in (str(path), *parts) if part not in caught.value.message] == []


def test_the_largest_step_of_the_project_is_not_too_fast(tmp_path: Path) -> None:
    save_leader(tmp_path / "steps.csv", multi_steps([-POT_RANGE_RAD, POT_RANGE_RAD], [1.0, 1.0]))
    assert load_leader(tmp_path / "steps.csv").angles.max() == POT_RANGE_RAD
