"""A group of verbs: alone it shows its help, and a misspelt verb gets a suggestion."""

from __future__ import annotations

import click

from greywhale.base.errors import cut
from greywhale.files.names import did_you_mean


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
