"""Work queue of a reproduction: missing tasks in order, and outcomes taken back."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from undula.reproduction.tasks.task import ReproductionTask
from undula.sweeps.workers import DiedError
from undula.terminal.output import DONE, notice

#: Keys of an input that select compiled code.
_CODE = ("model.kind", "model.confined", "model.twist", "model.inextensibility", "model.spring")
#: Commands that share the kernels of states.
_SOLVING = ("find", "follow", "threshold")


class ReproductionWork:
    """Tasks that wait for other tasks or for a worker; the longest ones are handed out first.

    The first task of a kind may have to compile its kernels. Meanwhile other tasks of this kind are
    postponed, so that two workers do not compile the same kernels.

    Parameters
    ----------
    tasks
        The missing tasks. Tasks that they need and that are not among them are done.

    Attributes
    ----------
    total
        Number of tasks.
    """

    def __init__(self, tasks: Sequence[ReproductionTask]) -> None:
        self._waiting = sorted(tasks, key=lambda task: -task.entry.cost)
        self._missing = {task.folder: task for task in tasks}
        self._failed: set[Path] = set()
        self._compiling: set[frozenset[str]] = set()
        self._compiled: set[frozenset[str]] = set()
        self.total = len(tasks)

    @property
    def left(self) -> int:
        """Number of tasks without an outcome."""
        return len(self._missing)

    @property
    def failed(self) -> int:
        """Number of tasks that have failed, or need one that has failed."""
        return len(self._failed)

    def take(self, *, all_cores: bool) -> ReproductionTask | None:
        """Return a task to be computed, with its folder prepared; None if no task is ready.

        Parameters
        ----------
        all_cores
            If true, choose among the tasks that use all processors; else among the others.
        """
        self._fail_dependent_tasks()
        ready = [
            task
            for task in self._waiting
            if task.entry.all_cores == all_cores and not task.needs & self._missing.keys()
        ]
        if not ready:
            return None
        task = next((task for task in ready if _kernels(task) not in self._compiling), ready[0])
        self._waiting.remove(task)
        if _kernels(task) not in self._compiled:
            self._compiling.add(_kernels(task))
        task.prepare()
        return task

    def take_back(self, task: ReproductionTask, outcome: dict[str, Any] | DiedError) -> None:
        """Store the outcome of a task, or give notice of its failure.

        Parameters
        ----------
        task
            A task that `take` has returned.
        outcome
            Its outcome, as `run_captured` returns it, or the death of all workers.
        """
        del self._missing[task.folder]
        self._compiling.discard(_kernels(task))
        self._compiled.add(_kernels(task))
        if isinstance(outcome, DiedError):
            self._fail(task, f"died with every worker that tried it ({outcome})")
        elif outcome["status"] != DONE:
            self._fail(task, f"ended with status {outcome['status']}: {outcome['said']}")
        else:
            task.store(outcome)

    def _fail_dependent_tasks(self) -> None:
        for task in [task for task in self._waiting if task.needs & self._failed]:
            self._waiting.remove(task)
            del self._missing[task.folder]
            self._fail(task, "needs one that has failed")

    def _fail(self, task: ReproductionTask, cause: str) -> None:
        self._failed.add(task.folder)
        notice(f"{task.typed} {cause}")


def _kernels(task: ReproductionTask) -> frozenset[str]:
    """Return the words of a command that determine the kernels that it needs."""
    verb = "solve" if task.command[0] in _SOLVING else task.command[0]
    keys = (word for word in task.command if word.startswith(_CODE))
    flaps = {"flapping"} if any(word.startswith("flapping") for word in task.command) else set()
    return frozenset((verb, *keys, *flaps, *{"--lyapunov"} & {*task.command}))
