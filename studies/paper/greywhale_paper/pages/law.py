"""Section 4: the controller, its sets, rules and surface."""

from __future__ import annotations

from greywhale.fuzzy.rules import RULES
from greywhale_paper.pages.document import Chapter, Entry, Picture, Row, Sheet, Status, words
from greywhale_paper.pictures import curves, diagrams
from greywhale_paper.work.errata import surface
from greywhale_paper.work.motions import printed

# Table 6 in the paper's order: e, ce, u.
TABLE_6 = (
    ("NE", "NCE", "NU"),
    ("NE", "ZCE", "NU"),
    ("NE", "PCE", "ZU"),
    ("ZE", "NCE", "NU"),
    ("ZE", "ZCE", "ZU"),
    ("ZE", "PCE", "PU"),
    ("PE", "NCE", "ZU"),
    ("PE", "ZCE", "PU"),
    ("PE", "PCE", "PU"),
)


def chapter() -> Chapter:
    """Figs. 9 to 13, Table 6, and the control surface."""
    before, after = printed("before_tuning"), printed("table_10")
    rules = [Row(f"if e is {e} and ce is {ce}", (u, RULES[e][ce])) for e, ce, u in TABLE_6]
    same = sum(row.cells[0] == row.cells[1] for row in rules)
    return Chapter(
        "Section 4: the controller",
        (
            Entry(
                "Fig. 9",
                "Fuzzy PD + I control structure",
                Status.DRAWN,
                (Picture(diagrams.law(), "Eq. 18; Δ is the difference from the period before."),),
            ),
            Entry(
                "Fig. 10",
                "Overall control scheme",
                Status.DRAWN,
                (Picture(diagrams.scheme(), "Four controllers in joint space, one a joint."),),
            ),
            Entry(
                "Fig. 11",
                "Membership functions before tuning",
                Status.COMPUTED,
                (
                    Picture(
                        curves.sets_before(before),
                        "The same on all joints; the output's triangles are as good as singletons.",
                    ),
                    words(
                        "The paper gives no feet of NE and PE. They are taken to be at 0: then the sets before tuning "
                        "add up to 1 everywhere, and some rule fires at every point (see the last part)."
                    ),
                ),
            ),
            Entry(
                "Fig. 12",
                "Tuneable parameters of the input sets",
                Status.DRAWN,
                (
                    Picture(
                        curves.tuneable(), "Dots are the eight corners of a joint; the arrows show Table 7's bounds."
                    ),
                ),
            ),
            Entry(
                "Fig. 13",
                "Leader–follower closed loop",
                Status.DRAWN,
                (Picture(diagrams.closed_loop(), "The loop that a search simulates for each candidate."),),
            ),
            Entry(
                "Table 6",
                "Rule base",
                Status.COMPUTED,
                (
                    Sheet(("rule", "printed", "firmware"), rules, (1,)),
                    words(f"{same} of {len(rules)} rules of the firmware are the printed ones."),
                ),
            ),
            Entry(
                "",
                "Control surface of joint 0",
                Status.OURS,
                (
                    Picture(
                        curves.surfaces({"before tuning": surface(before, 0), "Table 10": surface(after, 0)}),
                        "The fuzzy output over both inputs; lines at -0.5, 0 and 0.5.",
                    ),
                ),
            ),
        ),
    )
