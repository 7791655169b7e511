"""HTTP/2 frames by hand: what no library would send."""
import struct
import time

from hostile import connect

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
DATA, HEADERS, RST_STREAM, SETTINGS, PING, GOAWAY, WINDOW_UPDATE, CONTINUATION = 0, 1, 3, 4, 6, 7, 8, 9
END_STREAM, END_HEADERS, ACK = 1, 4, 1
INITIAL_WINDOW_SIZE = 4
HEALTH = "/grpc.health.v1.Health/Check"
EMPTY_MESSAGE = bytes(5)  # not compressed, no bytes


def frame(kind, flags=0, stream=0, payload=b""):
    return struct.pack(">I", len(payload))[1:] + bytes((kind, flags)) + struct.pack(">I", stream) + payload


def settings(**values):
    names = {"window": INITIAL_WINDOW_SIZE}
    return frame(SETTINGS, payload=b"".join(struct.pack(">HI", names[name], value) for name, value in values.items()))


def literal(name, value):
    """A header field that is not indexed, as plain text."""
    name, value = name.encode(), value.encode()
    return b"\0" + bytes((len(name),)) + name + bytes((len(value),)) + value


def call_headers(path):
    fields = {":method": "POST", ":scheme": "http", ":path": path, ":authority": "hostile", "te": "trailers",
              "content-type": "application/grpc"}
    return b"".join(literal(name, value) for name, value in fields.items())


def open_stream(stream, path):
    return frame(HEADERS, END_HEADERS, stream, call_headers(path))


def start_connection(address, **values):
    """A connection whose greeting is sent."""
    connection = connect(address)
    connection.sendall(PREFACE + settings(**values))
    return connection


def frames(connection):
    """What the server says, frame by frame, until it hangs up: (kind, flags, stream, payload)."""
    buffer = b""
    while True:
        while len(buffer) < 9 or len(buffer) < 9 + int.from_bytes(buffer[:3], "big"):
            try:
                piece = connection.recv(1 << 16)
            except (ConnectionResetError, BrokenPipeError):
                return
            if not piece:
                return
            buffer += piece
        length = int.from_bytes(buffer[:3], "big")
        yield buffer[3], buffer[4], int.from_bytes(buffer[5:9], "big"), buffer[9:9 + length]
        buffer = buffer[9 + length:]


def is_serving(address, patience=5):
    """Whether a new connection's question for its health is answered with SERVING."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        try:
            with start_connection(address) as connection:
                connection.settimeout(max(end - time.monotonic(), 0.1))
                connection.sendall(frame(SETTINGS, ACK) + open_stream(1, HEALTH) + frame(DATA, END_STREAM, 1, EMPTY_MESSAGE))
                for kind, _, stream, payload in frames(connection):
                    if kind == DATA and stream == 1:
                        return payload == b"\0\0\0\0\2\x08\1"
        except OSError:
            pass
        time.sleep(0.1)
    return False
