"""The list of commands in the help, with every word of what it tells."""

from typing import Any

from typer.core import TyperGroup


class Commands(TyperGroup):
    """Commands that are listed with their whole first sentence; Click would cut it short."""

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command by its name."""
        command = super().get_command(ctx, cmd_name)
        if command is not None:
            command.short_help = (command.help or "").partition("\n\n")[0]
        return command
