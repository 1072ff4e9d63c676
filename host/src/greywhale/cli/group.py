"""A group of verbs: alone it shows its help, and a misspelt verb gets a suggestion."""

from __future__ import annotations

import click

from greywhale.base.errors import cut
from greywhale.files.names import did_you_mean


def command_of(root: click.Command, verb: str) -> click.Command:
    """The command of a verb of one word or two, below that of the program."""
    command = root
    for word in verb.split():
        found = command.get_command(click.Context(command), word) if isinstance(command, click.Group) else None
        assert found is not None, verb
        command = found
    return command


class Group(click.Group):
    """Whoever gives no verb wants to see what there is: help on stdout and exit code 0."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if not args and not ctx.resilient_parsing:
            click.echo(ctx.get_help())
            ctx.exit()
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if not ctx.resilient_parsing and not name.startswith("-") and self.get_command(ctx, name) is None:
            ctx.fail(f"No such command '{cut(name)}'.{did_you_mean(name, self.list_commands(ctx))}")
        return super().resolve_command(ctx, args)
