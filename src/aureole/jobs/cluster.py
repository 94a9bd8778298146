"""Who makes frames: this process, processes of this machine, or a cluster's machines (Dask).

A frame is one function of one task, whoever calls it: nothing of it depends on the frames before it, on
the worker or on the order, so all ways give the same bits. A worker that dies loses nothing: what it was
making is given to another. A task that goes on failing is told with its reason, and stops none of the rest.
"""

import contextlib
import logging
import os
import queue
import re
import time
import uuid
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from aureole import picture, refuse
from aureole.jobs import cluster_worker
from aureole.jobs.cluster_versions import Signature, differences, signature

Task = TypeVar("Task")
Outcome = TypeVar("Outcome")

# Each is as often as the scheduler itself hands a task on: to 4 workers that die, unless it is told other.
TRIES = 2
# Tasks that the scheduler knows of at once: enough for it to ask for more workers, few in memory.
WINDOW = 256
# Seconds in which a scheduler answers, after which a cluster without workers is given up, between two looks.
ANSWER, PATIENCE, LOOK = 15.0, 300.0, 5.0
ADDRESS = re.compile(r"(tcp|tls|ucx|wss?)://[^\s/]+:\d+")
INSTALL = "python -m pip install 'aureole[cluster]'"


@dataclass(frozen=True)
class Crew:
    """Who makes the frames.

    Parameters
    ----------
    workers : int, optional
        So many processes of this machine, each making a frame at a time; only this one otherwise.
    scheduler : str, optional
        A Dask scheduler's address, whose workers make them.
    patience : float
        Seconds after which a cluster that has no worker at all is given up.
    """

    workers: int | None = None
    scheduler: str | None = None
    patience: float = PATIENCE

    @property
    def alone(self) -> bool:
        """Whether this process makes all frames itself."""
        return self.workers is None and self.scheduler is None

    def check(self) -> "Crew":
        """Refuse, before any work, what cannot be: both at once, no address, Dask that is missing."""
        if self.workers is not None:
            refuse.at_least("workers", self.workers, 1)
            if self.scheduler is not None:
                raise refuse.Refusal("'workers' are of this machine; it does not go with 'scheduler'.")
        if self.scheduler is not None and not ADDRESS.fullmatch(self.scheduler):
            raise refuse.Refusal(
                f"'scheduler' must be an address such as tcp://host:8786, got '{self.scheduler}'."
            )
        refuse.positive("patience", self.patience)
        if not self.alone:
            _dask("workers" if self.scheduler is None else "scheduler")
        return self

    def memory(self, allowed: int | None) -> int | None:
        """Return the bytes that each frame may use, where so many are allowed on this machine in all."""
        return allowed if self.workers is None else picture.allowed_memory(allowed) // self.workers


@dataclass(frozen=True)
class Delivery(Generic[Outcome]):
    """What became of a task.

    Parameters
    ----------
    index : int
        Which of the tasks.
    outcome : object, optional
        What the work returned; None where it did not.
    reason : str, optional
        Why there is none, in a line.
    worker : str
        Who made it: "here", or a worker's address; nobody where there is a reason.
    """

    index: int
    outcome: Outcome | None = None
    reason: str | None = None
    worker: str = ""


def _nobody(line: str) -> None:
    """Tell a note to nobody."""


@dataclass(frozen=True, eq=False)
class _Errand(Generic[Task, Outcome]):
    """All that is done for one call of `deliver`."""

    work: Callable[[Task], Outcome]
    tasks: Sequence[Task]
    crew: Crew
    client: Any
    ready: "queue.SimpleQueue[Any]" = field(default_factory=queue.SimpleQueue)
    name: str = field(default_factory=lambda: f"frame-{uuid.uuid4().hex[:12]}")


def deliver(
    work: Callable[[Task], Outcome],
    tasks: Sequence[Task],
    crew: Crew | None = None,
    folders: Sequence[Path] = (),
    say: Callable[[str], None] = _nobody,
) -> Iterator[Delivery[Outcome]]:
    """Let a crew do a piece of work for each task, and tell of each as it is done.

    Parameters
    ----------
    work : callable
        A module's function of one task. It may be called again for the same task when a worker died,
        so what it writes has to appear whole or not at all.
    tasks : sequence
        Records that can be pickled; their paths absolute.
    crew : Crew, optional
        Who does it; this process otherwise.
    folders : sequence of Path
        Folders that every worker has to see.
    say : callable
        Gets notes, a line each.

    Yields
    ------
    Delivery
        One for each task, in the order in which they come.

    Raises
    ------
    refuse.Refusal
        Where the crew cannot be, or has another Aureole, or does not see the folders.
    ConnectionError
        Where the scheduler does not answer.
    """
    crew = Crew() if crew is None else crew.check()
    if crew.alone:
        yield from _here(work, tasks)
        return
    with _client(crew) as client:
        _check_workers(client, folders, say)
        yield from _spread(_Errand(work, tasks, crew, client))


def _here(work: Callable[[Task], Outcome], tasks: Sequence[Task]) -> Iterator[Delivery[Outcome]]:
    """Do all in this process, one after the other."""
    for index, task in enumerate(tasks):
        try:
            outcome = work(task)
        except Exception as error:
            yield Delivery(index, reason=_line(error))
        else:
            yield Delivery(index, outcome, worker="here")


def _spread(errand: _Errand[Task, Outcome]) -> Iterator[Delivery[Outcome]]:
    """Hand tasks out, and take back what comes, until there is none left."""
    todo = deque((index, 1) for index in range(len(errand.tasks)))
    suspects: deque[tuple[int, int]] = deque()
    running: dict[Any, tuple[Any, int, int]] = {}
    while todo or suspects or running:
        for index, turn in _turns(todo, suspects, len(running)):
            future = _submit(errand, index, turn)
            running[future.key] = (future, index, turn)
        came, reason = _next(errand)
        if came is None:
            left = {index for _, index, _ in running.values()} | {index for index, _ in (*todo, *suspects)}
            yield from (Delivery(index, reason=reason) for index in sorted(left))
            return
        _, index, turn = running.pop(came.key)
        delivery, killed, again = _taken(came, index)
        if again and turn < TRIES:
            (suspects if killed else todo).append((index, turn + 1))
        else:
            yield delivery


def _turns(
    todo: deque[tuple[int, int]], suspects: deque[tuple[int, int]], running: int
) -> Iterator[tuple[int, int]]:
    """Take what is to be handed out now.

    When a worker dies, all that it had is blamed, what only waited there as well. So what was blamed too
    often is tried again when all else is done, each alone: then who dies of it dies of nothing else.
    """
    while todo and running < WINDOW:
        running += 1
        yield todo.popleft()
    if suspects and not running:
        yield suspects.popleft()


def _submit(errand: _Errand[Task, Outcome], index: int, turn: int) -> Any:
    """Hand a task to the scheduler. Keys of one name are one group, which it keeps in a queue of its own."""
    from distributed.protocol import pickle

    future = errand.client.submit(
        _done_there,
        # The scheduler opens what it is given; it need not know of tasks.
        pickle.dumps((errand.work, errand.tasks[index], signature())),
        key=(errand.name, index, turn),
        pure=False,
    )
    future.add_done_callback(errand.ready.put)
    return future


def _next(errand: _Errand[Task, Outcome]) -> tuple[Any, str]:
    """Wait for a future that is settled; None with the reason where none will ever come."""
    alone_since: float | None = None
    while True:
        came = None
        with contextlib.suppress(queue.Empty):
            came = errand.ready.get(timeout=LOOK)
        if errand.client.status not in ("running", "connecting"):
            return None, "the scheduler was lost; run again to make what is left"
        if came is not None:
            return came, ""
        now = time.monotonic()
        alone_since = None if _has_workers(errand.client) else alone_since or now
        if alone_since is not None and now - alone_since > errand.crew.patience:
            return None, f"the cluster had no worker for {errand.crew.patience:g} s"


def _has_workers(client: Any) -> bool:
    """Return whether a scheduler that answers has any worker."""
    try:
        return bool(client.nthreads())
    except (OSError, TimeoutError, RuntimeError):
        return False


def _taken(future: Any, index: int) -> tuple[Delivery[Any], bool, bool]:
    """Return what a settled future holds, whether workers died of it, and whether it is worth another try."""
    from concurrent.futures import CancelledError

    from distributed import KilledWorker

    try:
        outcome, worker = future.result()
    except KilledWorker:
        return Delivery(index, reason="the workers that made it died"), True, True
    except CancelledError:
        return Delivery(index, reason="it was cancelled by the cluster"), False, True
    except StrangeWorker as stranger:
        return Delivery(index, reason=str(stranger)), False, True
    except Exception as error:
        return Delivery(index, reason=_line(error)), False, False
    finally:
        future.release()
    return Delivery(index, outcome, worker=worker), False, False


class StrangeWorker(Exception):
    """A worker came later, and has another Aureole than the one that sent the task."""


def _done_there(sent: bytes) -> tuple[Any, str]:
    """Do the work on a worker, where its Aureole is ours."""
    from distributed import get_worker
    from distributed.protocol import pickle

    address = str(get_worker().address)
    work, task, ours = pickle.loads(sent)
    wrong = differences(ours, signature())[0]
    if wrong:
        raise StrangeWorker(f"the worker {address} has {wrong[0]}")
    return work(task), address


def _check_workers(client: Any, folders: Sequence[Path], say: Callable[[str], None]) -> None:
    """Refuse workers that have another Aureole or see other disks; note what may move last digits."""
    places = [str(Path(folder).resolve()) for folder in folders]
    try:
        _check("the scheduler", client.run_on_scheduler(_told_there, []))
    except (ImportError, AttributeError) as error:
        raise refuse.Refusal(f"the scheduler has no Aureole, or another one: {_line(error)}.") from None
    told = client.run(_told_there, places, on_error="return")
    if not told:
        say("the cluster has no worker yet; frames wait for one")
    notes: Counter[str] = Counter()
    for address, found in sorted(told.items()):
        if isinstance(found, ImportError | AttributeError):
            raise refuse.Refusal(f"the worker {address} has no Aureole, or another one: {_line(found)}.")
        if not isinstance(found, Exception):  # else it has died meanwhile; its tasks go to others
            notes.update(_check(f"the worker {address}", found))
    for line, count in notes.items():
        say(f"{count} of {len(told)} workers have {line}; last digits may differ")


def _check(who: str, told: tuple[Signature, list[str]]) -> list[str]:
    """Refuse one that has another Aureole or does not see a folder; return what may move last digits."""
    theirs, unseen = told
    wrong, doubtful = differences(signature(), theirs)
    if wrong:
        raise refuse.Refusal(f"{who} has {wrong[0]}; install the same on both.")
    if unseen:
        raise refuse.Refusal(f"{who} does not see the folder '{unseen[0]}'; all need one disk.")
    return doubtful


def _told_there(places: list[str]) -> tuple[Signature, list[str]]:
    """Tell on a worker what it has and which folders it does not see."""
    return signature(), [place for place in places if not os.path.isdir(place)]


@contextlib.contextmanager
def _client(crew: Crew) -> Iterator[Any]:
    """Hold the door to a cluster open: the one that was named, or processes started for this alone."""
    from distributed import Client

    with contextlib.ExitStack() as stack:
        stack.enter_context(_quiet())
        address: Any = crew.scheduler
        if address is None:
            assert crew.workers is not None
            address = stack.enter_context(_processes(crew.workers))
        try:
            client = Client(address, timeout=ANSWER, set_as_default=False)
        except (OSError, TimeoutError) as error:
            raise ConnectionError(f"the scheduler '{crew.scheduler}' does not answer") from error
        yield stack.enter_context(client)


@contextlib.contextmanager
def _processes(count: int) -> Iterator[Any]:
    """Start workers on this machine. Each makes one frame at a time with its share of the cores."""
    import dask
    from distributed import LocalCluster

    share = str(max(1, _cores() // count))
    # A machine that is busy may take long to start another where one has died.
    patient = dask.config.set({"distributed.deploy.lost-worker-timeout": f"{PATIENCE:g}s"})
    with (
        patient,
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            processes=True,
            # A frame refuses what would not fit; a worker is not to be killed besides.
            memory_limit=0,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
            env={"NUMBA_NUM_THREADS": share, "OMP_NUM_THREADS": share, cluster_worker.WORKERS: str(count)},
            preload=[cluster_worker.__name__],
        ) as made,
    ):
        yield made


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep the cluster's own chatter from between the lines of ours, to the end where a run is broken off."""
    loggers = [logging.getLogger(name) for name in ("distributed", "asyncio")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    broken_off = False
    try:
        yield
    except BaseException as reason:
        broken_off = not isinstance(reason, Exception | GeneratorExit)
        raise
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(logging.CRITICAL if broken_off else level)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _dask(asked: str) -> None:
    """Refuse a cluster where Dask is not installed."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise refuse.Refusal(f"'{asked}' needs Dask, which is not installed: {INSTALL}.") from None


def _line(error: BaseException) -> str:
    """Return an error in one line; a refusal needs no name."""
    words = " ".join(str(error).split())
    if isinstance(error, refuse.Refusal):
        return words
    return f"{type(error).__name__}: {words}" if words else type(error).__name__
