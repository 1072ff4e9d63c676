"""Links as bodies agree with the sum over many small pieces, motors with the values of their data sheets."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from greywhale.arm.make.body import Body, Section, bar, tube, uniform, with_parts
from greywhale.arm.make.motor import DataSheet, contradiction, tables
from greywhale.arm.parameters import ArmParameters
from greywhale.files.arm import default_arm

LENGTH, DENSITY = 0.14, 2700.0
FINE = 400


def pieces(width: float, height: float, inside: np.ndarray | None = None) -> np.ndarray:
    """(n, 2) m: the middles of small squares of a section, those that are inside."""
    across, up = np.meshgrid(*((np.arange(FINE) + 0.5) / FINE - 0.5,) * 2)
    points = np.column_stack([width * across.ravel(), height * up.ravel()])
    return points if inside is None else points[inside]


def summed(points: np.ndarray, area: float) -> Body:
    """The body of which these are the pieces of every section, by summing up."""
    along = (np.arange(FINE) + 0.5) / FINE * LENGTH
    mass = DENSITY * area * LENGTH
    width2, height2 = (points**2).mean(axis=0)
    slender = ((along - LENGTH / 2) ** 2).mean()
    return Body(mass, LENGTH / 2, mass * (width2 + height2), mass * (slender + width2), mass * (slender + height2))


def same(one: Body, other: Body, rel: float) -> None:
    for name in ("mass", "centre", "along", "about_height", "about_width"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=rel), name


def made(section: Section) -> Body:
    return uniform(section, LENGTH, DENSITY * section.area * LENGTH)


def test_a_bar() -> None:
    same(made(bar(0.03, 0.01)), summed(pieces(0.03, 0.01), 0.03 * 0.01), 2e-5)


@pytest.mark.parametrize("wall", [0.002, 0.005, 0.0125])
def test_a_tube_and_a_rod(wall: float) -> None:
    square = pieces(0.025, 0.025)
    radius = np.hypot(*square.T)
    ring = square[(radius <= 0.0125) & (radius >= 0.0125 - wall)]
    same(made(tube(0.025, wall)), summed(ring, len(ring) / FINE**2 * 0.025**2), 2e-2)
    assert tube(0.025, 0.0125).area == pytest.approx(np.pi * 0.0125**2)


def test_parts_move_the_centre_and_add_by_their_distance_from_it() -> None:
    link = made(tube(0.02, 0.001))
    loaded = with_parts(link, 0.2, 0.12)
    assert loaded.mass == pytest.approx(link.mass + 0.2)
    about_joint = link.about_width + link.mass * link.centre**2 + 0.2 * 0.12**2
    assert loaded.about_width + loaded.mass * loaded.centre**2 == pytest.approx(about_joint)
    assert loaded.mass * loaded.centre == pytest.approx(link.mass * link.centre + 0.2 * 0.12)
    assert loaded.along == link.along


SHEET = DataSheet(12.0, 100.0, 1.5, 2.0, 6.0, 0.1, 5e-7)


def with_motor(sheet: DataSheet) -> ArmParameters:
    data = default_arm().model_dump()
    data["joint"][0].update(tables(sheet))
    return ArmParameters.model_validate(data, strict=False)


@given(st.floats(0.05, 20.0), st.floats(0.2, 20.0), st.floats(0.1, 60.0), st.floats(0.01, 0.3), st.floats(1.0, 500.0))
def test_the_data_sheets_line_is_kept(torque: float, current: float, speed: float, idle: float, ratio: float) -> None:
    assume(contradiction(torque, current, speed, 12.0) == "")
    sheet = DataSheet(12.0, ratio, torque, current, speed, idle * current, 5e-7)
    arm = with_motor(sheet)
    actuator, friction = arm.actuator(0), arm.joint[0].friction
    assert actuator.torque_per_volt * 12.0 - friction.coulomb == pytest.approx(torque)
    assert (actuator.torque_per_volt * 12.0 - friction.coulomb) / actuator.damping == pytest.approx(speed)
    assert friction.coulomb == pytest.approx(idle * torque)
    assert actuator.inertia == pytest.approx(5e-7 * ratio**2)
    assert arm.joint[0].motor.viscous >= 0.0


def test_an_unknown_rotor_is_as_quick_as_usual_motors() -> None:
    actuator = with_motor(DataSheet(12.0, 100.0, 1.5, 2.0, 6.0, 0.1)).actuator(0)
    assert actuator.inertia / actuator.damping == pytest.approx(0.02)


def test_the_winding_is_that_of_the_stall_current() -> None:
    """Where back-EMF leaves room for it, the resistance is voltage by stall current."""
    assert with_motor(SHEET).joint[0].motor.resistance == pytest.approx(12.0 / 2.0)


def test_more_power_out_than_in_is_told() -> None:
    told = contradiction(1.5, 2.0, 2 * np.pi, 1.5)
    assert "stall torque x no-load speed is 9.42 W, more than voltage x stall current = 3 W" in told
