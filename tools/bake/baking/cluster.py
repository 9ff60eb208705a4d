"""Starts workers on this machine, or connects to the workers of an existing Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import os
import shutil
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator
from multiprocessing import resource_tracker
from pathlib import Path

import dask
from distributed import Client, LocalCluster
from distributed.core import Status

PACKAGE = Path(__file__).resolve().parent
# The number of workers that may die while they bake a tile before Dask returns an error for that tile. The driver then treats
# the tile as failed.
ALLOWED_DEATHS = 10
# Makes malloc keep a tile's memory for the next tile. Otherwise the system would clear new memory pages for every tile,
# which takes longer than sorting the rows.
KEPT_MEMORY = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": str(1 << 25), "MALLOC_TRIM_THRESHOLD_": str(1 << 28)}
# The interval between two checks of the workers, in seconds.
CHECK_SECONDS = 2.0


@contextlib.contextmanager
def client(workers: int, scheduler: str | None, say: Callable[[str], None]) -> Iterator[Client]:
    """Yields a client of the given scheduler or, if that is None, of a new cluster with `workers` single-threaded
    processes on this machine. Calls `say` when a given scheduler has no workers. Ends everything that it started.
    Raises OSError if the scheduler is unreachable."""
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with tempfile.TemporaryDirectory(prefix="thicket_bake_") as scratch:
        settings = {
            "temporary-directory": scratch,
            "distributed.scheduler.allowed-failures": ALLOWED_DEATHS,
            "distributed.scheduler.worker-saturation": 1.1,
            "distributed.admin.tick.limit": "1h",
            "distributed.admin.system-monitor.gil.enabled": False,
            "distributed.worker.profile.enabled": False,
            **{f"distributed.nanny.pre-spawn-environ.{name}": value for name, value in KEPT_MEMORY.items()},
        }
        with dask.config.set(settings):
            if scheduler is not None:
                with Client(scheduler, timeout="5s", set_as_default=False) as remote:
                    remote.upload_file(_pack(Path(scratch)))
                    with watched(remote, scheduler, say):
                        yield remote
                return
            # Workers must be able to import this package.
            path = os.pathsep.join([str(PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
            with (
                _environment(PYTHONPATH=path),
                _local_cluster() as cluster,
                _constant_workers(cluster, workers),
                Client(cluster, set_as_default=False) as local,
            ):  # fmt: skip
                yield local


def _local_cluster() -> LocalCluster:
    """Returns a cluster without workers. An interrupt from the terminal is for the driver only, so the cluster's
    threads and processes inherit a signal mask that blocks it."""
    resource_tracker.ensure_running()  # If this process started later, it would unblock interrupts in this thread.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return LocalCluster(
            n_workers=0, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", memory_limit=0,
            silence_logs=logging.CRITICAL, host="127.0.0.1",
        )  # fmt: skip
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


@contextlib.contextmanager
def _constant_workers(cluster: LocalCluster, workers: int) -> Iterator[None]:
    """Starts workers and keeps their number constant, because Dask does not replace workers that are killed while they
    start."""
    def replace() -> None:
        for name, nanny in list(cluster.workers.items()):
            if nanny.status in (Status.failed, Status.closed):
                del cluster.workers[name]
        cluster.scale(workers)

    with _repeating(lambda: cluster.loop.add_callback(replace)):
        yield


@contextlib.contextmanager
def watched(client: Client, scheduler: str, say: Callable[[str], None]) -> Iterator[None]:
    """Reports when the scheduler has no workers, and when it has workers again."""
    has_workers = True

    def check() -> None:
        nonlocal has_workers
        with contextlib.suppress(OSError, TimeoutError):  # The loop that waits for tiles reports such errors.
            workers = len(client.nthreads())
            if has_workers and workers == 0:
                say(f"The scheduler at {scheduler} has no workers: the bake waits for workers to connect. Start workers, or interrupt the bake and run the same command later.")
            elif not has_workers and workers > 0:
                say(f"The scheduler at {scheduler} has workers: {workers}.")
            has_workers = workers > 0

    with _repeating(check):
        yield


@contextlib.contextmanager
def _repeating(check: Callable[[], None]) -> Iterator[None]:
    """Calls `check` in a separate thread, immediately and then every CHECK_SECONDS."""
    has_ended = threading.Event()

    def watch() -> None:
        while True:
            check()
            if has_ended.wait(CHECK_SECONDS):
                return

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        has_ended.set()
        watcher.join()


def _pack(folder: Path) -> str:
    """Packs this package into a zip file for workers on other machines. Returns its path."""
    return shutil.make_archive(str(folder / PACKAGE.name), "zip", PACKAGE.parent, PACKAGE.name)


@contextlib.contextmanager
def _environment(**variables: str) -> Iterator[None]:
    old_values = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in old_values.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
