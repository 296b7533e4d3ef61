"""Work on many things alike, block by block on all cores."""

from __future__ import annotations

from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

BLOCK = 64
"""Ring-downs that a thread takes at a time: enough to hide the hand-over, few enough to share the work evenly."""


def in_blocks(
    work: Callable[[tuple[int, int]], None],
    size: int,
    threads: int,
    progress: Callable[[int], None] | None = None,
    block_size: int = BLOCK,
) -> None:
    """Call `work` with (begin, end) for all of range(size), block by block on a pool of threads; first once idly.

    The idle call compiles: two threads that compile at once would wait for each other anyway.
    """
    if size:
        work((0, 0))

    def counted(begin: int) -> int:
        block = (begin, min(begin + block_size, size))
        work(block)
        return block[1] - begin

    if threads == 1:  # a pool would take as long as a short sweep
        for begin in range(0, size, block_size):
            done = begin + counted(begin)
            if progress is not None:
                progress(done)
        return
    with ThreadPoolExecutor(threads) as pool:
        pending = {pool.submit(counted, begin) for begin in range(0, size, block_size)}
        done = 0
        try:
            while pending:
                finished, pending = wait(pending, timeout=0.2, return_when=FIRST_EXCEPTION)
                done += sum(future.result() for future in finished)
                if progress is not None:
                    progress(done)
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
