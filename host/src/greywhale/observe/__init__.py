"""Torques that act on the follower from outside, as its model and its motors' voltages tell them; no sensor is needed.

>>> found = estimate_external_torque(read_log("log.csv"), load_arm("model.toml"))
>>> found.contacts
"""

from greywhale.observe.torque import (
    LIVE_EVERY_TICKS,
    Contact,
    ContactFacts,
    ExternalTorque,
    LiveTorque,
    Sight,
    Told,
    contacts_in,
    estimate_external_torque,
    live_torque,
)

__all__ = [
    "LIVE_EVERY_TICKS",
    "Contact",
    "ContactFacts",
    "ExternalTorque",
    "LiveTorque",
    "Sight",
    "Told",
    "contacts_in",
    "estimate_external_torque",
    "live_torque",
]
