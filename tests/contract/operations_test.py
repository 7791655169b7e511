"""How the service is run: keys and tenants, exposure, log lines, metrics, probes, memory, and what errors tell.

GEOSIS = the built binary."""
import array
import ctypes
import errno
import http.client
import json
import os
import re
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.parse
from pathlib import Path

from contract import Contract
from service import Answer

CONTRACT = Contract()
GEOSIS = os.environ["GEOSIS"]
SIDE = 24
SAMPLES = array.array("f", [(i - 12) ** 2 + (j - 12) ** 2 + (k - 12) ** 2
                            for i in range(SIDE) for j in range(SIDE) for k in range(SIDE)]).tobytes()
UPLOAD = f"/v1/volumes?format=raw&dims={SIDE},{SIDE},{SIDE}"
ID = "0" * 64
PIDFD_GETFD, SYS_PIDFD_GETFD = ctypes.CDLL(None, use_errno=True).syscall, 438


def run(*arguments):
    return subprocess.run([GEOSIS, *arguments], capture_output=True, text=True, timeout=60)


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Server:
    def __init__(self, folder, *flags, **environment):
        self.admin = f"127.0.0.1:{free_port()}"
        self.log = Path(folder) / "log"
        self._errors = open(self.log, "w")
        self.process = subprocess.Popen(
            [GEOSIS, "serve", "--listen", "127.0.0.1:0", "--grpc", "127.0.0.1:0", "--admin", self.admin, "--store", str(Path(folder) / "store"), *flags],
            stdout=subprocess.PIPE, stderr=self._errors, text=True, env={**os.environ, **environment})
        self.address, self.grpc_address = (
            urllib.parse.urlsplit(self.process.stdout.readline().split()[-1]).netloc for _ in range(2))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(timeout=60)
        self.process.stdout.close()
        self._errors.close()

    def call(self, method, path, body=None, key=None, address=None, **headers):
        connection = http.client.HTTPConnection(address or self.address, timeout=60)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        if key:
            named["Authorization"] = f"Bearer {key}"
        try:
            connection.request(method, path, body, named)
            reply = connection.getresponse()
            return reply.status, dict((k.lower(), v) for k, v in reply.getheaders()), reply.read()
        finally:
            connection.close()


class Keys(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.keys, lines = {}, []
        for name, tenant, scopes in (("both", "one", "volumes:read,volumes:write"), ("reader", "one", "volumes:read"),
                                     ("writer", "one", "volumes:write"), ("other", "two", "volumes:read,volumes:write")):
            made = run("key", "--name", name, "--tenant", tenant, "--scopes", scopes)
            cls.keys[name], line = made.stdout.split("\n")[:2]
            lines.append(line)
        file = Path(cls.folder.name) / "keys"
        file.write_text("# who may call\n" + "\n".join(lines) + "\n")
        cls.server = Server(cls.folder.name, "--auth", "api_keys", str(file))
        cls.volume = json.loads(cls.server.call("POST", UPLOAD, SAMPLES, cls.keys["both"])[2])["id"]

    @classmethod
    def tearDownClass(cls):
        cls.server.stop()
        cls.folder.cleanup()

    def status(self, name, method, path, body=None):
        answer = Answer(*self.server.call(method, path, body, self.keys.get(name, name), Content_Type="application/json"))
        CONTRACT.check(method, path.partition("?")[0], answer)
        return answer.status

    def test_without_a_known_key_nothing_is_told(self):
        for key in (None, "", "geosis_" + "0" * 64, self.keys["both"] + "0", self.keys["both"][:-1]):
            for method, path in (("GET", "/v1/volumes"), ("GET", f"/v1/volumes/{self.volume}"), ("POST", UPLOAD),
                                 ("DELETE", f"/v1/volumes/{self.volume}"), ("GET", f"/v1/extractions/{ID}/stream")):
                status, headers, body = self.server.call(method, path, b"x" if method == "POST" else None, key)
                self.assertEqual(status, 401, (key, method, path))
                self.assertIn("Bearer", headers["www-authenticate"])
                self.assertEqual(json.loads(body)["code"], "unauthenticated")
                CONTRACT.check(method, path.partition("?")[0], Answer(status, headers, body))
        self.assertEqual(self.server.call("GET", "/v1/volumes", Authorization="Basic " + self.keys["both"])[0], 401)

    def test_probes_and_page_need_no_key(self):
        for path in ("/livez", "/readyz", "/version", "/openapi.yaml"):
            self.assertEqual(self.server.call("GET", path)[0], 200, path)
        self.assertNotEqual(self.server.call("GET", "/")[0], 401)
        self.assertEqual(self.server.call("OPTIONS", "/v1/volumes")[0], 204)

    def test_scopes_bound_what_a_key_may_do(self):
        volume = f"/v1/volumes/{self.volume}"
        request = json.dumps({"range": [None, 50]})
        self.assertEqual(self.status("reader", "GET", volume), 200)
        self.assertIn(self.status("reader", "POST", f"{volume}/extractions", request), (200, 202))
        self.assertEqual(self.status("reader", "POST", f"{volume}/extractions?dry_run=true", request), 200)
        self.assertEqual(self.status("reader", "POST", UPLOAD, SAMPLES), 403)
        self.assertEqual(self.status("reader", "PATCH", volume, "{}"), 403)
        self.assertEqual(self.status("reader", "DELETE", volume), 403)
        self.assertEqual(self.status("reader", "DELETE", f"/v1/extractions/{ID}?purge=true"), 403)
        self.assertEqual(self.status("reader", "DELETE", f"/v1/extractions/{ID}"), 404)
        self.assertEqual(self.status("writer", "GET", volume), 403)
        self.assertEqual(self.status("writer", "POST", UPLOAD, SAMPLES), 200)

    def test_a_tenant_sees_nothing_of_another(self):
        self.assertEqual(self.status("other", "GET", f"/v1/volumes/{self.volume}"), 404)
        self.assertEqual(self.status("other", "DELETE", f"/v1/volumes/{self.volume}"), 404)
        mine = json.loads(self.server.call("GET", "/v1/volumes", None, self.keys["both"])[2])["volumes"]
        self.assertEqual([volume["id"] for volume in mine], [self.volume])
        self.assertEqual(json.loads(self.server.call("GET", "/v1/volumes", None, self.keys["other"])[2])["volumes"], [])
        self.assertEqual(self.status("other", "POST", UPLOAD, SAMPLES), 201)  # no deduplication across tenants


class Exposure(unittest.TestCase):
    def test_what_others_reach_must_be_said_to_be_open(self):
        with tempfile.TemporaryDirectory() as folder:
            for flags in (["--listen", "0.0.0.0:0"], ["--listen", "127.0.0.1:0", "--grpc", "0.0.0.0:0"], ["--listen", "127.0.0.1:0", "--admin", "0.0.0.0:0"],
                          ["--listen", "[::]:0"], ["--auth", "secret"], ["--auth", "api_keys"],
                          ["--auth", "api_keys", f"{folder}/absent"]):
                started = run("serve", "--store", f"{folder}/store", *flags)
                self.assertEqual(started.returncode, 1, (flags, started.stderr))
                self.assertEqual(started.stdout, "")

    def test_too_little_memory_is_said_at_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            started = run("serve", "--store", folder, "--listen", "127.0.0.1:0", "--grpc", "off", "--memory", "1000")
            self.assertIn("--memory 1000", started.stderr)


class WithServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.server = Server(cls.folder.name, "--log-format", "json", "--memory", str(1 << 28))
        cls.volume = json.loads(cls.server.call("POST", UPLOAD, SAMPLES)[2])["id"]

    @classmethod
    def tearDownClass(cls):
        cls.server.stop()
        cls.folder.cleanup()


class Watching(WithServer):
    def metrics(self):
        status, headers, body = self.server.call("GET", "/metrics", address=self.server.admin)
        self.assertEqual(status, 200)
        self.assertTrue(headers["content-type"].startswith("text/plain; version=0.0.4"))
        values = {}
        for line in body.decode().splitlines():
            if line.startswith("#"):
                continue
            match = re.fullmatch(r'([a-z_]+(?:\{(?:[a-z]+="(?:[^"\\]|\\.)*",?)*\})?) (\S+)', line)
            self.assertTrue(match, line)
            values[match[1]] = float(match[2])
        return values

    def extract(self, high, **headers):
        return self.server.call("POST", f"/v1/volumes/{self.volume}/extractions", json.dumps({"range": [None, high]}),
                                Content_Type="application/json", Prefer="wait=30", **headers)

    def test_metrics_count_requests_stages_and_hits(self):
        for _ in range(2):
            self.assertEqual(self.extract(60)[0], 200)
        for _ in range(100):  # jobs end a moment after their answers
            values = self.metrics()
            if values["geosis_memory_reserved_bytes"] == 0:
                break
            time.sleep(0.05)
        route = 'geosis_http_request_seconds_count{method="POST",route="/v1/volumes/*/extractions",status="200"}'
        self.assertGreaterEqual(values[route], 2)
        self.assertGreaterEqual(values['geosis_extractions_asked_total{cache="hit"}'], 1)
        self.assertGreaterEqual(values['geosis_extraction_stage_seconds_count{stage="simplify"}'], 1)
        self.assertGreaterEqual(values['geosis_jobs_total{priority="interactive",outcome="done"}'], 1)
        self.assertEqual(values["geosis_memory_budget_bytes"], 1 << 28)
        self.assertEqual(values["geosis_memory_reserved_bytes"], 0)
        self.assertGreater(values["geosis_http_received_bytes_total"], len(SAMPLES))
        self.assertEqual(self.server.call("GET", "/metrics")[0], 404)  # not at the door of everybody

    def test_methods_that_nobody_takes_are_logged_without_alarm(self):
        for method, path, status in (("PUT", "/v1/volumes?name=x", 405), ("BREW", "/v1/pot?milk=1", 501)):
            self.assertEqual(self.server.call(method, path, b"1", X_Request_Id=f"odd-{method}")[0], status)
        for _ in range(200):  # the line is written after the answer
            lines = [json.loads(line) for line in self.server.log.read_text().splitlines()]
            found = [line for line in lines if line.get("status") in (405, 501)]
            if len(found) == 2:
                break
            time.sleep(0.05)
        self.assertEqual([(line["level"], line["method"], line["path"], line["status"]) for line in found],
                         [("info", "PUT", "/v1/volumes", 405), ("info", "BREW", "/v1/pot", 501)])

    def test_log_lines_name_request_and_trace(self):
        trace = "4bf92f3577b34da6a3ce929d0e0e4736"
        _, headers, _ = self.extract(70, X_Request_Id="mine-7", traceparent=f"00-{trace}-00f067aa0ba902b7-01")
        self.assertEqual(headers["x-request-id"], "mine-7")
        self.server.call("GET", "/v1/volumes/%0a%22", X_Request_Id="x y")
        for _ in range(200):  # the line is written after the answer
            lines = [json.loads(line) for line in self.server.log.read_text().splitlines()]
            found = [line for line in lines if line.get("request_id") == "mine-7"]
            if len(found) == 2:
                break
            time.sleep(0.05)
        answered = [line for line in found if line["message"] == "request"][0]
        self.assertEqual(answered["trace_id"], trace)
        self.assertEqual((answered["method"], answered["status"]), ("POST", 200))
        self.assertFalse([line for line in lines if line.get("request_id") == "x y"])
        self.assertTrue([line for line in found if line["message"] == "extraction computed"])

    def test_probes_answer_at_both_doors(self):
        for address in (self.server.address, self.server.admin):
            self.assertEqual(self.server.call("GET", "/livez", address=address)[0], 200)
            self.assertTrue(json.loads(self.server.call("GET", "/readyz", address=address)[2])["ready"])

    def test_the_probe_command_says_what_they_say(self):
        for address in (self.server.address, self.server.admin):
            self.assertEqual(run("probe", f"http://{address}/livez").returncode, 0)
        with socket.create_server(("127.0.0.1", 0)) as silent:
            silent_url = f"http://127.0.0.1:{silent.getsockname()[1]}/"
            for arguments, said in (((f"http://{self.server.address}/nothing",), "HTTP/1.1 404 Not Found: "),
                                    ((silent_url, "--timeout-seconds", "1"), "no answer"),
                                    ((f"http://127.0.0.1:{free_port()}/",), "cannot connect"),
                                    (("ftp://127.0.0.1/",), "expected http://"), (("http:///livez",), "expected http://"),
                                    (("http://127.0.0.1/a\r\nb",), "expected http://")):
                asked = run("probe", *arguments)
                self.assertEqual((asked.returncode, said in asked.stderr), (1, True), (arguments, asked.stderr))


class Liveness(unittest.TestCase):
    def listener_of(self, process, address):
        """The server's own listening socket, in our hands as well."""
        handle = os.pidfd_open(process.pid)
        self.addCleanup(os.close, handle)
        for number in os.listdir(f"/proc/{process.pid}/fd"):
            mine = PIDFD_GETFD(SYS_PIDFD_GETFD, handle, int(number), 0)
            if mine < 0 and ctypes.get_errno() in (errno.EPERM, errno.ENOSYS):
                self.skipTest("this kernel gives nobody another's sockets")
            try:
                found = socket.socket(fileno=mine)
            except (OSError, ValueError):  # gone, or no socket
                if mine >= 0:
                    os.close(mine)
                continue
            is_listening = found.family == socket.AF_INET and found.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN)
            if is_listening and found.getsockname() == (address.split(":")[0], int(address.split(":")[1])):
                return found
            found.close()
        self.fail(f"nobody listens at {address}")

    def test_a_grpc_door_that_takes_nobody_any_more_is_told_by_livez(self):
        with tempfile.TemporaryDirectory() as folder, Server(folder, "--probe-seconds", "1") as server:
            self.assertEqual(server.call("GET", "/livez")[0], 200)
            with self.listener_of(server.process, server.grpc_address) as listener:
                listener.shutdown(socket.SHUT_RDWR)
            end = time.monotonic() + 60
            while server.call("GET", "/livez")[0] == 200 and time.monotonic() < end:
                time.sleep(0.2)
            for address in (server.address, server.admin):
                status, _, said = server.call("GET", "/livez", address=address)
                self.assertEqual((status, b"the gRPC door" in said), (503, True), said)
            self.assertEqual(run("probe", f"http://{server.admin}/livez").returncode, 1)
            self.assertEqual(server.call("GET", "/v1/volumes")[0], 200)  # HTTP goes on


class Leaving(unittest.TestCase):
    def not_ready(self, server):
        """Waits until /readyz says that it is shutting down, over connections that are taken as before."""
        server.process.terminate()
        end = time.monotonic() + 20
        while (said := server.call("GET", "/readyz"))[0] == 200 and time.monotonic() < end:
            time.sleep(0.02)
        self.assertEqual((said[0], b"draining" in said[2]), (503, True), said)

    def test_calls_are_taken_until_balancers_know(self):
        with tempfile.TemporaryDirectory() as folder, Server(folder, "--drain-delay-seconds", "2") as server:
            self.not_ready(server)
            self.assertEqual(server.call("GET", "/livez")[0], 200)
            self.assertEqual(server.call("POST", UPLOAD, SAMPLES)[0], 201)
            host, port = server.grpc_address.split(":")
            socket.create_connection((host, int(port)), timeout=10).close()
            self.assertEqual(server.process.wait(timeout=60), 0)

    def test_a_second_signal_waits_for_nobody(self):
        with tempfile.TemporaryDirectory() as folder, Server(folder, "--drain-delay-seconds", "600") as server:
            self.not_ready(server)
            server.process.terminate()
            self.assertEqual(server.process.wait(timeout=60), 1)


class Errors(WithServer):
    def test_errors_tell_nothing_of_the_machine(self):
        big = json.dumps({"range": [0, 1], "x": "y" * 70000})
        calls = [("GET", "/nothing", None), ("GET", "/v1/volumes/..%2f..%2fetc%2fpasswd", None),
                 ("GET", f"/v1/volumes/{ID}", None), ("GET", f"/v1/extractions/{ID}/lods/0.glb", None),
                 ("GET", f"/v1/volumes/{self.volume}/slices/inline/99999", None),
                 ("GET", f"/v1/volumes/{self.volume}/histogram?bins=0", None), ("DELETE", f"/v1/volumes/{ID}", None),
                 ("POST", "/v1/volumes?format=segy", b"no survey"), ("POST", "/v1/volumes?format=raw&dims=9,9,9", b"short"),
                 ("POST", "/v1/volumes", b""), ("POST", "/v1/extract?range=0,1", b"no survey"),
                 ("POST", "/v1/volumes?options=x", b"1"), ("PUT", "/v1/volumes", b"1"),
                 ("POST", f"/v1/volumes/{self.volume}/extractions", b"{"),
                 ("POST", f"/v1/volumes/{self.volume}/extractions", b'{"range": [2, 1]}'),
                 ("POST", f"/v1/volumes/{self.volume}/extractions", big.encode())]
        for method, path, body in calls:
            status, headers, answer = self.server.call(method, path, body, Content_Type="application/json")
            self.assertGreaterEqual(status, 400, (method, path))
            self.assert_tells_nothing(headers, answer)
        # A damaged store: what is wrong with it is the operator's to know.
        store = Path(self.folder.name) / "store"
        for file in store.rglob("*"):
            if file.is_file() and file.name.startswith(("bricks", "volume.json")):
                file.write_bytes(b"damaged")
        for path in (f"/v1/volumes/{self.volume}", f"/v1/volumes/{self.volume}/slices/sample/1?format=f32", "/v1/volumes"):
            status, headers, answer = self.server.call("GET", path)
            if status >= 400:
                self.assert_tells_nothing(headers, answer)

    def assert_tells_nothing(self, headers, answer):
        text = (json.dumps(headers) + answer.decode(errors="replace")).lower()
        for word in (self.folder.name, "/tmp", "/work", "/home", "/usr", "/root", ".cpp", "errno", "std::", "exception",
                     "httplib", "openssl", "staging/"):
            self.assertNotIn(word.lower(), text)


if __name__ == "__main__":
    unittest.main()
