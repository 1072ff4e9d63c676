"""Links of `greywhale arm new` against MuJoCo, which works mass and moments out from shapes by itself."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from greywhale.arm.make.body import Body, Section, bar, tube, uniform, with_parts

LENGTH, DENSITY, PARTS, AT = 0.14, 2700.0, 0.12, 0.11
POINT_M = 1e-4


def by_mujoco(geoms: str) -> tuple[float, float, list[float]]:
    """Mass, centre along x and principal moments, sorted, of a body of these shapes."""
    xml = f"<mujoco><worldbody><body><freejoint/>{geoms}</body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    return float(model.body_mass[1]), float(model.body_ipos[1, 0]), sorted(model.body_inertia[1])


def same(body: Body, mass: float, centre: float, moments: list[float]) -> None:
    assert body.mass == pytest.approx(mass)
    assert body.centre == pytest.approx(centre)
    assert sorted([body.along, body.about_height, body.about_width]) == pytest.approx(moments, rel=1e-4)


def made(section: Section, parts: float) -> Body:
    body = uniform(section, LENGTH, DENSITY * section.area * LENGTH)
    return with_parts(body, parts, AT) if parts else body


def cylinder(diameter: float) -> str:
    return (
        f'<geom type="cylinder" size="{diameter / 2} {LENGTH / 2}" pos="{LENGTH / 2} 0 0" euler="0 90 0" '
        f'density="{DENSITY}"/>'
    )


@pytest.mark.parametrize("parts", [0.0, PARTS])
def test_bars_and_rods_with_parts(parts: float) -> None:
    point = f'<geom type="sphere" size="{POINT_M}" pos="{AT} 0 0" mass="{parts}"/>' if parts else ""
    box = f'<geom type="box" size="{LENGTH / 2} 0.005 0.015" pos="{LENGTH / 2} 0 0" density="{DENSITY}"/>'
    same(made(bar(0.03, 0.01), parts), *by_mujoco(box + point))
    same(made(tube(0.025, 0.0125), parts), *by_mujoco(cylinder(0.025) + point))


def test_a_tube_is_a_rod_less_a_rod() -> None:
    outer, inner = by_mujoco(cylinder(0.025)), by_mujoco(cylinder(0.021))
    moments = [float(one) for one in np.subtract(outer[2], inner[2])]
    same(made(tube(0.025, 0.002), 0.0), outer[0] - inner[0], LENGTH / 2, sorted(moments))
