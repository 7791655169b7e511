"""Mixed load on both doors of a running server (environment variable GEOSIS = the binary): uploads, extractions, streams,
slow readers, watchers of events, withdrawals, deletions, small questions; every fourth client calls by gRPC. In the end memory (RssAnon + RssShmem) and descriptors must
be where they were after the warm-up, and nothing may have failed. Refusals with Retry-After (429, 503) are answers.

soak_test.py [--seconds 600] [--clients 16] [--seed N]"""
import argparse
import array
import collections
import http.client
import json
import math
import os
import random
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

import grpc

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../contract"))
from geosis.v1 import extraction_pb2  # noqa: E402
from grpc_door import GrpcDoor, message_of  # noqa: E402
from refused import Refused  # noqa: E402

GEOSIS = os.environ["GEOSIS"]
SIDE = 56  # samples an axis of the volumes that come and go
KEPT_SIDE = 100
WARM_UP = 0.3  # share of the time after which memory must have settled
GROWTH_BYTES = 24 << 20
GROWTH_SHARE = 0.10


class Failed(Exception):
    pass


def volume(side, seed):
    """A gyroid with a phase of its own: raw float32, sample fastest."""
    phase, step = seed % 1000 / 159.0, 12 / side
    waves = [(math.sin(step * n + phase), math.cos(step * n + phase)) for n in range(side)]
    samples = array.array("f")
    for si, ci in waves:
        for sj, cj in waves:
            a, b = si * cj, sj
            samples.extend([a + b * ck + sk * ci for sk, ck in waves])
    return samples.tobytes()


BASES = [volume(SIDE, seed) for seed in range(4)]


class Server:
    def __init__(self, store):
        self.process = subprocess.Popen(
            [GEOSIS, "serve", "--listen", "127.0.0.1:0", "--grpc", "127.0.0.1:0", "--store", store, "--queued", "64", "--admin", "", "--log-level", "warning"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address, self.grpc_address = (urllib.parse.urlsplit(self.process.stdout.readline().split()[-1]).netloc
                                           for _ in range(2))

    def memory(self):
        total = 0
        with open(f"/proc/{self.process.pid}/status") as status:
            for line in status:
                if line.startswith(("RssAnon:", "RssShmem:")):
                    total += int(line.split()[1]) * 1024
        return total

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))


class Client(threading.Thread):
    """One client: picks what to do by chance, again and again, until the time is over."""

    def __init__(self, server, kept, seed, end, tally):
        super().__init__(daemon=True)
        self.server, self.kept, self.end, self.tally = server, kept, end, tally
        self.random = random.Random(seed)
        self.problem = None

    def actions(self):
        return [self.upload_and_delete, self.extract_and_purge, self.stream, self.read_slowly, self.watch,
                self.withdraw, self.ask_small_things, self.ask_small_things, self.hang_up]

    def run(self):
        actions = self.actions()
        while time.monotonic() < self.end and not self.problem:
            action = self.random.choice(actions)
            try:
                action()
                self.tally[action.__name__] += 1
            except Exception as problem:
                self.problem = f"{action.__name__}: {type(problem).__name__}: {problem}"

    def open(self, method, path, body=None, **headers):
        connection = http.client.HTTPConnection(self.server.address, timeout=120)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body=body, headers=named)
        return connection, connection.getresponse()

    def call(self, method, path, body=None, expected=(200,), **headers):
        """The answer's bytes; None when the server is too busy and says when to come again."""
        connection, reply = self.open(method, path, body, **headers)
        try:
            data = reply.read()
        finally:
            connection.close()
        if reply.status in (429, 503) and reply.getheader("Retry-After"):
            self.tally["busy"] += 1
            time.sleep(min(float(reply.getheader("Retry-After")), 1))
            return None
        if reply.status not in expected:
            raise Failed(f"{method} {path}: {reply.status} {data[:300]!r}")
        return data

    def request(self):
        """One of 4000 requests, so that few are equal."""
        low = self.random.randrange(-1000, 1000) / 1000
        return json.dumps({"range": [low, None if self.random.random() < 0.5 else low + 0.4], "cap": True})

    def post(self, wait=60, volume_id=None):
        data = self.call("POST", f"/v1/volumes/{volume_id or self.kept}/extractions", self.request(), (200, 202),
                         Content_Type="application/json", Prefer=f"wait={wait}",
                         Priority=self.random.choice(["interactive", "batch"]))
        return json.loads(data) if data else None

    def upload_and_delete(self):
        data = bytearray(self.random.choice(BASES))
        data[:8] = array.array("f", [self.random.random(), self.random.random()]).tobytes()  # a volume of its own
        answer = self.call("POST", f"/v1/volumes?format=raw&dims={SIDE},{SIDE},{SIDE}", data, (200, 201),
                           Content_Type="application/octet-stream")
        if answer is None:
            return
        volume_id = json.loads(answer)["id"]
        made = self.post(volume_id=volume_id)
        if made and made["state"] == "done" and made["levels"]:
            self.call("GET", f"/v1/extractions/{made['id']}/lods/0.glb")
        self.call("DELETE", f"/v1/volumes/{volume_id}", expected=(204, 404))

    def extract_and_purge(self):
        made = self.post()
        if not made or made["state"] != "done":
            return
        path = f"/v1/extractions/{made['id']}"
        # Somebody else may purge the same one meanwhile.
        for name in ("manifest", "lods/0.drc", "bodies", "lods/1.ply"):
            self.call("GET", f"{path}/{name}", expected=(200, 404, 409))
        self.call("DELETE", f"{path}?purge=true", expected=(204, 404))

    def stream(self):
        connection, reply = self.open("POST", f"/v1/volumes/{self.kept}/extractions", self.request(),
                                      Accept="multipart/mixed", Content_Type="application/json")
        try:
            reply.read()
        except http.client.IncompleteRead:
            self.tally["streams_cut"] += 1  # purged while it was computed
        finally:
            connection.close()
        if reply.status not in (200, 429, 503):
            raise Failed(f"stream: {reply.status}")

    def read_slowly(self):
        made = self.post()
        if not made or made["state"] != "done":
            return
        connection, reply = self.open("GET", f"/v1/extractions/{made['id']}/stream")
        try:
            end = time.monotonic() + 3
            while time.monotonic() < end and reply.read(8192):
                time.sleep(0.05)
        except http.client.IncompleteRead:
            self.tally["streams_cut"] += 1
        finally:
            connection.close()  # often in the middle

    def watch(self):
        made = self.post(wait=0)
        if not made:
            return
        connection, reply = self.open("GET", f"/v1/extractions/{made['id']}/events", Accept="text/event-stream")
        try:
            if reply.status == 200:
                text = reply.read()
                if not any(word in text for word in (b"event: done", b"event: failed")):
                    raise Failed(f"events end with {text[-200:]!r}")
            elif reply.status not in (204, 404):
                raise Failed(f"events: {reply.status}")
        finally:
            connection.close()

    def withdraw(self):
        made = self.post(wait=0)
        if made:
            self.call("DELETE", f"/v1/extractions/{made['id']}", expected=(204, 404))

    def hang_up(self):
        connection, _ = self.open("POST", f"/v1/volumes/{self.kept}/extractions", self.request(),
                                  Accept="multipart/mixed", Content_Type="application/json")
        connection.close()

    def ask_small_things(self):
        for path in ("/v1/volumes", f"/v1/volumes/{self.kept}", "/livez", "/version",
                     f"/v1/volumes/{self.kept}/histogram?bins=64",
                     f"/v1/volumes/{self.kept}/slices/inline/{self.random.randrange(KEPT_SIDE)}?format=png"):
            self.call("GET", path)
        self.call("POST", f"/v1/volumes/{self.kept}/extractions?dry_run=true", self.request(),
                  Content_Type="application/json")


class GrpcClient(Client):
    """The same by gRPC. A connection for each action, as those who come once have."""

    def actions(self):
        return [self.with_door(action) for action in (self.grpc_upload_and_delete, self.grpc_stream, self.grpc_one_shot,
                                                      self.grpc_watch, self.grpc_read_slowly, self.grpc_hang_up)]

    def with_door(self, action):
        def act():
            door = GrpcDoor(self.server.grpc_address, None)
            try:
                action(door)
            except Refused as refused:
                # Purged or withdrawn by somebody else, or too busy.
                if refused.code not in ("not_found", "cancelled", "already_exists", "quota_exceeded", "unavailable"):
                    raise
                self.tally[f"grpc {refused.code}"] += 1
                time.sleep(0.2)
            finally:
                door.channel.close()
        act.__name__ = action.__name__
        return act

    def made(self, door):
        return door.create(self.kept, json.loads(self.request()), self.random.choice(["interactive", "batch"]))["id"]

    def own_volume(self):
        data = bytearray(self.random.choice(BASES))
        data[:8] = array.array("f", [self.random.random(), self.random.random()]).tobytes()
        return bytes(data), {"format": "raw", "dims": [SIDE, SIDE, SIDE]}

    def grpc_upload_and_delete(self, door):
        document, _ = door.upload(*self.own_volume())
        door.histogram(document["id"], 64)
        door.remove(document["id"])

    def grpc_stream(self, door):
        extraction = self.made(door)
        door.stream(extraction)
        door.bodies(extraction)
        if self.random.random() < 0.5:
            door.cancel(extraction, purge=True)

    def grpc_one_shot(self, door):
        data, options = self.own_volume()
        door.extract(data, self.random.random() - 0.5, 2, options)

    def grpc_watch(self, door):
        door.watch(self.made(door))

    def grpc_read_slowly(self, door):
        chunks = door.extraction_stub.StreamLods(extraction_pb2.StreamLodsRequest(id=self.made(door)))
        end = time.monotonic() + 3
        try:
            for _ in chunks:
                time.sleep(0.2)
                if time.monotonic() > end:
                    break
        except grpc.RpcError as error:
            if error.code() not in (grpc.StatusCode.NOT_FOUND, grpc.StatusCode.CANCELLED, grpc.StatusCode.UNAVAILABLE):
                raise
        chunks.cancel()

    def grpc_hang_up(self, door):
        asked = extraction_pb2.CreateExtractionRequest(volume=self.kept,
                                                       request=message_of(extraction_pb2.Request, json.loads(self.request())))
        door.extraction_stub.CreateExtraction.future(asked).cancel()


def settled(values, seconds, elapsed):
    """Median of the samples of a window, in shares of the time."""
    inside = [v for t, v in values if seconds[0] <= t / elapsed <= seconds[1]]
    return statistics.median(inside)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--clients", type=int, default=16)
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 30))
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    with tempfile.TemporaryDirectory(prefix="geosis-soak-") as store:
        server = Server(store)
        client = Client(server, None, 0, 0, collections.Counter())
        answer = client.call("POST", f"/v1/volumes?format=raw&dims={KEPT_SIDE},{KEPT_SIDE},{KEPT_SIDE}",
                             volume(KEPT_SIDE, 1), (201,), Content_Type="application/octet-stream")
        kept = json.loads(answer)["id"]
        idle = server.descriptors()
        begin = time.monotonic()
        tally = collections.Counter()
        clients = [(GrpcClient if n % 4 == 3 else Client)(server, kept, options.seed + n, begin + options.seconds, tally)
                   for n in range(options.clients)]
        for one in clients:
            one.start()
        memory, descriptors = [], []
        while any(one.is_alive() for one in clients):
            if server.process.poll() is not None:
                sys.exit(f"the server ended with {server.process.returncode}")
            now = time.monotonic() - begin
            memory.append((now, server.memory()))
            descriptors.append((now, server.descriptors()))
            time.sleep(min(1, options.seconds / 100))
            if now > options.seconds + 180:
                sys.exit("clients hang")
        time.sleep(3)
        left, at_rest = server.descriptors(), server.memory()
        server.process.terminate()
        status = server.process.wait(timeout=60)

        elapsed = memory[-1][0]
        early, late = settled(memory, (WARM_UP, WARM_UP + 0.2), elapsed), settled(memory, (0.8, 1), elapsed)
        print(dict(sorted(tally.items())))
        print(f"{elapsed:.0f} s; memory MB: {early / 2**20:.1f} after the warm-up, {late / 2**20:.1f} at the end, peak "
              f"{max(v for _, v in memory) / 2**20:.1f}, at rest {at_rest / 2**20:.1f}; descriptors: {idle} idle, "
              f"{settled(descriptors, (WARM_UP, WARM_UP + 0.2), elapsed):.0f} and "
              f"{settled(descriptors, (0.8, 1), elapsed):.0f} under load, {left} in the end; exit status {status}")
        problems = [one.problem for one in clients if one.problem]
        if late > early * (1 + GROWTH_SHARE) + GROWTH_BYTES:
            problems.append("memory grows")
        if left > idle + 8:  # volumes that are kept open
            problems.append(f"{left - idle} descriptors are left open")
        if status != 0:
            problems.append(f"exit status {status}")
        if problems:
            sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
