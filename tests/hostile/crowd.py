"""A crowd of clients that hold connections, each in its own bad manner, and come back whenever they are dropped."""
import random
import select
import threading

from hostile import connect


class Manner:
    """One way to hold a connection: what is sent first, what is dripped later, how slowly answers are read."""

    def __init__(self, name, first=b"", drip=b"", read=0, receive_bytes=None):
        self.name, self.first, self.drip, self.read, self.receive_bytes = name, first, drip, read, receive_bytes


class Crowd:
    """Holds `count` connections spread over the manners, from one thread, until it is closed; a context manager."""

    STEP = 0.1  # seconds between two drips

    def __init__(self, address, manners, count):
        self._address, self._manners, self._count = address, manners, count
        self._held = {}  # descriptor -> (socket, manner)
        self._gone = select.epoll()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.dropped = dict.fromkeys((manner.name for manner in manners), 0)
        self.refused = 0
        self.least_held = count

    def __enter__(self):
        for i in range(self._count):
            self._join(self._manners[i % len(self._manners)])
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._closing.set()
        self._thread.join()
        for client, _ in self._held.values():
            client.close()
        self._gone.close()

    def _join(self, manner):
        try:
            client = connect(self._address, manner.receive_bytes)
            client.setblocking(False)
            client.send(manner.first)
        except OSError:
            self.refused += 1
            return
        self._held[client.fileno()] = client, manner
        self._gone.register(client, select.EPOLLRDHUP)  # and failures; not what there is to read

    def _run(self):
        order = random.Random(1)
        while not self._closing.wait(self.STEP):
            for descriptor, _ in self._gone.poll(0):
                client, manner = self._held.pop(descriptor)
                self.dropped[manner.name] += 1
                client.close()
            self.least_held = min(self.least_held, len(self._held))
            for client, manner in self._held.values():
                self._act(client, manner)
            for _ in range(self._count - len(self._held)):
                self._join(order.choice(self._manners))

    @staticmethod
    def _act(client, manner):
        try:
            if manner.drip:
                client.send(manner.drip)
            if manner.read:
                client.recv(manner.read)
        except OSError:  # nothing to do, or the server has hung up
            pass
