"""Requests that two servers could read differently: none of them brings a hidden request in.

Each form is followed by a request that would be answered if the server took the form's end for somewhere else. Besides:
heads and bodies without bounds, and ranges that multiply. Environment: GEOSIS = the built binary.
"""
import gzip
import shutil
import tempfile
import unittest
from pathlib import Path

from hostile import HIDDEN, HIDDEN_ANSWER, ask, converse, memory_of, sample_survey, start, statuses

POST = b"POST /v1/volumes/x/extractions HTTP/1.1\r\nHost: a\r\n"
UPLOAD = b"POST /v1/volumes?format=raw&dims=1,1,1 HTTP/1.1\r\nHost: a\r\n"
GET = b"GET /livez HTTP/1.1\r\nHost: a\r\n"
CHUNKED = b"Transfer-Encoding: chunked\r\n"
LENGTH = f"Content-Length: {len(HIDDEN)}\r\n".encode()
EMPTY_CHUNKS = b"0\r\n\r\n"
MEGABYTE = 1 << 20


def setUpModule():
    global FOLDER, SERVICE
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-hostile-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    SERVICE = unittest.enterModuleContext(start(FOLDER))


# Heads whose length of body is in doubt: (name, head without its empty line, what follows it).
BODIES_IN_DOUBT = [
    ("length and chunked", POST + b"Content-Length: 5\r\n" + CHUNKED, EMPTY_CHUNKS),
    ("chunked and length", POST + CHUNKED + b"Content-Length: 5\r\n", EMPTY_CHUNKS),
    ("two lengths", POST + b"Content-Length: 0\r\n" + LENGTH, b""),
    ("the same length twice", POST + b"Content-Length: 0\r\nContent-Length: 0\r\n", b""),
    ("a list of lengths", POST + b"Content-Length: 0, 0\r\n", b""),
    ("plus", POST + b"Content-Length: +0\r\n", b""),
    ("minus", POST + b"Content-Length: -1\r\n", b""),
    ("a letter behind", POST + b"Content-Length: 0x\r\n", b""),
    ("hexadecimal", POST + b"Content-Length: 0x0\r\n", b""),
    ("a space within", POST + b"Content-Length: 0 0\r\n", b""),
    ("no digits", POST + b"Content-Length: \r\n", b""),
    ("a fraction", POST + b"Content-Length: 0.0\r\n", b""),
    ("beyond 64 bits", POST + b"Content-Length: 18446744073709551616\r\n", b""),
    ("digits of another script", POST + "Content-Length: \u0660\r\n".encode(), b""),
    ("chunked, gzip", POST + b"Transfer-Encoding: chunked, gzip\r\n", EMPTY_CHUNKS),
    ("gzip, chunked", POST + b"Transfer-Encoding: gzip, chunked\r\n", EMPTY_CHUNKS),
    ("chunked twice in a line", POST + b"Transfer-Encoding: chunked, chunked\r\n", EMPTY_CHUNKS),
    ("chunked in two lines", POST + CHUNKED + CHUNKED, EMPTY_CHUNKS),
    ("identity", POST + b"Transfer-Encoding: identity\r\n", b""),
    ("not quite chunked", POST + b"Transfer-Encoding: xchunked\r\n", EMPTY_CHUNKS),
    ("quoted", POST + b'Transfer-Encoding: "chunked"\r\n', EMPTY_CHUNKS),
    ("vertical tab", POST + b"Transfer-Encoding: \x0bchunked\r\n", EMPTY_CHUNKS),
    ("space before the colon", POST + b"Transfer-Encoding : chunked\r\n", EMPTY_CHUNKS),
    ("space before the name", POST + b" Transfer-Encoding: chunked\r\n", EMPTY_CHUNKS),
    ("folded value", POST + b"Transfer-Encoding:\r\n chunked\r\n", EMPTY_CHUNKS),
    ("folded header", POST + b"X: y\r\n\tContent-Length: 0\r\n", b""),
    ("another name", POST + b"Transfer_Encoding: chunked\r\n", EMPTY_CHUNKS),
    ("no length", POST, b""),
    ("length in a bare line", POST + b"X: y\nContent-Length: 0\r\n", b""),
    ("bare return", POST + b"X: y\rContent-Length: 0\r\n", b""),
    ("zero byte", POST + b"X: \x00\r\nContent-Length: 0\r\n", b""),
    ("body of GET", GET + LENGTH, b""),
    ("chunked body of GET", GET + CHUNKED, EMPTY_CHUNKS),
    ("body of HEAD", b"HEAD /livez HTTP/1.1\r\nHost: a\r\n" + LENGTH, b""),
    ("body of OPTIONS", b"OPTIONS /livez HTTP/1.1\r\nHost: a\r\n" + LENGTH, b""),
    ("body of an unknown method", b"BREW /livez HTTP/1.1\r\nHost: a\r\n" + LENGTH, b""),
    ("body of PUT", b"PUT /livez HTTP/1.1\r\nHost: a\r\n" + LENGTH, b""),
]

# Heads that are no request in themselves.
HEADS_IN_DOUBT = [
    ("no host", b"GET /livez HTTP/1.1\r\n"),
    ("two hosts", GET + b"Host: b\r\n"),
    ("host with a path", b"GET /livez HTTP/1.1\r\nHost: a/b\r\n"),
    ("host with a user", b"GET /livez HTTP/1.1\r\nHost: a@b\r\n"),
    ("list of hosts", b"GET /livez HTTP/1.1\r\nHost: a, b\r\n"),
    ("absolute target", b"GET http://b/livez HTTP/1.1\r\nHost: a\r\n"),
    ("old version", b"GET /livez HTTP/1.0\r\nHost: a\r\n"),
    ("version 0.9", b"GET /livez\r\n"),
    ("version 2", b"PRI * HTTP/2.0\r\n"),
    ("version with more", b"GET /livez HTTP/1.1x\r\nHost: a\r\n"),
    ("two spaces", b"GET  /livez HTTP/1.1\r\nHost: a\r\n"),
    ("tab for a space", b"GET\t/livez HTTP/1.1\r\nHost: a\r\n"),
    ("space in front", b" GET /livez HTTP/1.1\r\nHost: a\r\n"),
    ("space behind", b"GET /livez HTTP/1.1 \r\nHost: a\r\n"),
    ("lower case", b"get /livez HTTP/1.1\r\nHost: a\r\n"),
    ("connect", b"CONNECT a:80 HTTP/1.1\r\nHost: a\r\n"),
    ("trace", b"TRACE /livez HTTP/1.1\r\nHost: a\r\n"),
    ("fragment", b"GET /livez#x HTTP/1.1\r\nHost: a\r\n"),
    ("eighth bit", b"GET /\xc3\xa4 HTTP/1.1\r\nHost: a\r\n"),
    ("zero byte in the target", b"GET /liv\x00ez HTTP/1.1\r\nHost: a\r\n"),
    ("no colon", GET + b"Nothing\r\n"),
    ("no name", GET + b": x\r\n"),
    ("name with a space", GET + b"A B: x\r\n"),
    ("name with a bracket", GET + b"A(B): x\r\n"),
    ("delete character", GET + b"A: \x7f\r\n"),
    ("unknown expectation", GET + b"Expect: 200-maybe\r\n"),
    ("handshake of TLS", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n"),
]

# Chunked bodies that are none; each is tried against a small body and an upload.
BROKEN_CHUNKS = [
    ("plus", b"+5\r\nhello\r\n0\r\n\r\n"),
    ("minus", b"-5\r\nhello\r\n0\r\n\r\n"),
    ("prefix", b"0x5\r\nhello\r\n0\r\n\r\n"),
    ("space behind", b"5 \r\nhello\r\n0\r\n\r\n"),
    ("space in front", b" 5\r\nhello\r\n0\r\n\r\n"),
    ("no digits", b"\r\nhello\r\n0\r\n\r\n"),
    ("no hexadecimal", b"5g\r\nhello\r\n0\r\n\r\n"),
    ("underscore", b"0_5\r\nhello\r\n0\r\n\r\n"),
    ("sixteen digits", b"f" * 16 + b"\r\nhello"),
    ("a megabyte of zeros", b"0" * MEGABYTE + b"5\r\nhello\r\n0\r\n\r\n"),
    ("bare line end", b"5\nhello\r\n0\r\n\r\n"),
    ("bare return", b"5\rhello\r\n0\r\n\r\n"),
    ("data too long", b"3\r\nhello\r\n0\r\n\r\n"),
    ("data too short", b"6\r\nhello\r\n0\r\n\r\n"),
    ("no end of data", b"5\r\nhello0\r\n\r\n"),
    ("flood of extensions", b"5;" + b"x" * MEGABYTE + b"\r\nhello\r\n0\r\n\r\n"),
    ("flood of small extensions", b"1;abcdefghij\r\nx\r\n" * 20_000 + b"0\r\n\r\n"),
    ("extension with a line end", b"5;a\nb\r\nhello\r\n0\r\n\r\n"),
    ("flood of trailers", b"0\r\n" + b"A: b\r\n" * 100_000 + b"\r\n"),
    ("folded trailer in a bare line", b"0\r\nA: b\nC: d\r\n\r\n"),
]


class Smuggling(unittest.TestCase):
    def assert_refused(self, said, name):
        self.assertNotIn(HIDDEN_ANSWER, said, name)
        self.assertEqual(len(statuses(said)), 1, f"{name}: {said[:500]}")
        self.assertGreaterEqual(statuses(said)[0], 400, name)

    def test_a_request_behind_a_clear_one_is_answered(self):
        """Otherwise the tests below would prove nothing."""
        for name, request in (("length", POST + b"Content-Length: 5\r\n\r\nhello"),
                              ("chunked", POST + CHUNKED + b"\r\n5;a=b\r\nhello\r\n0\r\nTrailer: x\r\n\r\n"),
                              ("none", GET + b"\r\n")):
            self.assertIn(HIDDEN_ANSWER, converse(SERVICE.address, request + HIDDEN, half_close=True), name)

    def test_a_body_whose_length_is_in_doubt_ends_the_connection(self):
        for name, head, body in BODIES_IN_DOUBT:
            self.assert_refused(converse(SERVICE.address, head + b"\r\n" + body + HIDDEN), name)
            self.assert_refused(converse(SERVICE.address, head, b"\r\n", body, HIDDEN), f"{name}, in pieces")

    def test_a_head_in_doubt_ends_the_connection(self):
        for name, head in HEADS_IN_DOUBT:
            self.assert_refused(converse(SERVICE.address, head + b"\r\n" + HIDDEN), name)

    def test_bare_line_ends_are_no_line_ends(self):
        said = converse(SERVICE.address, b"GET /livez HTTP/1.1\nHost: a\n\n" + HIDDEN)
        self.assertLessEqual(len(statuses(said)), 1)
        self.assertNotIn(HIDDEN_ANSWER, said)

    def test_a_broken_chunk_ends_the_connection(self):
        for name, chunks in BROKEN_CHUNKS:
            for path, head in (("small", POST), ("upload", UPLOAD)):
                said = converse(SERVICE.address, head + CHUNKED + b"\r\n" + chunks + HIDDEN, half_close=True)
                self.assertNotIn(HIDDEN_ANSWER, said, f"{name}, {path}")
                self.assertTrue(all(status >= 400 for status in statuses(said)), f"{name}, {path}: {said[:200]}")

    def test_trailers_are_no_headers(self):
        trailer = b"0\r\nContent-Length: 1000\r\nTransfer-Encoding: chunked\r\nHost: b\r\n\r\n"
        said = converse(SERVICE.address, POST + CHUNKED + b"\r\n" + trailer + HIDDEN, half_close=True)
        self.assertIn(HIDDEN_ANSWER, said)

    def test_what_follows_an_upload_is_not_a_request(self):
        said = converse(SERVICE.address, UPLOAD + b"Content-Length: 4\r\n\r\n1234" + HIDDEN)
        self.assertNotIn(HIDDEN_ANSWER, said)
        self.assertEqual(len(statuses(said)), 1)


class Bounds(unittest.TestCase):
    """The server's memory stays flat, whatever is sent."""

    def setUp(self):
        self.before = memory_of(SERVICE.process)

    def tearDown(self):
        self.assertLess(memory_of(SERVICE.process) - self.before, 24 * MEGABYTE)
        self.assertEqual(ask(SERVICE.address, "/livez")[0], 200)

    def test_endless_request_lines_and_headers(self):
        for status, start_of_head in ((414, b"GET /"), (431, GET + b"A: "), (431, GET + b"A")):
            said = converse(SERVICE.address, start_of_head, *[b"a" * MEGABYTE] * 64)
            self.assertEqual(statuses(said) or [status], [status])

    def test_endless_many_headers(self):
        said = converse(SERVICE.address, GET, *[b"A: b\r\n" * 10_000] * 100)
        self.assertEqual(statuses(said) or [431], [431])
        self.assertEqual(ask(SERVICE.address, "/livez", headers="A: b\r\n" * 99)[0], 431)
        self.assertEqual(ask(SERVICE.address, "/livez", headers="A: b\r\n" * 90)[0], 200)

    def test_bodies_beyond_the_limit_are_refused_before_they_are_sent(self):
        for name, head, status in (("upload", UPLOAD, 413), ("small", POST, 413),
                                   ("no such path", b"POST /nothing HTTP/1.1\r\nHost: a\r\n", 404),
                                   ("no such method", b"PATCH /livez HTTP/1.1\r\nHost: a\r\n", 405)):
            said = converse(SERVICE.address, head + b"Content-Length: 900000000000000\r\n\r\n")
            self.assertEqual(statuses(said), [status], name)

    def test_endless_chunked_bodies(self):
        chunk = b"100000\r\n" + b"x" * MEGABYTE + b"\r\n"
        for name, head, status in (("small", POST, 413), ("no such path", b"POST /nothing HTTP/1.1\r\nHost: a\r\n", 404),
                                   ("no such method", b"PATCH /livez HTTP/1.1\r\nHost: a\r\n", 405)):
            said = converse(SERVICE.address, head + CHUNKED + b"\r\n", *[chunk] * 64)
            self.assertEqual(statuses(said) or [status], [status], name)

    def test_tiny_chunks(self):
        said = converse(SERVICE.address, POST + CHUNKED + b"\r\n" + b"1\r\nx\r\n" * 60_000 + EMPTY_CHUNKS, half_close=True)
        self.assertEqual(statuses(said), [400])  # no JSON

    def test_packed_bodies_stay_packed(self):
        bomb = gzip.compress(bytes(64 * MEGABYTE))
        for head in (POST, UPLOAD):
            for coding in (b"gzip", b"deflate", b"br", b"gzip, identity"):
                length = f"Content-Length: {len(bomb)}\r\n".encode()
                said = converse(SERVICE.address, head + length + b"Content-Encoding: " + coding + b"\r\n\r\n" + bomb)
                self.assertEqual(statuses(said), [415])

    def test_deep_json(self):
        body = b"[" * 60_000
        self.assertEqual(ask(SERVICE.address, "/v1/volumes/x/extractions", "POST", body=body)[0] // 100, 4)


class Ranges(unittest.TestCase):
    """Ranges never multiply an answer, nor reach beyond it."""

    @classmethod
    def setUpClass(cls):
        status, _, cls.whole = ask(SERVICE.address, "/openapi.yaml")
        assert status == 200

    def answer(self, text):
        return ask(SERVICE.address, "/openapi.yaml", headers=f"Range: {text}\r\n")

    def test_many_ranges_are_none(self):
        for text in ("bytes=" + ",".join(["0-"] * 1300), "bytes=0-1,2-3", "bytes=" + ",".join(f"{n}-" for n in range(900))):
            status, _, body = self.answer(text)
            self.assertEqual((status, len(body)), (200, len(self.whole)))

    def test_a_range_stays_within(self):
        size = len(self.whole)
        for text, first, last in ((f"bytes=0-{size * 9}", 0, size), ("bytes=5-9", 5, 10), ("bytes=-4", size - 4, size),
                                  (f"bytes=-{2**63}", 0, size), (f"bytes=1-{2**64 - 1}", 1, size)):
            status, headers, body = self.answer(text)
            self.assertEqual((status, body), (206, self.whole[first:last]), text)
            self.assertEqual(headers["content-range"], f"bytes {first}-{last - 1}/{size}")
        for text in (f"bytes={size}-", f"bytes={2**64 - 1}-", "bytes=-0"):
            self.assertEqual(self.answer(text)[0], 416, text)
        for text in ("bytes=9-5", "bytes=a-b", "bytes=--1", "lines=0-1", "bytes=", f"bytes={2**64}-", "bytes=+1-2"):
            status, _, body = self.answer(text)
            self.assertEqual((status, body), (200, self.whole), text)


if __name__ == "__main__":
    unittest.main()
