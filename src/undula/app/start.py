"""The program `undula`, begun so that Ctrl-C ends it quietly while it is still being imported."""


def main() -> int:
    """Run the command line of the shell; return its exit status."""
    try:
        from undula.app.cli import main as carry_out
    except KeyboardInterrupt:
        return 130  # as `undula.terminal.output.INTERRUPTED`, which is not there yet
    return carry_out()
