"""Clients that take what they can: slow ones, many ones, ones that leave; and a system that runs out of descriptors.

A prober asks for something small all the time: 99 of 100 of its answers have to come within a second. The quick form
takes seconds; with HOSTILE_LONG=1 there are more clients, for longer. Environment: GEOSIS = the built binary,
ACCEPT_FAULTS = a library that makes accept4() fail.
"""
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

from crowd import Crowd, Manner
from hostile import (PATIENCE, Prober, ask, connect, memory_of, read_all, sample_survey, scale, start, statuses)

HOST = "Host: a\r\n"
MEGABYTE = 1 << 20
WIDE = 1100  # samples of a slice's side: 5 MB a slice as float32


def setUpModule():
    """A server with a survey, one that is done, and one of wide slices."""
    global FOLDER, SERVICE, VOLUME, WIDE_VOLUME, EXTRACTION
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-hostile-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    SERVICE = unittest.enterModuleContext(start(FOLDER, "--workers", "1"))
    VOLUME = upload(SERVICE, sample_survey(FOLDER))
    WIDE_VOLUME = upload(SERVICE, bytes(WIDE * WIDE * 2), f"format=raw&dims={WIDE},{WIDE},2&dtype=uint8")
    EXTRACTION = extract(SERVICE, VOLUME, 0.55)["id"]


def upload(service, data, query=""):
    """The id of the volume; comes back when the server is busy, as it is told to."""
    for _ in range(100):
        status, headers, body = ask(service.address, f"/v1/volumes?{query}", "POST", body=data)
        if status in (200, 201):
            return json.loads(body)["id"]
        assert status == 503 and "retry-after" in headers, (status, body[:300])
        time.sleep(0.2)
    raise AssertionError("the server never took the upload")


def extract(service, volume, low, wait=60):
    body = json.dumps({"range": [low, None]}).encode()
    status, _, said = ask(service.address, f"/v1/volumes/{volume}/extractions", "POST", f"Prefer: wait={wait}\r\n", body)
    assert status in (200, 202), said[:300]
    return json.loads(said)


def request(target, method="GET", headers=""):
    return f"{method} {target} HTTP/1.1\r\n{HOST}{headers}\r\n".encode()


def open_descriptors(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


def wait_until(condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def bad_manners():
    slow = 512  # bytes of a small receive buffer
    wide = f"/v1/volumes/{WIDE_VOLUME}/slices/sample/0?format=f32"
    waits = request(f"/v1/volumes/{VOLUME}/extractions", "POST", "Prefer: wait=60\r\nContent-Length: 18\r\n")
    return [Manner("silent"),
            Manner("idle", first=request("/livez")),
            Manner("slow line", first=b"GET /", drip=b"a"),
            Manner("slow headers", first=b"GET /livez HTTP/1.1\r\n", drip=b"A: b\r\n"),
            Manner("slow small body", first=request("/v1/volumes/x/extractions", "POST", "Content-Length: 60000\r\n"),
                   drip=b" "),
            Manner("slow upload", first=request("/v1/volumes", "POST", "Content-Length: 1000000\r\n"), drip=b"x"),
            Manner("slow late upload", first=request("/v1/volumes", "POST", "Content-Length: 1000000\r\n") + bytes(33000),
                   drip=b"x"),
            Manner("slow chunks", first=request("/v1/volumes", "POST", "Transfer-Encoding: chunked\r\n"),
                   drip=b"1\r\nx\r\n"),
            Manner("no reader", first=request(wide), receive_bytes=slow),
            Manner("slow reader", first=request(wide), read=64, receive_bytes=slow),
            Manner("slow pipeline", first=request("/openapi.yaml") * 100, read=16, receive_bytes=slow),
            Manner("waiting", first=waits + b'{"range":[0.0001,1]}'[:18]),
            Manner("events", first=request(f"/v1/extractions/{EXTRACTION}/events"), drip=request("/livez"))]


class Crowds(unittest.TestCase):
    def assert_prompt(self, probed):
        print(f"probes: {probed}", file=sys.stderr)
        self.assertEqual(probed["failures"], [])
        self.assertLess(probed["p99"], 1)

    def test_a_crowd_with_all_bad_manners_starves_nobody(self):
        seconds, count = scale(4, 60), scale(500, 900)
        before = memory_of(SERVICE.process)
        with Crowd(SERVICE.address, bad_manners(), count) as crowd:
            prober = Prober(SERVICE.address, seconds)
            end, round_trips = time.monotonic() + seconds, 0
            while time.monotonic() < end:
                cube = bytes([round_trips % 250 + 1]) * 27
                volume = upload(SERVICE, cube, "format=raw&dims=3,3,3&dtype=uint8")
                self.assertEqual(extract(SERVICE, volume, 0)["state"], "done")
                round_trips += 1
            self.assert_prompt(prober.result())
            print(f"{count} clients: {round_trips} uploads with extractions meanwhile, least held {crowd.least_held}, "
                  f"dropped {crowd.dropped}", file=sys.stderr)
            self.assertGreater(round_trips, scale(0, 60))  # four seconds of a machine that others use, too
            self.assertGreater(crowd.least_held, count / 2)
            for name in ("slow line", "slow headers", "slow small body", "slow upload", "no reader"):
                self.assertGreater(crowd.dropped[name], 0, f"{name}: never dropped")
            self.assertEqual(crowd.dropped["waiting"], 0)
            self.assertLess(memory_of(SERVICE.process) - before, 600 * MEGABYTE)
        self.assertTrue(wait_until(lambda: open_descriptors(SERVICE.process) < 60))

    def test_a_flood_of_connections_starves_nobody(self):
        prober = Prober(SERVICE.address, scale(1, 20))
        end = time.monotonic() + scale(1, 20)
        while time.monotonic() < end:
            connect(SERVICE.address).close()
        self.assert_prompt(prober.result())

    def test_clients_that_leave_are_forgotten_at_once(self):
        before = open_descriptors(SERVICE.process)
        blocker = json.dumps({"range": [0.0001, None], "missing": {"method": "rbf"}}).encode()
        head = request(f"/v1/volumes/{VOLUME}/extractions", "POST",
                       f"Prefer: wait=60\r\nContent-Length: {len(blocker)}\r\n")
        clients = [connect(SERVICE.address) for _ in range(scale(60, 400))]
        for client in clients:
            client.sendall(head + blocker)
        self.assertEqual(ask(SERVICE.address, "/livez")[0], 200)  # what writes keeps no thread from what reads
        for client in clients:
            client.close()
        # As soon as their requests are recorded, and long before the minute that they asked to wait.
        self.assertTrue(wait_until(lambda: open_descriptors(SERVICE.process) <= before + 4, 30))


class Descriptors(unittest.TestCase):
    def test_a_server_without_descriptors_lives_on(self):
        def few():
            resource.setrlimit(resource.RLIMIT_NOFILE, (128, 128))
        with tempfile.TemporaryDirectory() as folder, start(Path(folder), preexec_fn=few) as service:
            crowd = [connect(service.address) for _ in range(400)]
            self.assertEqual(ask(service.address, "/readyz")[0], 200)  # silent ones make room; the store finds its files
            for client in crowd:
                client.sendall(request("/v1/extractions/x/events")[:-2])
            time.sleep(0.3)
            for client in crowd:
                client.close()
            self.assertTrue(wait_until(lambda: ask(service.address, "/readyz")[0] == 200, 5))

    @unittest.skipUnless(os.environ.get("ACCEPT_FAULTS"), "ACCEPT_FAULTS is not set")
    def test_failures_of_accept_are_survived(self):
        environment = {**os.environ, "LD_PRELOAD": os.environ["ACCEPT_FAULTS"]}
        with tempfile.TemporaryDirectory() as folder, start(Path(folder), env=environment) as service:
            for _ in range(scale(20, 400)):
                self.assertEqual(ask(service.address, "/livez")[0], 200)
            self.assertIsNone(service.process.poll())


class Ends(unittest.TestCase):
    """SIGTERM lets running answers finish; a second one does not."""

    def stopping(self, work):
        with tempfile.TemporaryDirectory() as folder, start(Path(folder)) as service:
            volume = upload(service, bytes(WIDE * WIDE * 2), f"format=raw&dims={WIDE},{WIDE},2&dtype=uint8")
            client = connect(service.address, 4096)
            client.sendall(request(f"/v1/volumes/{volume}/slices/sample/0?format=f32"))
            head = client.recv(100)
            self.assertIn(b"200 OK", head)
            with client:
                work(service, client, head)

    def test_a_running_answer_is_finished(self):
        def work(service, client, head):
            service.process.send_signal(signal.SIGTERM)
            self.assertTrue(wait_until(lambda: not self.takes_requests(service)))
            self.assertIsNone(service.process.poll())
            said = head + read_all(client)
            body = said.partition(b"\r\n\r\n")[2]
            self.assertEqual(len(body), WIDE * WIDE * 4)
            self.assertEqual(service.process.wait(timeout=10), 0)
        self.stopping(work)

    def test_a_second_signal_ends_it_at_once(self):
        def work(service, client, head):
            service.process.send_signal(signal.SIGTERM)
            self.assertTrue(wait_until(lambda: not self.takes_requests(service)))
            start_of_end = time.monotonic()
            service.process.send_signal(signal.SIGTERM)
            service.process.wait(timeout=10)
            self.assertLess(time.monotonic() - start_of_end, 1)
            self.assertLess(len(read_all(client)), WIDE * WIDE * 4)
        self.stopping(work)

    @staticmethod
    def takes_requests(service):
        try:
            return ask(service.address, "/livez")[0] == 200
        except OSError:
            return False


if __name__ == "__main__":
    unittest.main()
