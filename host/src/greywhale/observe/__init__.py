"""Torques that act on the follower from outside, as its model and its motors' voltages tell them; no sensor is needed.

>>> found = estimate_external_torque(read_log("log.csv"), load_arm("model.toml"))
>>> found.contacts
"""

from greywhale.observe.torque import Contact, ExternalTorque, LiveTorque, Sight, estimate_external_torque

__all__ = ["Contact", "ExternalTorque", "LiveTorque", "Sight", "estimate_external_torque"]
