"""List of commands in the help, with unabridged descriptions."""

from typing import Any

from typer.core import TyperGroup


class Commands(TyperGroup):
    """Group of commands listed with their whole first sentence, which Click would shorten."""

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command by its name."""
        command = super().get_command(ctx, cmd_name)
        if command is not None:
            command.short_help = (command.help or "").partition("\n\n")[0]
        return command
