"""docker/nginx.conf before a running server: what it keeps, lets through as it comes, refuses, and hides.

Environment: GEOSIS = the built binary; NGINX.
"""
import contextlib
import hashlib
import json
import select
import shutil
import socket
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "contract"))

from edge import Edge, StandIn, connect, free_port, need_nginx  # noqa: E402
from service import GEOSIS, Service  # noqa: E402

SOON = 5  # seconds; what would not come before the end of a body or stream takes 20


def setUpModule():
    global FOLDER, SURVEY
    need_nginx()
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-edge-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    subprocess.run([GEOSIS, "synth", FOLDER / "survey.sgy", "--dims", "40,44,48"], check=True)
    SURVEY = (FOLDER / "survey.sgy").read_bytes()


def serve(store, *flags):
    return Service(FOLDER / store, "--admin", "", "--log-level", "error", *flags, stderr=subprocess.DEVNULL)


def json_of(call):
    status, headers, body = call
    return status, headers, json.loads(body)


def extraction_of(edge, **headers):
    """The addresses of a volume and of its finished extraction, both made through the edge."""
    _, _, volume = json_of(edge.call("POST", "/v1/volumes", SURVEY, **headers))
    address = f"/v1/volumes/{volume['id']}"
    request = json.dumps({"range": [0.5, None]})
    status, _, extraction = json_of(edge.call("POST", f"{address}/extractions", request, Prefer="wait=60", **headers))
    assert status == 200 and extraction["state"] == "done", extraction
    return address, f"/v1/extractions/{extraction['id']}"


class KeptAnswers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.service = cls.enterClassContext(serve("kept"))
        cls.edge = cls.enterClassContext(Edge(FOLDER, cls.service.address))
        cls.volume, cls.extraction = extraction_of(cls.edge)

    def test_the_second_reader_of_a_level_costs_the_server_nothing(self):
        for path in ("manifest", "bodies", "lods/0.glb", "lods/3/parts/0.drc"):
            with self.subTest(path):
                first, second = (self.edge.call("GET", f"{self.extraction}/{path}") for _ in range(2))
                self.assertEqual([first[0], first[1]["x-cache"], second[0], second[1]["x-cache"]], [200, "MISS", 200, "HIT"])
                self.assertTrue(first[2] == second[2])
                self.assertEqual(first[1]["etag"], second[1]["etag"])
                self.assertIn("immutable", second[1]["cache-control"])
                self.assertNotEqual(first[1]["x-request-id"], second[1]["x-request-id"])
        self.assertEqual(f'"{hashlib.sha256(second[2]).hexdigest()}"', second[1]["etag"])

    def test_ranges_and_conditions_are_answered_from_what_is_kept(self):
        target = f"{self.extraction}/lods/2.ply"
        _, headers, whole = self.edge.call("GET", target)
        status, ranged, piece = self.edge.call("GET", target, Range="bytes=100-299")
        self.assertEqual([status, ranged["x-cache"], piece == whole[100:300]], [206, "HIT", True])
        self.assertEqual(ranged["content-range"], f"bytes 100-299/{len(whole)}")
        self.assertEqual(self.edge.call("GET", target, If_None_Match=headers["etag"])[0], 304)
        status, head, nothing = self.edge.call("HEAD", target)
        self.assertEqual([status, head["content-length"], nothing], [200, str(len(whole)), b""])

    def test_a_first_reader_of_a_range_gets_it(self):
        target = f"{self.extraction}/lods/1.stl"
        status, headers, piece = self.edge.call("GET", target, Range="bytes=80-183")
        self.assertEqual([status, headers["x-cache"], len(piece)], [206, "MISS", 104])
        self.assertTrue(self.edge.call("GET", target)[2][80:184] == piece)

    def test_what_changes_and_what_fails_is_not_kept(self):
        for target in (self.volume, self.extraction, f"{self.extraction}/lods/99.drc", f"/v1/extractions/{'0' * 64}/manifest"):
            for _ in range(2):
                self.assertNotEqual(self.edge.call("GET", target)[1].get("x-cache"), "HIT", target)


class Rights(unittest.TestCase):
    def test_a_removed_result_is_away_once_it_was_asked_for_again(self):
        with serve("removed") as service, Edge(FOLDER, service.address, stands="1s") as edge:
            volume, extraction = extraction_of(edge)
            level = f"{extraction}/lods/0.drc"
            edge.call("GET", level)
            time.sleep(2.1)
            self.assertEqual(edge.call("GET", level)[1]["x-cache"], "REVALIDATED")
            self.assertEqual(edge.call("DELETE", volume)[0], 204)
            time.sleep(2.1)
            self.assertEqual(edge.call("GET", level)[0], 404)

    def test_nobody_reads_what_is_kept_with_anothers_key(self):
        keys, lines = [], []
        for name, tenant in (("one", "first"), ("two", "second")):
            made = subprocess.run([GEOSIS, "key", "--name", name, "--tenant", tenant], capture_output=True, text=True, check=True)
            key, line = made.stdout.splitlines()
            keys.append(f"Bearer {key}")
            lines.append(line)
        (FOLDER / "keys").write_text("\n".join(lines) + "\n")
        with (serve("keyed", "--auth", "api_keys", str(FOLDER / "keys")) as service,
              Edge(FOLDER, service.address) as edge):
            _, extraction = extraction_of(edge, Authorization=keys[0])
            level = f"{extraction}/lods/0.drc"
            kept = [edge.call("GET", level, Authorization=keys[0])[1]["x-cache"] for _ in range(2)]
            self.assertEqual(kept, ["MISS", "HIT"])
            self.assertEqual(edge.call("GET", level)[0], 401)
            self.assertEqual(edge.call("GET", level, Authorization=keys[1])[0], 404)


class WayThrough(unittest.TestCase):
    """What is seen from behind the edge."""

    def test_a_body_arrives_while_it_is_sent(self):
        arrived = threading.Event()

        def script(connection, _, rest):
            while len(rest) < 1000:
                rest += connection.recv(1 << 16)
            arrived.set()
            connection.recv(1)

        with StandIn(script) as server, Edge(FOLDER, server.address) as edge, connect(edge.address) as client:
            client.sendall(b"POST /v1/volumes HTTP/1.1\r\nHost: a\r\nContent-Length: 1000000\r\n\r\n" + bytes(1000))
            self.assertTrue(arrived.wait(SOON))

    def test_streams_arrive_while_they_are_made(self):
        def script(connection, _, __):
            connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nTransfer-Encoding: chunked\r\n\r\n"
                               b"7\r\n: now\n\n\r\n")
            connection.recv(1)

        with StandIn(script) as server, Edge(FOLDER, server.address) as edge:
            for method, target in (("GET", "/v1/extractions/a/events"), ("GET", "/v1/extractions/a/stream"),
                                   ("POST", "/v1/volumes/a/extractions"), ("POST", "/v1/extract")):
                with self.subTest(target), connect(edge.address) as client:
                    client.settimeout(SOON)
                    client.sendall(f"{method} {target} HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n".encode())
                    said = b""
                    while b": now" not in said:
                        said += client.recv(1 << 16)

    def test_servers_learn_who_asks_and_under_which_id(self):
        heads = []

        def script(connection, head, _):
            heads.append(dict(line.lower().split(": ", 1) for line in head.split("\r\n")[1:]))
            connection.sendall(b"HTTP/1.1 204 No Content\r\nX-Request-Id: another\r\n\r\n")

        with StandIn(script) as server, Edge(FOLDER, server.address) as edge:
            _, answered, _ = edge.call("GET", "/v1/volumes", X_Request_Id="mine-1", traceparent="00-aa-bb-01",
                                       X_Forwarded_For="6.6.6.6", Authorization="Bearer k")
            self.assertEqual([heads[0]["x-request-id"], answered["x-request-id"]], ["mine-1", "mine-1"])
            self.assertEqual([heads[0][name] for name in ("x-forwarded-for", "x-forwarded-proto", "traceparent", "authorization")],
                             ["127.0.0.1", "http", "00-aa-bb-01", "bearer k"])
            _, answered, _ = edge.call("GET", "/v1/volumes", X_Request_Id="two words")
            self.assertRegex(answered["x-request-id"], "^[0-9a-f]{32}$")
            self.assertEqual(heads[1]["x-request-id"], answered["x-request-id"])
            deadline = time.monotonic() + SOON
            while edge.log().count("\n") < 2 and time.monotonic() < deadline:  # lines are written after the answers
                time.sleep(0.02)
            self.assertIn("mine-1", [json.loads(line)["request_id"] for line in edge.log().splitlines()])


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.service = cls.enterClassContext(serve("refusals"))
        cls.edge = cls.enterClassContext(Edge(FOLDER, cls.service.address))

    def status_before_body(self, target, length, headers=""):
        with connect(self.edge.address) as client:
            client.settimeout(SOON)
            client.sendall(f"POST {target} HTTP/1.1\r\nHost: a\r\nContent-Length: {length}\r\n{headers}\r\n".encode())
            said = client.recv(1 << 16)
            return int(said.split()[1]), said.lower()

    def test_too_large_is_said_before_the_body(self):
        for target, length in (("/v1/volumes", 100 << 30), ("/v1/extract?range=0,1", 100 << 30),
                               (f"/v1/volumes/{'0' * 64}/extractions", 100_000), ("/v1/volumes/x", 100_000)):
            status, said = self.status_before_body(target, length)
            self.assertEqual(status, 413, target)
            self.assertIn(b"application/problem+json", said)
            self.assertIn(b'"code":"limit_exceeded"', said)

    def test_the_servers_own_refusals_come_before_the_body_too(self):
        self.assertEqual(self.status_before_body("/v1/volumes", 1 << 30, "Content-Encoding: gzip\r\n")[0], 415)

    def test_long_heads_and_broken_framing_end_here(self):
        for head, expected in ((b"GET /version HTTP/1.1\r\nHost: a\r\n" + b"A: " + b"x" * 40_000 + b"\r\n\r\n", 400),
                               (b"GET /" + b"x" * 40_000 + b" HTTP/1.1\r\nHost: a\r\n\r\n", 414),
                               (b"POST /v1/volumes HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
                                400)):
            with connect(self.edge.address) as client:
                try:
                    client.sendall(head)
                except OSError:
                    pass
                self.assertEqual(int(client.recv(4096).split()[1]), expected)

    def test_metrics_stay_behind_it(self):
        self.assertEqual(self.edge.call("GET", "/metrics")[0], 404)
        self.assertEqual([self.edge.call("GET", path)[0] for path in ("/livez", "/readyz", "/version", "/edge/livez")],
                         [200, 200, 200, 204])

    def test_one_address_gets_no_more_than_its_share(self):
        with Edge(FOLDER, self.service.address, rate="1r/m") as edge, connect(edge.address, source="127.0.0.2") as client:
            sender = threading.Thread(target=client.sendall, args=(b"GET /version HTTP/1.1\r\nHost: a\r\n\r\n" * 401
                                                                   + b"GET /version HTTP/1.0\r\n\r\n",))
            sender.start()
            said = b""
            while piece := client.recv(1 << 16):
                said += piece
            sender.join()
            self.assertEqual([said.count(b"HTTP/1.1 200 OK"), said.count(b"HTTP/1.1 429 ")], [401, 1])
            self.assertTrue(b'"code":"quota_exceeded"' in said and b"Retry-After: 1" in said)
            self.assertEqual(edge.call("GET", "/version")[0], 200, "another address is not judged by this one")

    def test_connections_of_one_address_are_bounded(self):
        with (StandIn(lambda connection, *_: connection.recv(1)) as server, Edge(FOLDER, server.address) as edge,
              contextlib.ExitStack() as held):
            clients = [held.enter_context(connect(edge.address, source="127.0.0.3")) for _ in range(260)]
            for client in clients:
                client.sendall(b"GET /v1/extractions/a/events HTTP/1.1\r\nHost: a\r\n\r\n")
            refused = set()
            deadline = time.monotonic() + SOON
            while len(refused) < 4 and time.monotonic() < deadline:
                refused |= set(select.select(clients, [], [], 0.1)[0])
            self.assertEqual([client.recv(4096).split()[1] for client in refused], [b"429"] * 4)

    def test_without_servers_it_says_so_and_still_has_what_it_kept(self):
        service = serve("gone")
        with service, Edge(FOLDER, service.address, stands="1s") as edge:
            _, extraction = extraction_of(edge)
            level = f"{extraction}/lods/4.drc"
            _, _, bytes_before = edge.call("GET", level)
            service.process.terminate()
            service.process.wait(timeout=30)
            time.sleep(2.1)
            status, headers, problem = json_of(edge.call("GET", "/v1/volumes"))
            self.assertEqual([status, headers["retry-after"], headers["content-type"], problem["code"], problem["status"]],
                             [502, "2", "application/problem+json", "unavailable", 502])
            status, headers, body = edge.call("GET", level)
            self.assertEqual([status, headers["x-cache"], body == bytes_before], [200, "STALE", True])


class Tls(unittest.TestCase):
    def test_one_port_speaks_both_versions_behind_a_certificate(self):
        certificate, key = FOLDER / "edge.pem", FOLDER / "edge.key"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days",
                        "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out",
                        certificate], check=True, stderr=subprocess.DEVNULL)
        port = free_port()
        tls = f"listen 127.0.0.1:{port} ssl http2;\nssl_certificate {certificate};\nssl_certificate_key {key};\n"
        with serve("tls") as service, Edge(FOLDER, service.address, more=tls):
            for offered in ("h2", "http/1.1"):
                context = ssl.create_default_context(cafile=certificate)
                context.set_alpn_protocols([offered])
                with (socket.create_connection(("127.0.0.1", port), timeout=20) as plain,
                      context.wrap_socket(plain, server_hostname="127.0.0.1") as secure):
                    self.assertEqual(secure.selected_alpn_protocol(), offered)
            for version in ("--http1.1", "--http2"):
                said = subprocess.run(["curl", "--silent", "--noproxy", "*", "--cacert", certificate, version, "--write-out", "%{http_code}",
                                       "--output", "/dev/null", f"https://127.0.0.1:{port}/version"], capture_output=True, text=True)
                self.assertEqual(said.stdout, "200", said.stderr)


if __name__ == "__main__":
    unittest.main()
