"""What is left to do of the catalogue: tasks handed out in order, and what has come back."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from undula.reproduction.tasks.task import Job
from undula.sweeps.workers import DiedError
from undula.terminal.output import DONE, notice

#: Keys of an input that choose other compiled code.
_CODE = ("model.kind", "model.confined", "model.twist", "model.inextensibility", "model.spring")
#: Commands that share the kernels of states.
_SOLVING = ("find", "follow", "threshold")


class TaskWork:
    """Jobs that wait for others, or for a worker; the longest go first.

    The first job of a kind may have to compile its kernels. While it does, others of its kind stand
    back, so that two workers do not compile the same.

    Parameters
    ----------
    jobs
        All that is to be done. What they need and is not among them is there already.
    """

    def __init__(self, jobs: Sequence[Job]) -> None:
        self._waiting = sorted(jobs, key=lambda job: -job.task.cost)
        self._undone = {job.folder: job for job in jobs}
        self._lost: set[Path] = set()
        self._first: set[frozenset[str]] = set()
        self._compiled: set[frozenset[str]] = set()
        self.total = len(jobs)

    @property
    def left(self) -> int:
        """Number of jobs that have not come back."""
        return len(self._undone)

    @property
    def failed(self) -> int:
        """Number of jobs that have failed, or could not begin."""
        return len(self._lost)

    def take(self, *, all_cores: bool) -> Job | None:
        """Return a job to be done now, in a folder that is ready for it; None if there is none.

        Parameters
        ----------
        all_cores
            Whether to choose among those that use all processors, or among the others.
        """
        self._give_up_what_waits_for_lost()
        free = [
            job
            for job in self._waiting
            if job.task.all_cores == all_cores and not job.needs & self._undone.keys()
        ]
        if not free:
            return None
        job = next((one for one in free if _kind(one) not in self._first), free[0])
        self._waiting.remove(job)
        if _kind(job) not in self._compiled:
            self._first.add(_kind(job))
        job.prepare()
        return job

    def take_back(self, job: Job, outcome: dict[str, Any] | DiedError) -> None:
        """Keep what a job came to, or tell why it failed."""
        del self._undone[job.folder]
        self._first.discard(_kind(job))
        self._compiled.add(_kind(job))
        if isinstance(outcome, DiedError):
            self._lose(job, f"died with every worker that tried it ({outcome})")
        elif outcome["status"] != DONE:
            self._lose(job, f"ended with status {outcome['status']}: {outcome['said']}")
        else:
            job.keep(outcome)

    def _give_up_what_waits_for_lost(self) -> None:
        for job in [one for one in self._waiting if one.needs & self._lost]:
            self._waiting.remove(job)
            del self._undone[job.folder]
            self._lose(job, "needs one that has failed")

    def _lose(self, job: Job, why: str) -> None:
        self._lost.add(job.folder)
        notice(f"{job.told} {why}")


def _kind(job: Job) -> frozenset[str]:
    """Return what of a command tells which kernels it needs, as far as that matters."""
    verb = "solve" if job.command[0] in _SOLVING else job.command[0]
    chosen = (word for word in job.command if word.startswith(_CODE))
    flaps = {"flapping"} if any(word.startswith("flapping") for word in job.command) else set()
    return frozenset((verb, *chosen, *flaps, *{"--lyapunov"} & {*job.command}))
