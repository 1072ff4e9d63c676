"""Verbs that other distributions bring, found by their entry points in the group `greywhale.verbs`.

An entry point has the name of its verb and leads to a `Verb`. The module that holds it imports little, because --help
reads what every verb does. What is wrong with a distribution concerns its own verbs alone.
"""

from __future__ import annotations

import logging
import pkgutil
from dataclasses import dataclass
from importlib.metadata import EntryPoint, distributions

import click

from greywhale.base.errors import UserError, cut

GROUP = "greywhale.verbs"
# The distributions of this project that bring verbs: whoever lacks one learns what to install.
BRINGS = {"compare": "greywhale-paper", "reproduce": "greywhale-paper"}
logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Verb:
    """A verb that another distribution brings, as that describes it."""

    does: str  # one sentence, for --help
    command: str  # where its click command is: module:name


def find() -> dict[str, EntryPoint]:
    """Every verb that an installed distribution brings; of two with one name the first on Python's path counts."""
    found: dict[str, EntryPoint] = {}
    for distribution in distributions():
        try:
            entries = [entry for entry in distribution.entry_points if entry.group == GROUP]
        except Exception as error:  # its file of entry points is no such file
            logger.info("the entry points of %s cannot be read: %r", distribution, error)
            continue
        for entry in entries:
            found.setdefault(entry.name, entry)
    return dict(sorted(found.items()))


def does(entry: EntryPoint) -> str:
    """The purpose of a verb; where the verb cannot be loaded, a sentence that says so."""
    try:
        return _verb(entry).does
    except UserError as error:
        return error.message


def place_of(entry: EntryPoint) -> str:
    """The place of a verb's click command: module:name."""
    return _verb(entry).command


def command_of(name: str) -> click.Command | None:
    """The click command of a verb, None where there is no such verb; UserError where it must be installed, or anew."""
    entry = find().get(name)
    if entry is not None:
        return _load(entry)
    if name in BRINGS:
        raise UserError(f"{name} is no part of greywhale itself; install it: pip install {BRINGS[name]}.")
    return None


def _load(entry: EntryPoint) -> click.Command:
    place = place_of(entry)
    try:
        command = pkgutil.resolve_name(place)
        if not isinstance(command, click.Command):
            raise TypeError(f"{place} is no click command")
    except (Exception, SystemExit) as error:
        raise _broken(entry, error) from error
    return command


def _verb(entry: EntryPoint) -> Verb:
    try:
        verb = entry.load()
        if not isinstance(verb, Verb):
            raise TypeError(f"{entry.value} is no {Verb.__module__}.{Verb.__name__}")
    except (Exception, SystemExit) as error:
        raise _broken(entry, error) from error
    return verb


def _broken(entry: EntryPoint, error: BaseException) -> UserError:
    who = _distribution(entry)
    reason = cut(" ".join(f"{type(error).__name__}: {error}".split()), 300)  # so that the sentence stays readable
    which = f"{entry.name}, a verb of the distribution {who},"
    return UserError(f"{which} cannot be loaded ({reason}); install {who} again, or remove it.")


def _distribution(entry: EntryPoint) -> str:
    """Its name, from its metadata; of one without that, what Python calls it."""
    try:
        return str(entry.dist.name) if entry.dist is not None else "unknown"
    except Exception:
        return str(entry.dist)
