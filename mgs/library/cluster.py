"""The Dask cluster whose workers make the gaits: one of our own, or one that is running already."""

from __future__ import annotations

import asyncio
import contextlib
import importlib.util
import os
import signal
import time
from collections.abc import Iterator

import dask
import psutil
from dask.system import CPU_COUNT
from distributed import Client, LocalCluster, rpc
from distributed.deploy.spec import SpecCluster
from distributed.security import Security

from mgs.core.errors import MgsError
from mgs.core.foreign import described

CONNECT_TIMEOUT = 10.0  # [s]
N_LOOKS, LOOK_AGAIN = 4, 0.05  # looks for workers that are just being started, and pauses [s]
OWN_CLUSTER = {
    "distributed.nanny.pre-spawn-environ": {  # set before a worker imports numpy
        name: 1
        for name in (
            *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"),
            *("MKL_NUM_THREADS", "BLIS_NUM_THREADS"),
        )
    },
    # a gait whose worker died is tried again by us, see outcomes.py
    "distributed.scheduler.allowed-failures": 0,
    # workers come back; Dask would give up a worker that died twice in 15 s
    "distributed.deploy.lost-worker-timeout": "1000 days",
    # the profile samples the working thread a hundred times a second, for a page of the dashboard
    "distributed.worker.profile.enabled": False,
}


@contextlib.contextmanager
def cluster(workers: int | None, address: str | None, n_gaits: int) -> Iterator[Client]:
    """Client of a running cluster, or of one on this machine that ends with the context.

    Args:
        workers: number of processes on this machine; None: one for each processor.
        address: address of the scheduler of a running cluster, which is then used instead.
        n_gaits: number of gaits to make; more workers are not started.

    Raises:
        MgsError: nothing answers at the address, or the cluster there has no workers.
    """
    if address is not None:
        with _client(address) as client:
            yield client
        return
    with (
        _forgotten_if_interrupted(),
        dask.config.set(OWN_CLUSTER),
        LocalCluster(
            n_workers=min(workers or CPU_COUNT, n_gaits),
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",
        ) as own,
        Client(own) as client,
    ):
        try:
            yield client
        except BaseException:
            _kill(own)  # nobody wants the gaits any more that its workers are making
            raise


@contextlib.contextmanager
def _forgotten_if_interrupted() -> Iterator[None]:
    """Keep Dask from closing a new cluster at the end of the process after an exception.

    One that was interrupted while it started cannot be closed, and Dask then prints a traceback.
    So does a worker that has only just been started, when this process ends without telling it
    what to do.
    """
    before, children = set(SpecCluster._instances), set(psutil.Process().children())
    try:
        yield
    except BaseException:
        for own in set(SpecCluster._instances) - before:
            _kill(own)
            SpecCluster._instances.discard(own)
        for _ in range(N_LOOKS):  # a thread of Dask may be starting one just now
            for child in set(psutil.Process().children()) - children:
                with contextlib.suppress(psutil.NoSuchProcess):
                    if "resource_tracker" not in " ".join(child.cmdline()):
                        child.kill()
            time.sleep(LOOK_AGAIN)
        raise


def _kill(own: SpecCluster) -> None:
    """End the workers at once, not after the gaits that they are making."""
    for nanny in own.workers.values():
        nanny.auto_restart = False
        if getattr(nanny, "pid", None) is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(nanny.pid, signal.SIGKILL)


@contextlib.contextmanager
def _client(address: str) -> Iterator[Client]:
    try:
        # a Client waits for ever where a port accepts and nothing answers
        asyncio.run(asyncio.wait_for(_identity(address), CONNECT_TIMEOUT))
        client = Client(address, timeout=CONNECT_TIMEOUT)
    except Exception as error:  # each kind of address fails in its own way
        raise MgsError(
            f"no Dask scheduler answers at {address} within {CONNECT_TIMEOUT:g} s: "
            f"{described(error)}"
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except TimeoutError as error:
            raise MgsError(f"{address}: the cluster has no workers") from error
        yield client


async def _identity(address: str) -> object:
    """What the scheduler at an address says of itself."""
    security = Security().get_connection_args("client")
    async with rpc(address, connection_args=security) as scheduler:
        return await scheduler.identity()


def dashboard_of(client: Client) -> str | None:
    """Address of the cluster's dashboard; None where bokeh, which Dask needs for it, is missing."""
    has_bokeh = client.run_on_scheduler(lambda: importlib.util.find_spec("bokeh") is not None)
    return client.dashboard_link if has_bokeh else None
