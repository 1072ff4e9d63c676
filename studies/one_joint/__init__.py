"""Identification of a single joint of any rig: other controllers than greywhale's, torques, gravity, delays.

>>> model = identify_joint(rig, [Example(record, law)])
>>> Runner(other, other_law).run(model.plant, pieces_of(other, 0, len(other.time))).angles
"""
