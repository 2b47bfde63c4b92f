"""Streams that are missing, closed, full or not Unicode: the answer is never lost."""

import io
import json
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from typer.main import get_command

from undula.app import cli
from undula.terminal.streams import Guarded, printable

UNDULA = Path(sysconfig.get_path("scripts")) / "undula"
PACKAGE = Path(cli.__file__).parents[1]
#: A process may have to compile the kernels first.
PATIENCE = 300.0
COMMANDS = get_command(cli.app).commands  # type: ignore[attr-defined]
RUN = "run --set model.segments=8 --set time.until=0.02 --no-movie --out out"


def shell(line: str, folder: Path, **environment: str) -> subprocess.CompletedProcess:
    """Run a line of a shell, with `undula` as this package's own command."""
    words = {"PATH": f"{UNDULA.parent}:/usr/bin:/bin", **environment}
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", line],
        cwd=folder,
        env=words,
        capture_output=True,
        timeout=PATIENCE,
        check=False,
    )


@pytest.fixture(scope="module")
def said(tmp_path_factory) -> str:
    return shell("undula stability", tmp_path_factory.mktemp("plain")).stdout.decode()


@pytest.mark.slow
def test_a_run_without_standard_error_does_its_work(tmp_path) -> None:
    done = shell(f"undula {RUN} --json 2>&-", tmp_path)
    assert done.returncode == 0
    assert Path(tmp_path, json.loads(done.stdout)["output"]).exists()


@pytest.mark.slow
def test_without_standard_output_the_answer_goes_to_standard_error(tmp_path, said) -> None:
    done = shell("undula stability >&-", tmp_path)
    assert (done.returncode, done.stdout, done.stderr.decode()) == (0, b"", said)
    assert shell("undula stability >&- 2>&- <&-", tmp_path).returncode == 0


def test_files_are_not_opened_in_the_place_of_a_closed_stream(tmp_path) -> None:
    script = (
        "import os; from undula.terminal.streams import guarded_streams\n"
        "with guarded_streams(): print(open('new', 'w').fileno() > 2, file=open('told', 'w'))"
    )
    shell(f'{sys.executable} -c "{script}" <&- >&- 2>&-', tmp_path)
    assert (tmp_path / "told").read_text() == "True\n"


@pytest.mark.slow
def test_a_full_output_is_told_in_one_sentence(tmp_path) -> None:
    for words in ("units --force 1", "units --force 1 --json", "--help", "units --help"):
        done = shell(f"undula {words} >/dev/full", tmp_path)
        assert done.returncode == 3
        assert re.fullmatch(r"undula: .*No space left on device.*\n", done.stderr.decode())
    assert shell(f"undula {RUN} >/dev/full", tmp_path).returncode == 3
    assert (tmp_path / "out" / "run.nc").exists()
    # What is wrong with the input is told on standard error, and that may be full as well.
    assert shell("undula units --forces 1 2>/dev/full", tmp_path).returncode == 2
    assert shell("undula units --forces 1 --json >/dev/full", tmp_path).returncode == 2


@pytest.mark.slow
def test_a_reader_who_has_had_enough_is_no_trouble(tmp_path, said) -> None:
    # `true` reads nothing, so that the pipe is closed before the answer comes.
    for line in ("undula stability | head -1", "undula stability | true", "undula --help | true"):
        done = shell(line, tmp_path)
        assert (done.returncode, done.stderr) == (0, b""), line
    assert (
        shell("undula stability | head -1", tmp_path).stdout.decode() == said.split("\n")[0] + "\n"
    )


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_an_answer_is_told_in_the_letters_that_there_are(tmp_path, said, encoding) -> None:
    assert "±" in said
    text = shell("undula stability", tmp_path, PYTHONIOENCODING=encoding)
    assert text.returncode == 0
    expected = said.replace("±", "+-") if encoding == "ascii" else said
    assert text.stdout.decode(encoding) == expected


@pytest.mark.slow
def test_json_is_the_same_in_every_locale(tmp_path) -> None:
    told = [
        shell("undula stability --json", tmp_path, **environment).stdout
        for environment in ({"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C"}, {"PYTHONUTF8": "1"})
    ]
    assert len(set(told)) == 1
    assert json.loads(told[0].decode("ascii"))["status"] == "done"


@pytest.mark.slow
def test_names_of_files_that_are_not_unicode_are_told(tmp_path) -> None:
    for words in ("", "--json"):
        done = shell(f"undula plot $'caf\\xe9.nc' {words}", tmp_path, PYTHONUTF8="1")
        assert done.returncode == 2
        assert b"Traceback" not in done.stderr
        assert b"caf" in done.stderr


def test_every_letter_that_we_write_has_plain_letters() -> None:
    texts = [*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.toml"), *PACKAGE.rglob("*.j2")]
    letters = {letter for path in texts for letter in path.read_text("utf-8")}
    for letter in letters - set(map(chr, range(128))):
        assert printable(letter, "ascii").isascii()
        assert "?" not in printable(letter, "ascii"), f"{letter} has no plain letters"


def test_plain_letters_are_readable() -> None:
    assert printable("ζ L⁴/B ± 1, café", "ascii") == "zeta L^4/B +- 1, cafe"
    assert printable("ζ", "iso8859-7") == "ζ"


def test_a_stream_that_fails_or_is_closed_takes_everything() -> None:
    class Failing(io.StringIO):
        def write(self, _: str) -> int:
            raise OSError(28, "No space left on device")

    stream = Guarded(Failing())
    stream.write("one")
    stream.write("two")
    stream.flush()
    assert stream.trouble is not None
    closed = io.StringIO()
    closed.close()
    quiet = Guarded(closed)
    quiet.write("one")
    assert (quiet.trouble, quiet.isatty(), Guarded(None).isatty()) == (None, False, False)


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_help_tells_every_word_of_its_texts(capsys, name) -> None:
    assert cli.main([*([name] if name else []), "--help"]) == 0
    # Lines are broken anywhere, also at hyphens.
    shown = re.sub(r"\s+", "", capsys.readouterr().out)
    command = COMMANDS[name] if name else get_command(cli.app)
    texts = [command.help, *(one.help for one in command.params)]
    if not name:
        texts += [one.help.partition("\n\n")[0] for one in COMMANDS.values()]
    for text in texts:
        assert re.sub(r"\s+", "", text or "") in shown
