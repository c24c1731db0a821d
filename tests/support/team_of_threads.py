"""A communicator whose processes are threads of this one."""

import threading
from concurrent.futures import ThreadPoolExecutor


class Member:
    """What `mpi4py.MPI.Comm` has of what is asked for."""

    def __init__(self, rank, size, barrier, shared):
        self.rank, self.size, self._barrier, self._shared = rank, size, barrier, shared

    def allgather(self, sendobj):
        self._shared[self.rank] = sendobj
        self._barrier.wait()
        found = list(self._shared)
        self._barrier.wait()
        return found

    def Alltoallv(self, sendbuf, recvbuf):
        received, (counts, starts) = recvbuf
        for rank, (sent, (to_each, first)) in enumerate(self.allgather(sendbuf)):
            assert to_each[self.rank] == counts[rank]
            own = sent[first[self.rank] : first[self.rank] + counts[rank]]
            received[starts[rank] : starts[rank] + counts[rank]] = own
        self._barrier.wait()


def together(size, work):
    """What a function of a communicator returns in each of so many processes."""
    barrier, shared = threading.Barrier(size), [None] * size

    def one(rank):
        try:
            return work(Member(rank, size, barrier, shared))
        except BaseException:
            barrier.abort()
            raise

    with ThreadPoolExecutor(size) as pool:
        return list(pool.map(one, range(size)))
