"""Sections 1 and 2: what is no result, the arm, and its schematics."""

from __future__ import annotations

from greywhale.files.arm import load_arm
from greywhale_paper.pages.document import Chapter, Entry, Picture, Row, Sheet, Status, words
from greywhale_paper.pages.printed import TABLE_3
from greywhale_paper.pictures import diagrams

REMARKS = {
    "Iyy0": "No body has this: Iyy is at most Ixx + Izz. 8.26e-5 is taken.",
    "Iyy2": "The least of a slender link is expected about x: perhaps a mix-up of axes. As printed.",
    "Iyy3": "The matrix does not depend on the roll angle, so Iyy3 and Izz3 are averaged in the equations.",
}


def chapter() -> Chapter:
    """Table 1, Figs. 1 to 3, Table 3."""
    arm = load_arm("white_box")
    rows = []
    for symbol, means, value, unit, link, attribute in TABLE_3:
        known = arm.link[link]
        used = getattr(known.inertia if attribute in ("xx", "yy", "zz") else known, attribute)
        rows.append(Row(symbol, (means, f"{value:.4g}", f"{used:.4g}", unit, REMARKS.get(symbol, ""))))
    rows.append(Row("M", ("mass at the tip", "0", f"{arm.tip.mass:.4g}", "kg", "")))
    rows.append(Row("g", ("gravity", "9.81", f"{arm.gravity:.4g}", "m/s²", "")))
    table_3 = Sheet(
        ("symbol", "parameter", "printed", "used here", "unit", "remark"),
        rows,
        (2,),
        ("The paper prints kg/m² as the unit of inertia; kg m² is meant.",),
    )
    return Chapter(
        "Sections 1 and 2: the arm",
        (
            Entry(
                "Table 1",
                "Scientific contributions that apply optimisation algorithms",
                Status.OPEN,
                (words("A survey of twenty publications. It holds no number that could be computed."),),
            ),
            Entry(
                "Fig. 1",
                "Prototype of the arm",
                Status.OPEN,
                (words("A photograph of the authors' hardware, which exists once. The bench stands in its place."),),
            ),
            Entry(
                "Fig. 2",
                "Schematic diagram of the system",
                Status.DRAWN,
                (Picture(diagrams.system(), "What is joined to what, in the paper and on the bench alike."),),
            ),
            Entry(
                "Fig. 3",
                "The follower in two dimensions",
                Status.DRAWN,
                (
                    Picture(
                        diagrams.arm(),
                        "The links of Table 3 to scale; filled dots are centres of mass, rings are joints.",
                    ),
                ),
            ),
            Entry("Table 3", "Physical characteristics of the follower", Status.COMPUTED, (table_3,)),
        ),
    )
