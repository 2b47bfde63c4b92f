"""The order in which tasks of the catalogue are handed out."""

from pathlib import Path

import pytest

from undula.reproduction.claims.catalogue import TaskEntry
from undula.reproduction.tasks import task as task_module
from undula.reproduction.tasks.queue import ReproductionWork
from undula.reproduction.tasks.task import ReproductionTask


def task(
    folder: Path, name: str, command: str, cost: float = 1.0, needs: tuple = ()
) -> ReproductionTask:
    entry = TaskEntry(call=command, cost=cost)
    places = frozenset(folder / needed for needed in needs)
    words = tuple(command.split())
    return ReproductionTask(
        "item", name, entry, words, folder / name, name, places, as_in_full=True
    )


def names(work: ReproductionWork, count: int) -> list[str | None]:
    taken = [work.take(all_cores=False) for _ in range(count)]
    return [None if one is None else one.name for one in taken]


def done(answer: int = 0) -> dict:
    return {"status": answer, "answer": {}, "said": "why", "seconds": 0.0}


def test_the_longest_goes_first(tmp_path) -> None:
    costs = {"a": 1.0, "b": 9.0, "c": 3.0}
    work = ReproductionWork(
        [task(tmp_path, name, f"run --x {name}", cost) for name, cost in costs.items()]
    )
    first = work.take(all_cores=False)
    assert first is not None
    work.take_back(first, done())
    assert [first.name, *names(work, 2)] == ["b", "c", "a"]


@pytest.mark.parametrize("second", ["follow flapping", "threshold flapping-gained"])
def test_two_workers_do_not_compile_the_same(tmp_path, second: str) -> None:
    solved = [task(tmp_path, "a", "find flapping", 9.0), task(tmp_path, "b", second, 8.0)]
    work = ReproductionWork([*solved, task(tmp_path, "c", "run", 1.0)])
    # Where nothing else is left they are done at once nevertheless.
    assert names(work, 3) == ["a", "c", "b"]


def test_what_another_needs_comes_before_it(tmp_path) -> None:
    work = ReproductionWork(
        [task(tmp_path, "a", "plot", 9.0, ("b",)), task(tmp_path, "b", "run", 1.0)]
    )
    first = work.take(all_cores=False)
    assert first is not None
    assert (first.name, *names(work, 1)) == ("b", None)
    work.take_back(first, done())
    assert names(work, 1) == ["a"]


def test_what_needs_a_failed_one_is_given_up(tmp_path, capsys) -> None:
    work = ReproductionWork(
        [task(tmp_path, "a", "plot", 9.0, ("b",)), task(tmp_path, "b", "run", 1.0)]
    )
    first = work.take(all_cores=False)
    assert first is not None
    work.take_back(first, done(answer=3))
    assert names(work, 1) == [None]
    assert (work.left, work.failed) == (0, 2)
    assert "needs one that has failed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("source", "counts"),
    [
        ("analysis/runs/integrate.py", True),
        ("views/run/portrait.py", True),
        ("reproduction/claims/evaluate.py", False),
        ("reproduction/figures/frequencies.py", False),
    ],
)
def test_answers_are_outdated_by_a_change_of_any_source_outside_the_reproduction(
    source: str, counts: bool, tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(task_module, "PACKAGE", tmp_path)
    file = tmp_path / source
    file.parent.mkdir(parents=True)
    file.write_text("before")
    # The digest is cached for the sources of this process, which do not change.
    digest = task_module._source_digest.__wrapped__
    before = digest()
    file.write_text("after")
    assert (digest() != before) == counts
