"""The logger of the package: silent by default, and full where a program asks for it."""

import logging
import sys

import pytest

import undula as un
from commands import Ask, in_process, refused

CODE = """
import logging, sys
import undula as un
if "--debug" in sys.argv:
    logging.basicConfig(level=logging.DEBUG, format="%(name)s %(levelname)s %(message)s")
    logging.getLogger("numba").setLevel(logging.ERROR)
model = un.Filament(4, un.TipLoad(0.0))
un.integrate(model, un.planar(model, 0.1), until=0.001, samples=3)
logging.getLogger("undula.anything").warning("unheard")
"""


@pytest.mark.slow
def test_the_library_writes_nothing_unless_it_is_asked() -> None:
    silent = in_process(sys.executable, "-c", CODE)
    assert silent == (0, "", "")
    heard = in_process(sys.executable, "-c", CODE, "--debug")
    assert "undula.analysis.runs.integrate INFO run done at t = 0.001" in heard.told
    assert "undula.anything WARNING unheard" in heard.told


def test_a_branch_logs_its_states_and_bifurcations(caplog: pytest.LogCaptureFixture) -> None:
    state = un.find(un.Filament(8, un.TipLoad(130.0)), "spinning")
    with caplog.at_level(logging.DEBUG, logger="undula"):
        branch = un.follow(state, "load.force", 150.0)
    said = [(record.levelname, record.getMessage()) for record in caplog.records]
    assert [text for level, text in said if level == "INFO"] == [
        f"{point.kind} at load.force = {point.value:.9g}" for point in branch.bifurcations
    ]
    assert sum(level == "DEBUG" for level, _ in said) == len(branch.states) - 1
    assert branch.bifurcations


def test_a_notice_of_a_command_is_on_standard_error_as_ever_and_logged(
    ask: Ask, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, logger="undula"):
        sentence = refused(ask("find", "hopping"))
    assert [record.getMessage() for record in caplog.records] == [sentence]
