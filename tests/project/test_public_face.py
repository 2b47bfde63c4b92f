"""The names that users see: documented, importable, typed; former names warn."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import undula
from refusal import complaint

PUBLIC = sorted(set(undula.__all__) - {"observables", "views"})
FORMER = [*undula._RENAMED, *undula._FORMER]
USER_SCRIPT = """
import undula as un

model = un.Filament(segments=8, load=un.TipLoad(75.0))
state = un.find(model, "spinning")
if isinstance(state, un.Spinning):
    branch = un.follow(state, "load.force", to=90.0)
    if isinstance(branch, un.Branch):
        force: float = branch.bifurcations["spinning-lost"].value
curve: un.ThresholdCurve = un.threshold(model, "onset", along=("model.drag_ratio", [1.0, 2.0]))
one: un.Threshold = un.threshold(model, "onset")
run: un.Run = un.integrate(model, un.kicked(model), until=0.1)
ramp: un.RampResult = un.ramp(model, "load.force", [1.0, 2.0])
slopes: un.Sensitivities = un.sensitivities(one)
"""


def test_dir_shows_what_is_meant_and_nothing_else() -> None:
    assert dir(undula) == sorted(undula.__all__)
    assert set(dir(undula.views)) == set(undula.views.__all__)


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_is_documented(name: str) -> None:
    thing: Any = getattr(undula, name)
    text = inspect.getdoc(thing) or ""
    assert text.splitlines()[0].endswith(".")


@pytest.mark.parametrize("name", [name for name in PUBLIC if name[0].islower()])
def test_every_public_function_lists_its_parameters_and_shows_an_example(name: str) -> None:
    text = inspect.getdoc(getattr(undula, name)) or ""
    assert "Parameters\n---" in text
    assert "Returns\n---" in text
    assert ">>> " in text


@pytest.mark.parametrize("name", FORMER)
def test_former_names_warn_and_name_the_new_one(name: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"undula.{name} is now undula\\."):
        getattr(undula, name)


@pytest.mark.slow
def test_a_users_script_is_typed(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(USER_SCRIPT, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", str(script)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout


def test_no_documented_page_uses_a_former_name() -> None:
    root = Path(undula.__file__).parents[2]
    pages = [*root.glob("docs/**/*.md"), root / "README.md", *root.glob("examples/*.py")]
    for page in pages:
        if "notes" in page.parts:
            continue
        text = page.read_text("utf-8")
        for name in FORMER:
            assert f"un.{name}(" not in text, page
            assert f"undula.{name}(" not in text, page


def test_misuse_is_answered_with_the_cure() -> None:
    model: Any = undula.Filament(segments=4, load=undula.TipLoad(75.0))
    assert "undula.find(model" in complaint(lambda: undula.follow(model, "load.force", to=80.0))
    assert "'spinning'" in complaint(lambda: undula.find(model, 80))  # type: ignore[arg-type]
    assert "undula.Filament" in complaint(lambda: undula.find(80, "spinning"))  # type: ignore[arg-type]
    assert "undula.Filament" in complaint(lambda: undula.integrate("run", None))  # type: ignore[arg-type]
    assert "is no run" in complaint(lambda: undula.views.portrait(model))


def test_records_name_functions_that_exist() -> None:
    source = Path(undula.__file__).parent
    for path in source.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                module, colon, name = node.value.partition(":")
                if colon and module.startswith("undula.") and name.isidentifier():
                    parts = __import__(module, fromlist=[name])
                    assert hasattr(parts, name), node.value
