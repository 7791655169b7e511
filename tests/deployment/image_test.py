"""The images as they are deployed: read-only, without root or capabilities, bounded, two servers on one store behind the edge.

Environment: GEOSIS = the built binary, for a survey; PYTHONPATH = the contract's messages as protoc makes them. Root;
.ci/images.sh before it.
"""
import ctypes
import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import grpc
from geosis.v1 import extraction_pb2, extraction_pb2_grpc, volume_pb2, volume_pb2_grpc

from containers import IMAGES, Container, Names, make_network, remove_control_groups, run

GEOSIS = os.environ["GEOSIS"]
EDGE, FIRST, SECOND = "10.77.0.2", "10.77.0.3", "10.77.0.4"
MEMORY = 1 << 30


def alone():
    """This program again, in a network and with mounts that nobody else sees; whatever it starts ends with it."""
    if os.environ.get("GEOSIS_ALONE") != "yes":
        os.environ["GEOSIS_ALONE"] = "yes"
        os.execvp("unshare", ["unshare", "--net", "--mount", sys.executable, *sys.argv])
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def setUpModule():
    global FOLDER, SURVEY
    if os.geteuid() != 0:
        raise unittest.SkipTest("needs root, for namespaces and control groups")
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-containers-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    unittest.addModuleCleanup(remove_control_groups)
    make_network()
    subprocess.run([GEOSIS, "synth", FOLDER / "survey.sgy", "--dims", "80,90,100"], check=True)
    SURVEY = (FOLDER / "survey.sgy").read_bytes()


def volume_of(name, image, inside):
    """A folder as a new volume of Docker is: with the owner and the mode that the image gave it."""
    folder = FOLDER / name
    if not folder.exists():
        shutil.copytree(IMAGES / image / inside.lstrip("/"), folder)
        shutil.copystat(IMAGES / image / inside.lstrip("/"), folder)
        owner = (IMAGES / image / inside.lstrip("/")).stat()
        os.chown(folder, owner.st_uid, owner.st_gid)
    return {inside: folder}


def server(name="geosis-1", address=FIRST, store="store", keys=None, **environment):
    return Container(FOLDER, "geosis", name, address, volume_of(store, "geosis", "/data"), environment, memory=MEMORY, keys=keys)


def edge():
    return Container(FOLDER, "edge", "edge", EDGE, volume_of("kept", "edge", "/var/cache/edge"))


def call(address, method, target, body=None, port=8080, **headers):
    connection = http.client.HTTPConnection(address, port, timeout=60)
    try:
        connection.request(method, target, body, {name.replace("_", "-"): value for name, value in headers.items()})
        reply = connection.getresponse()
        return reply.status, {name.lower(): value for name, value in reply.getheaders()}, reply.read()
    finally:
        connection.close()


def extraction_by(address):
    """Uploads the survey, waits for five levels, and returns {path: bytes} of them and of the manifest."""
    status, _, volume = call(address, "POST", "/v1/volumes", SURVEY)
    assert status in (200, 201), volume
    target = f"/v1/volumes/{json.loads(volume)['id']}/extractions"
    status, _, body = call(address, "POST", target, '{"range": [0.5, null]}', Prefer="wait=60")
    assert status == 200, body
    extraction = f"/v1/extractions/{json.loads(body)['id']}"
    files = {}
    for name in ("manifest", *(f"lods/{level}.drc" for level in range(5))):
        status, _, files[f"{extraction}/{name}"] = call(address, "GET", f"{extraction}/{name}")
        assert status == 200, name
    return files


def stream_by_grpc(address, extraction):
    """Manifest and parts, {level.part: bytes}, of a finished extraction."""
    parts, manifest = {}, None
    with grpc.insecure_channel(f"{address}:8081") as channel:
        request = extraction_pb2.StreamLodsRequest(id=extraction.rsplit("/", 1)[1])
        for chunk in extraction_pb2_grpc.ExtractionServiceStub(channel).StreamLods(request, timeout=60):
            if chunk.WhichOneof("content") == "manifest":
                manifest = chunk.manifest
            else:
                name = f"{chunk.part.level}.{chunk.part.part}"
                parts[name] = parts.get(name, b"") + chunk.part.data
    return manifest, parts


def volumes_by_grpc(address, *metadata):
    with grpc.insecure_channel(f"{address}:8081") as channel:
        stub = volume_pb2_grpc.VolumeServiceStub(channel)
        return len(stub.ListVolumes(volume_pb2.ListVolumesRequest(), metadata=metadata, timeout=20).volumes)


class Images(unittest.TestCase):
    def test_they_hold_nothing_that_only_building_needs(self):
        for name in ("geosis", "edge"):
            packages = run("dpkg-query", "--admindir", IMAGES / name / "var/lib/dpkg", "--show", "--showformat", "${Package}\n").split()
            self.assertEqual([package for package in packages if package.endswith("-dev") or package.startswith(("g++", "gcc-1", "node"))
                              and package != "gcc-12-base"], [])
            self.assertFalse((IMAGES / name / "source").exists())
            self.assertEqual(list((IMAGES / name / "var/lib/apt").glob("lists/*")), [])


class Server(unittest.TestCase):
    def test_it_does_its_job_with_nothing_but_its_store(self):
        with server(store="alone") as one:
            one.wait_until_healthy()
            status = one.status()
            self.assertEqual(status["Uid"], ["10001"] * 4)
            self.assertEqual({status[name][0] for name in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb")}, {"0" * 16})
            self.assertEqual(status["NoNewPrivs"], ["1"])
            self.assertEqual(one.limit("memory", ("memory.limit_in_bytes", "memory.max")), MEMORY)
            self.assertEqual(one.limit("pids", ("pids.max", "pids.max")), one.service["pids_limit"])
            for path in ("/usr/x", "/etc/x", "/x"):
                status, said = one.execute("touch", path)
                self.assertNotEqual(status, 0, path)
                self.assertRegex(said, "Read-only|denied")
            self.assertEqual(len(extraction_by(FIRST)), 6)
            _, _, metrics = call(FIRST, "GET", "/metrics", port=9464)
            budget = next(float(line.split()[1]) for line in metrics.decode().splitlines()
                          if line.startswith("geosis_memory_budget_bytes"))
            self.assertAlmostEqual(budget / MEMORY, 0.7, delta=0.01)
            self.assertLess(int(one.status()["Threads"][0]), one.service["pids_limit"])
            status, _, page = call(FIRST, "GET", "/")
            self.assertEqual([status, b"viewer.js" in page], [200, True])
            self.assertEqual(one.stop(), 0)

    def test_it_finishes_what_runs_when_it_is_stopped(self):
        with server(store="drained") as one:
            one.wait_until_healthy()
            upload = http.client.HTTPConnection(FIRST, 8080, timeout=60)
            upload.putrequest("POST", "/v1/volumes")
            upload.putheader("Content-Length", str(len(SURVEY)))
            upload.endheaders()
            upload.send(SURVEY[:len(SURVEY) // 2])
            time.sleep(0.5)
            status = []
            stopping = threading.Thread(target=lambda: status.append(one.stop()))
            stopping.start()
            time.sleep(1)
            self.assertEqual(status, [])
            upload.send(SURVEY[len(SURVEY) // 2:])
            self.assertEqual(upload.getresponse().status, 201)
            upload.close()
            stopping.join()
            self.assertEqual(status, [0])

    def test_it_does_not_start_before_it_is_said_who_may_call(self):
        with server(store="open", GEOSIS_AUTH=None) as one:
            self.assertEqual(one.process.wait(timeout=30), 1)
            self.assertIn("--auth", one.log.read_text())


    def test_with_a_file_of_keys_it_answers_those_who_have_one(self):
        key, line = run(GEOSIS, "key", "--name", "ci").split("\n")[:2]
        keys = FOLDER / "keys.txt"
        keys.write_text(line + "\n")
        keys.chmod(0o600)
        with server(store="keyed", keys=keys) as one:  # root's file, which the server's user cannot read
            self.assertEqual(one.process.wait(timeout=30), 1)
            self.assertIn("/run/secrets/geosis_keys", one.log.read_text())
        os.chown(keys, 10001, 0)
        with server(store="keyed", keys=keys) as one:
            one.wait_until_healthy()
            self.assertEqual(call(FIRST, "GET", "/v1/volumes")[0], 401)
            self.assertEqual(call(FIRST, "GET", "/v1/volumes", Authorization=f"Bearer {key}")[0], 200)
            with self.assertRaises(grpc.RpcError) as refused:
                volumes_by_grpc(FIRST)
            self.assertEqual(refused.exception.code(), grpc.StatusCode.UNAUTHENTICATED)
            self.assertEqual(volumes_by_grpc(FIRST, ("authorization", f"Bearer {key}")), 0)
            self.assertEqual(one.stop(), 0)


class Deployment(unittest.TestCase):
    def test_two_servers_on_one_store_behind_the_edge(self):
        with (server("geosis-1", FIRST) as first, server("geosis-2", SECOND) as second, edge() as before,
              Names(before, [FIRST, SECOND])):
            for container in (first, second, before):
                container.wait_until_healthy()
            status = before.status()
            self.assertEqual([status["Uid"], status["CapEff"], status["NoNewPrivs"]], [["10002"] * 4, ["0" * 16], ["1"]])
            files = extraction_by(EDGE)
            for path, body in files.items():
                status, headers, again = call(EDGE, "GET", path)
                self.assertEqual([status, headers["x-cache"], again == body], [200, "HIT", True], path)
                for address in (FIRST, SECOND):
                    self.assertTrue(call(address, "GET", path)[2] == body, "another server has other bytes")
            extraction = next(iter(files)).rsplit("/", 1)[0]
            manifest, parts = stream_by_grpc(EDGE, extraction)
            self.assertEqual(manifest.id, extraction.rsplit("/", 1)[1])
            for level in range(5):
                self.assertTrue(parts[f"{level}.0"] == files[f"{extraction}/lods/{level}.drc"])
            for _ in range(8):
                call(EDGE, "GET", "/v1/volumes")
            lines = [json.loads(line) for line in before.log.read_text().splitlines() if line.startswith("{")]
            self.assertEqual({line["upstream"] for line in lines if line["path"] == "/v1/volumes"}, {f"{FIRST}:8080", f"{SECOND}:8080"})
            self.assertEqual(call(EDGE, "GET", "/metrics")[0], 404)

            second.kill("KILL")
            second.process.wait(timeout=30)
            self.assertEqual([call(EDGE, "GET", "/v1/volumes")[0] for _ in range(8)], [200] * 8)
            self.assertEqual([volumes_by_grpc(EDGE) for _ in range(8)], [1] * 8)
            self.assertEqual([before.stop(), first.stop()], [0, 0])


if __name__ == "__main__":
    alone()
    unittest.main()
