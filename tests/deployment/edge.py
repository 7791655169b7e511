"""docker/nginx.conf as a running nginx on free ports, and servers for it to stand before.

Environment: NGINX = the program; none when the machine has none.
"""
import http.client
import os
import shutil
import socket
import subprocess
import threading
import time
import unittest
from pathlib import Path

CONFIGURATION = Path(__file__).resolve().parents[2] / "docker" / "nginx.conf"
NGINX = os.environ.get("NGINX") or shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")


def need_nginx():
    if not NGINX:
        raise unittest.SkipTest("no nginx here: ./test fetches one into build/nginx")


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Edge:
    """nginx as docker/nginx.conf says, but for addresses and folders; a context manager.

    stands   how long kept answers stand.    rate   of one address's requests.    more   what edge.d/*.conf says.
    """

    def __init__(self, folder, http_server, grpc_server="127.0.0.1:9", stands="60s", rate="200r/s", more=""):
        self.folder = Path(folder) / f"edge-{free_port()}"
        for name in ("tmp", "cache", "edge.d"):
            (self.folder / name).mkdir(parents=True)
        self.address, self.http2_address = (f"127.0.0.1:{free_port()}" for _ in range(2))
        (self.folder / "edge.d" / "more.conf").write_text(more)
        (self.folder / "nginx.conf").write_text(self._rendered(http_server, grpc_server, stands, rate))

    def _rendered(self, http_server, grpc_server, stands, rate):
        text = CONFIGURATION.read_text()
        for said, meant, times in (
                ("listen 8080;", f"listen {self.address};", 1), ("listen 8081 http2;", f"listen {self.http2_address} http2;", 1),
                ("geosis:8080", http_server, 1), ("geosis:8081", grpc_server, 1),
                ("/tmp/", f"{self.folder}/tmp/", 6), ("/var/cache/edge levels", f"{self.folder}/cache levels", 1),
                ("/etc/nginx/edge.d", f"{self.folder}/edge.d", 1), ("/dev/stdout", f"{self.folder}/access.log", 1),
                ("error_log stderr", f"error_log {self.folder}/error.log", 1),
                ("proxy_cache_valid 200 60s", f"proxy_cache_valid 200 {stands}", 1), ("rate=200r/s", f"rate={rate}", 1)):
            if text.count(said) != times:
                raise AssertionError(f"docker/nginx.conf says {said!r} {text.count(said)} times, not {times}")
            text = text.replace(said, meant)
        # Where its workers would give up root, they keep it: the folders are this test's own.
        return ("user root;\n" if os.geteuid() == 0 else "") + text

    def __enter__(self):
        self.process = subprocess.Popen([NGINX, "-c", self.folder / "nginx.conf", "-e", self.folder / "start.log"],
                                        stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                connect(self.address).close()
                return self
            except OSError:
                time.sleep(0.02)
        self.process.kill()
        raise RuntimeError(f"nginx did not start: {self.errors()}")

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=30)

    def errors(self):
        return "".join(file.read_text() for name in ("start.log", "error.log") if (file := self.folder / name).exists())

    def log(self):
        return (self.folder / "access.log").read_text()

    def worker_memory(self):
        """Bytes of anonymous memory of all workers."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        return sum(int(line.split()[1]) << 10 for child in children
                   for line in Path(f"/proc/{child}/status").read_text().splitlines() if line.startswith("RssAnon"))

    def call(self, method, target, body=None, source="127.0.0.1", **headers):
        """(status, headers by lower-case name, body). Headers have underscores for dashes."""
        connection = http.client.HTTPConnection(self.address, timeout=60, source_address=(source, 0))
        try:
            connection.request(method, target, body, {name.replace("_", "-"): value for name, value in headers.items()})
            reply = connection.getresponse()
            return reply.status, {name.lower(): value for name, value in reply.getheaders()}, reply.read()
        finally:
            connection.close()


def connect(address, source="127.0.0.1"):
    host, port = address.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=20, source_address=(source, 0))


class StandIn:
    """A server that answers as it is told, for what must be seen from behind the edge; a context manager.

    script   called with each connection and the head that came on it, in a thread of its own.
    """

    def __init__(self, script):
        self._script = script
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=512)
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"

    def __enter__(self):
        threading.Thread(target=self._serve, daemon=True).start()
        return self

    def __exit__(self, *_):
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _serve(self):
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            threading.Thread(target=self._answer, args=(connection,), daemon=True).start()

    def _answer(self, connection):
        with connection:
            connection.settimeout(20)
            said = b""
            while b"\r\n\r\n" not in said and (piece := connection.recv(1 << 16)):
                said += piece
            head, _, rest = said.partition(b"\r\n\r\n")
            try:
                self._script(connection, head.decode("latin-1"), rest)
            except OSError:
                pass
