"""What the paper prints and greywhale has nowhere else: Tables 2, 3, 5 and 7 of Obadina et al. 2022."""

from __future__ import annotations

TITLE = (
    "Obadina, Thaha, Mohamed, Shaheed: Grey-box modelling and fuzzy logic control of a Leader–Follower robot "
    "manipulator system: A hybrid Grey Wolf–Whale Optimisation approach. ISA Transactions (2022)"
)

TABLE_2 = {
    "Number of search agents": "10",
    "Maximum iteration": "50",
    "Number of variables": "20",
    "Objective function": "Mean Squared Error (MSE)",
    "Lower bounds": "{0, 0.01, 0, 0, 0, 0, 0.01, 0, 0, 0, 0, 0.01, 0, 0, 0, 0.01, 0, 0, 0} (19 numbers)",
    "Upper bounds": "{100, ..., 100} (19 numbers)",
}
TABLE_7 = {
    "Number of search agents": "10",
    "Maximum iteration": "30",
    "Number of variables": "8",
    "Objective function": "ITAE + ITAU",
    "Lower bounds": "{-1, -1, 0, 0, -1, -1, 0, 0}",
    "Upper bounds": "{0, 0, 1, 1, 0, 0, 1, 1}",
}
# Symbol, what it is, value, unit, and where an arm has it: link and attribute.
TABLE_3: tuple[tuple[str, str, float, str, int, str], ...] = (
    ("m0", "mass of link 0", 0.21, "kg", 0, "mass"),
    ("m1", "mass of link 1", 0.13, "kg", 1, "mass"),
    ("m2", "mass of link 2", 0.11, "kg", 2, "mass"),
    ("m3", "mass of link 3", 0.2148, "kg", 3, "mass"),
    ("L0", "length of link 0", 0.086, "m", 0, "length"),
    ("L1", "length of link 1", 0.14, "m", 1, "length"),
    ("L2", "length of link 2", 0.049, "m", 2, "length"),
    ("L3", "length of link 3", 0.172, "m", 3, "length"),
    ("L0,cg", "place of the mass of link 0", 0.043, "m", 0, "centre"),
    ("L1,cg", "place of the mass of link 1", 0.07, "m", 1, "centre"),
    ("L2,cg", "place of the mass of link 2", 0.0245, "m", 2, "centre"),
    ("L3,cg", "place of the mass of link 3", 0.086, "m", 3, "centre"),
    ("Ixx0", "inertia about x, joint 0", 1.34e-4, "kg m²", 0, "xx"),
    ("Ixx1", "inertia about x, joint 1", 3.17e-5, "kg m²", 1, "xx"),
    ("Ixx2", "inertia about x, joint 2", 8.96e-5, "kg m²", 2, "xx"),
    ("Ixx3", "inertia about x, joint 3", 1.37e-4, "kg m²", 3, "xx"),
    ("Iyy0", "inertia about y, joint 0", 8.26e-3, "kg m²", 0, "yy"),
    ("Iyy1", "inertia about y, joint 1", 3.98e-4, "kg m²", 1, "yy"),
    ("Iyy2", "inertia about y, joint 2", 2.37e-5, "kg m²", 2, "yy"),
    ("Iyy3", "inertia about y, joint 3", 2.78e-4, "kg m²", 3, "yy"),
    ("Izz0", "inertia about z, joint 0", 1.24e-4, "kg m²", 0, "zz"),
    ("Izz1", "inertia about z, joint 1", 3.98e-4, "kg m²", 1, "zz"),
    ("Izz2", "inertia about z, joint 2", 1.13e-4, "kg m²", 2, "zz"),
    ("Izz3", "inertia about z, joint 3", 2.45e-4, "kg m²", 3, "zz"),
)
# Data set -> joints 0 to 3 and all, of the white box and of the grey box.
TABLE_5 = {
    "Dataset 1": ((0.1080, 0.0090, 0.0554, 0.2318, 0.4042), (0.0077, 0.0062, 0.0120, 0.0456, 0.0715)),
    "Dataset 2": ((0.0949, 0.0081, 0.0527, 0.2736, 0.4293), (0.0307, 0.0050, 0.0122, 0.0643, 0.1122)),
}
# Per cent: improvement of the grey box on data sets 1 and 2, of the steps' total MSE and of the multi-steps'.
GREY_BOX_BETTER_FITTED, GREY_BOX_BETTER, STEPS_LOWER, MULTI_STEPS_LOWER = 82.3, 73.9, 78.0, 19.6
# What a board cannot have, by table, joint and name: a set without width.
NO_WIDTH = {("table_9", 0, "ze_c"): 0.0}
# Per cent, of joint 1 (Table 11's own numbers give 96.8).
STEADY_STATE_LOWER = 96.7
# Iterations after which the paper's curves are flat: Fig. 6, and Fig. 19 for joints 0 to 3.
FIG_6_FLAT, FIG_19_FLAT = 47, (20, 29, 20, 27)
