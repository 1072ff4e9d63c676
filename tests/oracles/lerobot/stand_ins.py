"""Runs a script with stand-ins for what lerobot imports and a recording never calls: torch, other devices, policies.

    python stand_ins.py SCRIPT ARGUMENT...

Every name of a stand-in is an empty class. So the script has the real base classes, factory, recorder and datasets, but
nothing that computes with tensors.
"""

from __future__ import annotations

import abc
import importlib.abc
import importlib.machinery
import runpy
import sys
import types

OURS = ("cv2", "einops", "gymnasium", "requests", "safetensors", "torch", "torchvision")
LEROBOTS = ("lerobot.policies", "lerobot.rewards")


class Empty(abc.ABCMeta):
    def __getattr__(cls, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return made(name)

    def __getitem__(cls, key):
        return cls


def made(name):
    """A class that may be called, and that as a decorator changes nothing."""
    return Empty(name, (), {"__init__": lambda self, *a, **k: None, "__call__": lambda self, it=None, *a, **k: it})


class StandIn(types.ModuleType):
    __path__ = ()

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return made(name)


class Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    def find_spec(self, name, path, target=None):
        if name.startswith(LEROBOTS) or name.partition(".")[0] in OURS:
            return importlib.machinery.ModuleSpec(name, self, is_package=True)
        return None

    def create_module(self, spec):
        return StandIn(spec.name)

    def exec_module(self, module):
        pass


sys.meta_path.insert(0, Finder())
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
