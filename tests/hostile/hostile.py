"""What all hostile clients share: bytes sent as they are, whatever comes back, and a look at the server's memory."""
import json
import os
import re
import socket
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "contract"))

from service import GEOSIS, Service  # noqa: E402  (of the contract's tests)

PATIENCE = 2  # seconds that the servers of these tests have with a slow client
# A request that is only answered when a server takes it for one: what smuggling tries to bring in.
HIDDEN = b"GET /version HTTP/1.1\r\nHost: hidden\r\n\r\n"
HIDDEN_ANSWER = b"result_version"


def sample_survey(folder, dims="48,56,64"):
    subprocess.run([GEOSIS, "synth", folder / "survey.sgy", "--dims", dims], check=True)
    return (folder / "survey.sgy").read_bytes()


def start(folder, *flags, patience=PATIENCE, **popen):
    """A server that soon loses its patience; a context manager."""
    return Service(folder / "store", "--patience-seconds", str(patience), "--idle-seconds", "600", *flags, **popen)


def connect(address, receive_bytes=None):
    host, port = address.rsplit(":", 1)
    connection = socket.socket()
    if receive_bytes:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
    connection.settimeout(20)
    try:
        connection.connect((host, int(port)))
    except OSError:
        connection.close()
        raise
    return connection


def converse(address, *pieces, half_close=False):
    """Sends the pieces, stops when the server hangs up, and returns everything that it said until it did."""
    with connect(address) as connection:
        try:
            for piece in pieces:
                connection.sendall(piece)
            if half_close:
                connection.shutdown(socket.SHUT_WR)
        except OSError:
            pass
        return read_all(connection)


def read_all(connection):
    said = b""
    try:
        while piece := connection.recv(1 << 16):
            said += piece
    except ConnectionResetError:
        pass
    return said


def statuses(said):
    """The final statuses of all answers in what a server said."""
    found = [int(status) for status in re.findall(rb"(?:^|(?<=\n)|(?<=\}))HTTP/1\.1 (\d{3}) ", said)]
    return [status for status in found if status >= 200]


def ask(address, target, method="GET", headers="", body=b""):
    """(status, headers by lower-case name, body) of one request on a connection of its own."""
    head = f"{method} {target} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n{headers}"
    if body or method == "POST":
        head += f"Content-Length: {len(body)}\r\n"
    said = converse(address, head.encode() + b"\r\n" + body)
    head, _, rest = said.partition(b"\r\n\r\n")
    lines = head.decode("latin-1").split("\r\n")
    named = dict(line.lower().split(": ", 1) for line in lines[1:])
    return (int(lines[0].split()[1]) if lines[0] else 0), named, rest


def memory_of(process):
    """Bytes of anonymous and shared memory: file pages can be dropped and do not count."""
    text = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return sum(int(re.search(rf"{name}:\s+(\d+) kB", text).group(1)) for name in ("RssAnon", "RssShmem")) << 10


class Prober:
    """Another process that asks for something small all the time, and how long each answer took."""

    def __init__(self, address, seconds, target="/livez"):
        self._process = subprocess.Popen([sys.executable, HERE / "prober.py", address, target, str(seconds)],
                                         stdout=subprocess.PIPE, text=True)

    def result(self):
        """{"count", "failures", "p50", "p99", "max"}, in seconds."""
        said, _ = self._process.communicate(timeout=900)
        return json.loads(said)


def scale(quick, long):
    """A size of the quick form, or of the long one that HOSTILE_LONG asks for."""
    return long if os.environ.get("HOSTILE_LONG") else quick
