"""The fuzzy PD+I law in three forms: exact (rational), twin (integer, numpy) and the firmware's own (native)."""

from greywhale.fuzzy.settings import JointSettings, load_joints

__all__ = ["JointSettings", "load_joints"]
