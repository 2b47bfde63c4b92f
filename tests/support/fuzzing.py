"""Random calls of the command line: right words, extremes of the right type, and junk.

Commands, options and keys of the input are read off the program, so that a new one is tried without
a word here. Values are drawn by the name of what they are for, and by chance from elsewhere.
"""

import itertools
import typing
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer
from hypothesis import strategies as st

from undula.app.cli import app
from undula.inputs.input import StabilityInput, SweepInput

#: Numbers that people give, and those on which programs break.
USUAL = ("1", "2", "0.5", "8", "40", "75", "200", "0.01")
EXTREME = (
    *("0", "-0.0", "-1", "nan", "inf", "-inf", "1e308", "-1e308", "1e400", "5e-324", "1e-300"),
    *("1" + 400 * "0", "9223372036854775808", "0.1e1", "1e15", "1000000000", "3.0", "-2.5"),
)
#: What is no number, no name and no path.
JUNK = (
    *(
        "",
        " ",
        "=",
        ":",
        "::",
        "-",
        "--",
        "[",
        "]",
        "{}",
        "[[]]",
        "'",
        '"',
        "true",
        "None",
        "\u0663",
    ),
    *("a\nb", "\ud800".encode("utf-8", "surrogatepass").decode("utf-8", "surrogateescape"), "\x7f"),
    *(
        "€",
        "\U0001d518",
        "[bold]x[/bold]",
        "%s%n",
        "../..",
        "~",
        "*",
        "a=b=c",
        "load",
        "load.",
        ".force",
        "x" * 3000,
    ),
)
#: Names of states, thresholds, views and methods, each for one command and tried with all.
WORDS = (
    *("straight", "spinning", "flapping", "equilibrium", "periodic"),
    *("onset", "spinning-lost", "flapping-gained", "flapping-lost"),
    *("diagram", "gallery", "paths", "basins", "spectral", "modes", "discrete"),
)
#: What keeps a call from starting workers, where it might.
IDLE = {"sweep": ("--workers", "0"), "reproduce": ("--list",)}


def numbers() -> st.SearchStrategy[str]:
    """Return numbers as texts, one in two as people give them."""
    return st.one_of(
        st.sampled_from(USUAL),
        st.sampled_from(EXTREME),
        st.floats(allow_nan=False, width=32).map(repr),
        st.integers(-3, 300).map(str),
    )


def keys_of_the_input() -> dict[str, tuple[str, ...]]:
    """Return every key of an input file, with the words that it takes."""
    found: dict[str, tuple[str, ...]] = {}
    for record in (SweepInput, StabilityInput):
        for table, field in record.model_fields.items():
            # A table that may be left out is one of a union.
            kinds = [
                kind for kind in _alternatives(field.annotation) if hasattr(kind, "model_fields")
            ]
            for key, inner in kinds[0].model_fields.items():
                found[f"{table}.{key}"] = tuple(_literals(inner.annotation))
    return found | {"model.natural_curvature.k1": (), "model.natural_curvature.k2": ()}


def _alternatives(annotation: Any) -> tuple[Any, ...]:
    return typing.get_args(annotation) or (annotation,)


def _literals(annotation: Any) -> Iterator[str]:
    if typing.get_origin(annotation) is typing.Literal:
        yield from map(str, typing.get_args(annotation))
    for part in typing.get_args(annotation):
        yield from _literals(part)


KEYS = keys_of_the_input()
_keys = st.sampled_from(sorted(KEYS))


@st.composite
def changes(draw: st.DrawFn) -> str:
    """Draw what stands behind --set."""
    key = draw(_keys)
    lists = st.lists(numbers(), max_size=4).map(lambda items: f"[{', '.join(items)}]")
    words = (st.sampled_from(KEYS[key]),) if KEYS[key] else ()
    value = draw(st.one_of(numbers(), *words, *words, lists, st.sampled_from(JUNK)))
    return f"{key}={value}"


def ranges() -> st.SearchStrategy[str]:
    """Return ranges and lists of numbers, most of them short."""
    # A hundred values are a hundred runs of a ramp, which take minutes.
    counts = st.sampled_from(("1", "2", "3", "8", "0.5", "2.5", *EXTREME))
    return st.one_of(
        st.tuples(numbers(), numbers(), counts).map(":".join),
        st.tuples(numbers(), numbers()).map(":".join),
        st.lists(numbers(), min_size=1, max_size=4).map(",".join),
        st.sampled_from(("38:60", "onset:60", "1:1.5", "0:1:3", "60:40:3", "0:2:1")),
    )


def along() -> st.SearchStrategy[str]:
    """Return what stands behind --along and --at."""
    return st.tuples(st.one_of(_keys, st.just("load.force")), ranges()).map("=".join)


class Files:
    """Paths to draw from: results of every kind, whole and damaged, and what is none of ours.

    Parameters
    ----------
    folder
        Where the files are; a call may write there. It holds run.nc, steps.nc, store.zarr and
        study.toml already.
    """

    def __init__(self, folder: Path) -> None:
        def names(*some: str) -> st.SearchStrategy[str]:
            return st.sampled_from([str(folder / name) for name in some])

        (folder / "text.txt").write_text("not a number\n")
        (folder / "empty.nc").write_bytes(b"")
        (folder / "good.toml").write_text("[load]\nforce = 60.0\n")
        (folder / "bad.toml").write_text("[load\n")
        (folder / "zeros.nc").write_bytes(bytes(4096))
        self.inputs, self.sweeps = names("good.toml"), names("study.toml")
        self.runs, self.stores = names("run.nc"), names("store.zarr")
        self.new_figures = names("new.png", "new.pdf", "new.svg", "new.mp4", "new.html")
        self.new_folders = names("new", "other/new")
        odd = (
            "",
            ".",
            "/",
            "..",
            "a\0b",
            "n" * 300,
            str(folder),
            "/dev/null",
            "missing.nc",
            "€.png",
        )
        self.paths = st.one_of(
            names(*(path.name for path in sorted(folder.iterdir()))),
            self.new_figures,
            self.new_folders,
            st.sampled_from(odd),
        )


#: Changes that go together with most others.
SOUND_CHANGES = (
    *(
        "load.force=0",
        "load.force=40",
        "load.force=150",
        "load.profile=linear",
        "load.profile=power",
    ),
    *("model.drag_ratio=1", "model.drag_ratio=1.5", "model.confined=true", "model.kind=chain"),
    *("model.inextensibility=weak", "model.bending_ratio=1.5", "model.natural_curvature=[0.5, 0]"),
    *("model.twist=elastic", "start.shape=planar", "start.shape=helix", "start.shape=straight"),
    *("start.amplitude=0.3", "start.amplitude=1e-13", "start.seed=7", "time.rtol=1e-3"),
    *("time.atol=1e-3", "time.until=0.02", "time.until=settled", "time.until=solved"),
)
#: Ways along a parameter, by what the command takes for one.
_PARAMETERS = (
    *("load.force", "model.drag_ratio", "model.bending_ratio", "model.natural_curvature.k1"),
    *("model.twist_stiffness", "load.slope", "load.exponent", "load.position", "start.amplitude"),
)
SOUND_WAYS = {
    "follow": ("60:61", "1:1.1", "0.5:0.4", "0:0.2", "onset:40", "60:61:2", "60,61"),
    "step": ("50:52:1", "1:1.2:0.1", "0:0.1:0.1", "50:52:3", "0,0.1"),
    "threshold": ("1:1.2:2", "0.5,1"),
    "stability": ("1:1.2:2", "0.5,1", "0:1:3"),
}
SOUND_WORDS = {
    "find": WORDS[1:5],
    "follow": WORDS[:5],
    "threshold": WORDS[5:9],
    "plot": WORDS[9:13],
    "stability": WORDS[13:],
}


def targets() -> st.SearchStrategy[str]:
    """Return targets of inverse questions, sound and not."""
    names = st.sampled_from(("frequency", "leading_rate", "value", "tip_radius", *JUNK))
    return st.tuples(names, numbers()).map("=".join)


def _odd(files: Files) -> Mapping[str, st.SearchStrategy[str]]:
    """Return what an option or argument may be given at all, by its name."""
    return {
        "changes": changes(),
        "along": along(),
        "at": along(),
        "by": _keys,
        "target": targets(),
        **dict.fromkeys(("forces", "between"), ranges()),
        **dict.fromkeys(("kind", "kinds", "name", "view", "method"), st.sampled_from(WORDS)),
        "scheduler": st.sampled_from(("nowhere", "tcp://", "127.0.0.1:1", "tcp://127.0.0.1:99999")),
        "names": st.sampled_from(("missing-item", *JUNK)),
        **dict.fromkeys(
            ("file", "out", "result", "store", "plot", "run", "runs", "catalogue"), files.paths
        ),
    }


def _sound(command: str, files: Files) -> Mapping[str, st.SearchStrategy[str]]:
    """Return what an option or argument of a command is given by who knows it."""
    ways = st.tuples(
        st.one_of(st.just("load.force"), st.sampled_from(_PARAMETERS)),
        st.sampled_from(SOUND_WAYS.get(command, ("50",))),
    ).map("=".join)
    words = st.sampled_from(SOUND_WORDS.get(command, WORDS))
    read = {
        "step": files.inputs,
        "sweep": files.sweeps,
        "plot": st.one_of(files.runs, files.stores),
    }
    outs = {"run": files.new_folders, "step": files.new_folders, "sweep": files.stores}
    return {
        "changes": st.sampled_from(SOUND_CHANGES),
        "along": ways,
        "at": st.just("load.force=50"),
        "by": st.sampled_from(("load.force", "model.drag_ratio")),
        "target": st.sampled_from(("frequency=60", "leading_rate=0", "value=40")),
        "between": st.just("40:60"),
        "forces": st.sampled_from(("40:60:3", "75")),
        **dict.fromkeys(("kind", "kinds", "name", "view", "method"), words),
        "file": read.get(command, files.inputs),
        "result": read.get(command, files.runs),
        "runs": files.runs,
        "run": files.runs,
        "store": files.stores,
        "out": outs.get(command, files.new_figures),
        "plot": files.new_figures,
        "budget": st.just("0.3"),
        "until": st.floats(0.02, 1e6).map(repr),
    }


def commands() -> dict[str, Any]:
    """Return the commands of the program by name."""
    return dict(typer.main.get_command(app).commands)


@st.composite
def calls(draw: st.DrawFn, files: Files) -> list[str]:
    """Draw the words of a call, as people write it but for a few of its options at most."""
    name = draw(st.sampled_from(sorted(commands())))
    parameters = [one for one in commands()[name].params if one.name not in _left_alone(name)]
    some = st.sets(st.sampled_from([one.name for one in parameters]), max_size=2)
    strange = draw(st.one_of(some, some, st.just({one.name for one in parameters})))
    odd, sound = _odd(files), _sound(name, files)
    words, positional = [name, *_cheaply(name)], []
    for one in parameters:
        value = odd.get(one.name, numbers())
        value = st.one_of(value, value, st.sampled_from(JUNK))
        if one.name not in strange:
            value = sound.get(one.name, st.sampled_from(USUAL))
        wanted = one.required or one.name in strange or draw(st.integers(0, 3)) == 0
        if one.param_type_name == "argument":
            positional += [draw(value)] if wanted else []
        elif one.is_flag:
            words += [one.opts[0]] if draw(st.integers(0, 4)) == 0 else []
        elif wanted:
            for _ in range(draw(st.integers(1, 3)) if one.multiple else 1):
                words += [one.opts[0], draw(value)]
    # Nothing is left to do of the stored sweep: the same one starts no workers.
    idle = name == "sweep" and "--out" in words and "out" not in strange
    return [*words, *(() if idle else IDLE.get(name, ())), *positional]


def _left_alone(command: str) -> set[str]:
    return {"help", "workers"} if command in IDLE else {"help"}


def _cheaply(name: str) -> list[str]:
    """Return options that keep a call short; what is drawn later takes their place."""
    if name in ("units", "plot", "movie", "status", "reproduce"):
        return []
    if name == "resume":
        return ["--budget", "0.3"]
    small = ["--set", "model.segments=6"]
    if name in ("run", "step"):
        small += ["--set", "time.until=0.01", "--set", "time.samples=11", "--budget", "2"]
    return small + (["--no-movie"] if name == "run" else [])


def unknown_parameters(files: Files) -> set[str]:
    """Return the options that take a value of a kind that is not drawn by name."""
    every = itertools.chain.from_iterable(one.params for one in commands().values())
    named = _odd(files)
    return {
        one.name
        for one in every
        if not getattr(one, "is_flag", False) and one.name not in named and one.name != "help"
    }
