"""Kills real servers with SIGKILL while clients upload, extract, change and remove, starts them again, and judges what
is left: nothing acknowledged is lost, nothing half is visible, and levels come also when servers die in turn.

    GEOSIS=build/release/geosis python3 tests/e2e/kill_rounds.py [--rounds 1000] [--pairs 100] [--seed N] [--store DIR]
"""
import argparse
import array
import hashlib
import http.client
import json
import os
import random
import shutil
import signal
import subprocess
import tempfile
import threading
import time

GEOSIS = os.environ["GEOSIS"]
REQUEST = {"range": [0, None], "levels": [{"ratio": 1}, {"ratio": 0.25}]}


class Lost(Exception):
    """No answer: the server died."""


class Server:
    def __init__(self, store):
        self._command = [GEOSIS, "serve", "--listen", "127.0.0.1:0", "--grpc", "off", "--store", store, "--threads", "1"]
        self.start()

    def start(self):
        self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self._process.stdout.readline()
        assert line.startswith("listening on http://"), line
        self.port = int(line.strip().rsplit(":", 1)[1])

    def kill(self):
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()
        self._process.stdout.close()

    def call(self, method, target, body=None, headers=None, timeout=60):
        """(status, bytes); Lost when the connection breaks."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        try:
            connection.request(method, target, body=body, headers=headers or {})
            reply = connection.getresponse()
            return reply.status, reply.read()
        except (OSError, http.client.HTTPException) as broken:
            raise Lost(str(broken)) from broken
        finally:
            connection.close()

    def json(self, method, target, document=None, **headers):
        body = None if document is None else json.dumps(document)
        named = {"Content-Type": "application/json", **headers} if body else headers
        status, answer = self.call(method, target, body, named)
        return status, json.loads(answer) if answer else None


class Cube:
    """A raw file that follows from its number, and so does its id."""

    def __init__(self, number, nodes):
        self.number, self.dims = number, (nodes, nodes, nodes)
        middle = (nodes - 1) / 2 + 0.125
        radius = nodes * 0.35
        squares = [(n - middle) ** 2 for n in range(nodes)]
        self.samples = array.array("f", (radius * radius - a - b - c for a in squares for b in squares for c in squares))
        self.samples[0] = -1e4 - number  # no two are equal
        self.bytes = self.samples.tobytes()
        self.query = f"format=raw&dims={nodes},{nodes},{nodes}&name=cube{number}"

    def inline(self, index):
        rows = self.samples[index * self.dims[1] * self.dims[2]:(index + 1) * self.dims[1] * self.dims[2]]
        n = self.dims[2]
        return array.array("f", (rows[j * n + k] for k in range(n) for j in range(n))).tobytes()


class World:
    """What was acknowledged, and what may or may not have happened because its answer was lost."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.lock = threading.Lock()
        self.cubes = {}        # volume id -> Cube, of every upload ever acknowledged or found
        self.pending = {}      # cube number -> Cube, unanswered uploads
        self.names = {}        # volume id -> names that it may have
        self.removed = set()   # volume ids whose removal was acknowledged
        self.removing = set()  # ... was asked for without an answer
        self.extractions = {}  # id -> volume id, acknowledged
        self.cancelled = set()  # extraction ids whose last withdrawal was acknowledged
        self.references = {}   # extraction id -> sha-256 of its manifest, when first seen
        self.counts = {}

    def count(self, what):
        self.counts[what] = self.counts.get(what, 0) + 1

    def some_volume(self):
        with self.lock:
            alive = [v for v in self.cubes if v not in self.removed and v not in self.removing]
            return self.random.choice(alive) if alive else None


def upload(server, world, serial):
    with world.lock:
        number = next(serial)
        cube = Cube(number, world.random.choice((6, 12, 20, 70)) if number % 9 == 0 else world.random.choice((6, 12, 20)))
        world.pending[number] = cube
    status, document = parsed(
        server.call("POST", "/v1/volumes?" + cube.query, cube.bytes, {"Content-Type": "application/octet-stream"}))
    assert status == 201, (status, document)
    with world.lock:
        world.cubes[document["id"]] = cube
        world.names.setdefault(document["id"], {f"cube{number}"})
        del world.pending[number]
        world.count("uploads")


def parsed(answer):
    status, body = answer
    return status, json.loads(body) if body else None


def extract(server, world):
    volume = world.some_volume()
    if not volume:
        return
    status, document = server.json("POST", f"/v1/volumes/{volume}/extractions", REQUEST)
    if status == 404 and (volume in world.removed or volume in world.removing):
        return
    assert status in (200, 202), (status, document)
    with world.lock:
        world.extractions[document["id"]] = volume
        world.cancelled.discard(document["id"])
        world.count("extractions")


def rename(server, world):
    volume = world.some_volume()
    if not volume:
        return
    name = f"name{world.random.random()}"
    with world.lock:
        world.names[volume].add(name)
    status, document = server.json("PATCH", f"/v1/volumes/{volume}", {"name": name})
    if status == 404 and (volume in world.removed or volume in world.removing):
        return
    assert status == 200 and document["name"] == name, (status, document)
    with world.lock:
        world.names[volume] = {name}
        world.count("changes")


def remove(server, world):
    with world.lock:
        alive = [v for v in world.cubes if v not in world.removed and v not in world.removing]
        if len(alive) < 6:
            return
        volume = world.random.choice(alive)
        world.removing.add(volume)
    status, _ = server.call("DELETE", f"/v1/volumes/{volume}")
    assert status == 204, status
    with world.lock:
        world.removing.discard(volume)
        world.removed.add(volume)
        world.count("removals")


def clients(server, world, serial, failures):
    """One thread a kind of change, so that the last acknowledged value is known; until the server dies."""
    end = threading.Event()

    def run(action, *more):
        try:
            while not end.is_set():
                action(server, world, *more)
                time.sleep(world.random.random() * 0.01)
        except Lost:
            pass
        except BaseException as broken:  # noqa: BLE001  told by the main thread
            failures.append(repr(broken))

    threads = [threading.Thread(target=run, args=arguments)
               for arguments in ((upload, serial), (extract,), (rename,), (remove,))]
    for thread in threads:
        thread.start()
    return threads, end


def judge_volume(server, world, volume):
    """What is listed is whole."""
    status, document = server.json("GET", f"/v1/volumes/{volume}")
    assert status == 200, (volume, status, document)
    if volume not in world.cubes:
        known = [cube for cube in world.pending.values() if f"cube{cube.number}" == document["name"]]
        assert known, ("a volume that nobody uploaded", document)
        world.cubes[volume] = known[0]
        world.names[volume] = {document["name"]}
        world.count("found without an answer")
    cube = world.cubes[volume]
    assert document["name"] in world.names[volume], (document["name"], world.names[volume])
    world.names[volume] = {document["name"]}
    index = world.random.randrange(cube.dims[0])
    status, plane = server.call("GET", f"/v1/volumes/{volume}/slices/inline/{index}?format=f32")
    assert status == 200 and plane == cube.inline(index), (volume, index, status)


def judge_extraction(server, world, extraction):
    status, resource = server.json("GET", f"/v1/extractions/{extraction}")
    assert status == 200, (extraction, status, resource)
    for _ in range(3000):
        status, resource = server.json("GET", f"/v1/extractions/{extraction}")
        if resource["state"] in ("done", "failed", "cancelled"):
            break
        time.sleep(0.01)
    assert resource["state"] == "done", resource
    status, manifest = server.call("GET", f"/v1/extractions/{extraction}/manifest")
    assert status == 200, (extraction, status)
    digest = hashlib.sha256(manifest).hexdigest()
    assert world.references.setdefault(extraction, digest) == digest, "another manifest than before"
    for level in json.loads(manifest)["levels"]:
        for part in level["parts"]:
            status, data = server.call("GET", f"/v1/extractions/{extraction}/{part['url']}")
            assert (status, hashlib.sha256(data).hexdigest()) == (200, part["sha256"]), (extraction, part, status)
    world.count("results judged")


def judge(server, world):
    listed, token = [], ""
    while token is not None:
        status, page = server.json("GET", f"/v1/volumes?page_size=1000&page_token={token}")
        assert status == 200, (status, page)
        listed += [volume["id"] for volume in page["volumes"]]
        token = page["next_page_token"]
    for volume in world.cubes:
        if volume in world.removed:
            assert volume not in listed, ("removed, and there again", volume)
        elif volume not in world.removing:
            assert volume in listed, ("acknowledged and lost", volume)
    for volume in listed:
        judge_volume(server, world, volume)
    world.pending.clear()
    for volume in list(world.removing):  # asked for: it happened or not
        if volume not in listed:
            world.removed.add(volume)
        else:  # its results may be gone already
            world.extractions = {e: v for e, v in world.extractions.items() if v != volume}
    world.removing.clear()
    alive = [e for e, volume in world.extractions.items() if volume not in world.removed]
    for extraction in world.random.sample(alive, min(2, len(alive))):
        judge_extraction(server, world, extraction)
    gone = [e for e, volume in world.extractions.items() if volume in world.removed]
    for extraction in gone[-3:]:
        status, _ = server.call("GET", f"/v1/extractions/{extraction}")
        assert status == 404, ("a result of a removed volume", extraction, status)


def kill_rounds(store, world, rounds):
    serial = iter(range(10**9))
    server = Server(store)
    for number in range(rounds):
        failures = []
        threads, end = clients(server, world, serial, failures)
        time.sleep(world.random.random() * 0.25)
        server.kill()
        end.set()
        for thread in threads:
            thread.join()
        assert not failures, failures
        server.start()
        judge(server, world)
        if number % 100 == 99:
            print(f"{number + 1} rounds: {world.counts}", flush=True)
    for volume in list(world.cubes):
        if volume not in world.removed:
            assert server.call("DELETE", f"/v1/volumes/{volume}")[0] == 204
    time.sleep(1.5)
    server.kill()
    server = Server(store)  # and its garbage collection
    for _ in range(100):
        left = [os.path.join(folder, name) for folder, _, names in os.walk(os.path.join(store, "objects"))
                for name in names]
        if not left:
            break
        time.sleep(0.1)
    assert not left, ("left over", left[:5])
    server.kill()


def fetch_levels(servers, extraction):
    """Levels of an extraction by streams from whoever lives; a stream that breaks is tried at the next one."""
    for attempt in range(200):
        server = servers[attempt % 2]
        try:
            status, body = server.call("GET", f"/v1/extractions/{extraction}/stream", timeout=30)
            if status == 200 and body.endswith(b"--\r\n"):
                return hashlib.sha256(body).hexdigest()
        except Lost:
            pass
        time.sleep(0.05)
    raise AssertionError(("no levels", extraction))


def pair_rounds(store, world, rounds):
    """Two servers on one store, killed in turn while a client fetches its levels."""
    servers = [Server(store), Server(store)]
    cube = Cube(10**6, 64)
    _, document = parsed(servers[0].call("POST", "/v1/volumes?" + cube.query, cube.bytes,
                                         {"Content-Type": "application/octet-stream"}))
    volume, seen, slowest = document["id"], {}, 0.0
    for number in range(rounds):
        request = {"range": [float(number % 10), None]}
        victim = number % 2
        status, resource = servers[victim].json("POST", f"/v1/volumes/{volume}/extractions", request)
        assert status in (200, 202), (status, resource)
        extraction, results = resource["id"], []
        start = time.monotonic()
        client = threading.Thread(target=lambda e=extraction, r=results: r.append(fetch_levels(servers, e)))
        client.start()
        time.sleep(world.random.random() * 0.3)
        servers[victim].kill()
        time.sleep(world.random.random() * 0.2)
        servers[victim].start()
        client.join()
        slowest = max(slowest, time.monotonic() - start)
        assert results, "the client got no levels"
        assert seen.setdefault(extraction, results[0]) == results[0], "other bytes than before"
        assert servers[1 - victim].call("DELETE", f"/v1/extractions/{extraction}?purge=true")[0] == 204
        world.count("pairs")
    for server in servers:
        server.kill()
    print(f"{rounds} rounds of two servers; the slowest took {slowest:.1f} s", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=1000)
    parser.add_argument("--pairs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    parser.add_argument("--store", default=None, help="parent folder of the stores")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    folder = tempfile.mkdtemp(prefix="geosis-kill-", dir=options.store)
    world = World(options.seed)
    start = time.monotonic()
    kill_rounds(os.path.join(folder, "one"), world, options.rounds)
    pair_rounds(os.path.join(folder, "two"), world, options.pairs)
    shutil.rmtree(folder)
    print(f"{time.monotonic() - start:.0f} s: {world.counts}", flush=True)


if __name__ == "__main__":
    main()
