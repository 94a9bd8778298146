"""Timing that holds on a busy machine: everything in turn, in one run, and medians of it.

Absolute times are this machine's; ratios of medians taken in turn are what a bench is for.
"""

import importlib.metadata
import os
import platform
import re
import statistics
import time
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Mapping
from typing import Any, TypeVar

from threadpoolctl import threadpool_info

from aureole.bench.report import Report, Table
from aureole.records import Stage

Task = Callable[[], object]
Part = Callable[[], Iterator[Stage]]
Found = TypeVar("Found")

# Seconds for all runs of one task.
PATIENCE = 10.0


def alternate(
    tasks: Mapping[str, Task],
    runs: int,
    once: Collection[str] = (),
    label: str = "",
    patience: float = PATIENCE,
) -> Generator[Stage, None, dict[str, float]]:
    """Time tasks in turn, telling how far it is; the first call of each is not counted.

    Parameters
    ----------
    tasks : mapping
        Name to a call without arguments.
    runs : int
        How often each is timed.
    once : collection of str
        Tasks that are warm already and take very long: called once, one a round, so that each lies
        beside a run of the others.
    label : str
        What is being timed, for a person.
    patience : float
        A task is timed no more often than fits into so many seconds, but once at least.

    Yields
    ------
    Stage
        Before each call.

    Returns
    -------
    dict
        Name to the median in milliseconds.
    """
    taken: dict[str, list[float]] = {name: [] for name in tasks}
    wanted = dict.fromkeys(tasks, runs)
    turn = {name: 1 + index % runs for index, name in enumerate(once)}
    total = (runs + 1) * len(tasks)
    for run in range(runs + 1):
        for index, (name, task) in enumerate(tasks.items()):
            if len(taken[name]) == wanted[name] or turn.get(name, run) != run:
                continue
            yield Stage((run * len(tasks) + index) / total, f"{label} {name}".strip())
            spent = milliseconds(task)
            if not run:
                wanted[name] = max(1, min(runs, int(patience * 1e3 / max(spent, 1e-3))))
                continue
            taken[name].append(spent)
    return {name: statistics.median(each) for name, each in taken.items()}


def milliseconds(task: Task) -> float:
    """Time one call.

    Parameters
    ----------
    task : callable
        Without arguments.

    Returns
    -------
    float
        Milliseconds.
    """
    start = time.perf_counter()
    task()
    return 1e3 * (time.perf_counter() - start)


def within(work: Generator[Stage, None, Found], start: float, end: float) -> Generator[Stage, None, Found]:
    """Run a computation as the part of a whole that lies between two fractions of it.

    Parameters
    ----------
    work : generator
        Gives stages from 0 to 1.
    start, end : float
        Fractions of the whole.

    Yields
    ------
    Stage
        With the fraction of the whole.

    Returns
    -------
    object
        What the computation returns.
    """
    while True:
        try:
            stage = next(work)
        except StopIteration as ended:
            found: Found = ended.value
            return found
        yield Stage(start + (end - start) * stage.fraction, stage.label)


def in_order(parts: Iterable[Part]) -> Generator[Stage, None, tuple[Table, ...]]:
    """Run the parts of a bench one after another as one computation.

    Parameters
    ----------
    parts : iterable of callable
        Each gives stages, the last of which holds its tables.

    Yields
    ------
    Stage
        With the fraction of the whole.

    Returns
    -------
    tuple of Table
        All parts' tables.
    """
    tables: list[Table] = []
    every = list(parts)
    for index, part in enumerate(every):
        found: tuple[Table, ...] = ()
        for stage in part():
            found = stage.result or ()
            # The whole is done only when its report is.
            yield Stage(0.999 * (index + stage.fraction) / len(every), stage.label)
        tables += found
    return tuple(tables)


def finish(
    bench: str, settings: dict[str, Any], parts: Iterable[Part], packages: Iterable[str] = ()
) -> Iterator[Stage]:
    """Run a bench's parts and report.

    Parameters
    ----------
    bench : str
        The bench's name.
    settings : dict
        What was asked for.
    parts : iterable of callable
        As for `in_order`.
    packages : iterable of str
        As for `environment`.

    Yields
    ------
    Stage
        The last one holds the `Report`.
    """
    machine = environment(packages)
    start = time.perf_counter()
    tables = yield from in_order(parts)
    machine["seconds"] = round(time.perf_counter() - start, 1)
    yield Stage(1.0, bench, Report(bench, machine, settings, tables))


def workers() -> int:
    """Return how many threads SciPy's transforms and the peers get.

    Returns
    -------
    int
        The processors that this process may use.
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def environment(packages: Iterable[str] = ()) -> dict[str, Any]:
    """Say where a bench runs.

    Parameters
    ----------
    packages : iterable of str
        Distributions whose versions matter besides Aureole's own requirements.

    Returns
    -------
    dict
        platform, processor, processors, threads, python, versions.
    """
    own = [re.split(r"[^\w.-]", text, maxsplit=1)[0] for text in importlib.metadata.requires("aureole") or []]
    names = dict.fromkeys(["aureole", *own, *packages])
    blas = {info["internal_api"]: info["num_threads"] for info in threadpool_info()}
    return {
        "platform": platform.platform(),
        "processor": processor(),
        "processors": workers(),
        "threads": blas,
        "python": platform.python_version(),
        "versions": {name: found for name in names if (found := version(name)) is not None},
    }


def version(package: str) -> str | None:
    """Return a distribution's version.

    Parameters
    ----------
    package : str
        Its name on the package index.

    Returns
    -------
    str or None
        None where it is not installed.
    """
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def processor() -> str:
    """Return the processor's name, as far as the system tells it.

    Returns
    -------
    str
        Such as "AMD EPYC 9554".
    """
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            for line in file:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
