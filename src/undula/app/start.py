"""Start of the program `undula`, which Ctrl-C ends without a traceback during its imports."""


def main() -> int:
    """Run the command line of the shell; return its exit status."""
    try:
        from undula.app.cli import main as run_command
    except KeyboardInterrupt:
        return 130  # as `undula.terminal.output.INTERRUPTED`, which is not imported yet
    return run_command()
