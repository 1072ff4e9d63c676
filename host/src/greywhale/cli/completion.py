"""Suggestions for Tab where no file is meant: parameters, ports, arms and controllers that come with greywhale."""

from __future__ import annotations

from click import Context, Parameter
from click.shell_completion import CompletionItem

Items = list[CompletionItem]


def parameters(context: Context, parameter: Parameter, incomplete: str) -> Items:
    """Names of parameters, such as joint0.kp, with their units."""
    from greywhale.protocol.schema import PARAMETERS

    return [CompletionItem(one.name, help=one.unit) for one in PARAMETERS if one.name.startswith(incomplete)]


def settings(context: Context, parameter: Parameter, incomplete: str) -> Items:
    """Suggest names of parameters with a = for the value: joint0.kp=."""
    return [CompletionItem(f"{one.value}=", help=one.help) for one in parameters(context, parameter, incomplete)]


def ports(context: Context, parameter: Parameter, incomplete: str) -> Items:
    """The ports there are, without opening one."""
    from greywhale.protocol.ports import find_ports

    found = find_ports()
    return [CompletionItem(one.device, help=one.description) for one in found if one.device.startswith(incomplete)]


def arms(context: Context, parameter: Parameter, incomplete: str) -> Items:
    from greywhale.files.arm import arm_names

    named = [CompletionItem(name) for name in arm_names() if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


def controllers(context: Context, parameter: Parameter, incomplete: str) -> Items:
    from greywhale.files.paper_tables import controller_names

    named = [CompletionItem(name) for name in controller_names() if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]
