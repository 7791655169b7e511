#!/usr/bin/env python3
"""Uploads to and streams from this server's gRPC door, and a bare gRPC server with the same messages, in turns: one that throws chunks
away or makes them of zeros, and an echo that sends each back. And the same upload over HTTP, by curl, which tells how much of an upload
is the import.

    bench/load/grpc_against_bare.py build/release/geosis build/bench/bench/load/grpc_transfer [--rounds 9] [--json FILE] [--folder DIR]

Beside the rates: processor time of the server, and of server and client together, for each megabyte. The upload is imported, checked and stored;
the streamed level comes from the store, its parts checked.
"""
import argparse
import array
import json
import os
import random
import statistics
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path

DIMS = (320, 320, 640)  # 250 MiB of float32
NOISE = (200, 200, 200)  # levels of many triangles
TICKS = os.sysconf("SC_CLK_TCK")


def cpu_of(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def call(url, body=None, method=None, headers=None):
    with urllib.request.urlopen(urllib.request.Request(url, data=body, method=method, headers=headers or {})) as answer:
        return answer.read()


def measured(transfer, server, *arguments):
    """Rate and processor time of one transfer."""
    before = cpu_of(server)
    said = json.loads(subprocess.run([transfer, *map(str, arguments)], check=True, capture_output=True).stdout)
    megabytes, used = said["bytes"] / 1e6, cpu_of(server) - before
    return {"MB/s": megabytes / said["seconds"], "server ms/MB": 1000 * used / megabytes,
            "both ms/MB": 1000 * (used + said["cpu_seconds"]) / megabytes, "bytes": said["bytes"]}


def measured_http(url, path, server):
    before, start = cpu_of(server), time.monotonic()
    subprocess.run(["curl", "-fsS", "-o", "/dev/null", "-X", "POST", "-T", path, url], check=True)
    megabytes = path.stat().st_size / 1e6
    return {"MB/s": megabytes / (time.monotonic() - start), "server ms/MB": 1000 * (cpu_of(server) - before) / megabytes}


def amplitudes(count):
    """Random float32 like those of a survey. Of random bits one number in 256 would be none, and its trace decoded apart."""
    generator = random.Random(1)
    return array.array("f", (generator.gauss(0, 1000) for _ in range(count))).tobytes()


def remove_cube(http):
    for volume in json.loads(call(f"{http}/v1/volumes"))["volumes"]:
        if volume["dims"] == list(DIMS):
            call(f"{http}{volume['links']['self']}", method="DELETE")


def medians(runs):
    return {name: round(statistics.median(run[name] for run in runs), 3) for name in runs[0]}


def noise_extraction(http):
    """Id of an extraction with one big level."""
    samples = random.Random(7).randbytes(NOISE[0] * NOISE[1] * NOISE[2])
    dims = ",".join(map(str, NOISE))
    volume = json.loads(call(f"{http}/v1/volumes?format=raw&dtype=uint8&dims={dims}", samples))["id"]
    request = json.dumps({"range": [128, None], "levels": [{"ratio": 1}]}).encode()
    while True:
        extraction = json.loads(call(f"{http}/v1/volumes/{volume}/extractions", request,
                                     headers={"Prefer": "wait=60", "Content-Type": "application/json"}))
        if extraction["state"] not in ("queued", "running"):
            assert extraction["state"] == "done", extraction
            return extraction["id"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("geosis")
    parser.add_argument("transfer")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--json")
    parser.add_argument("--folder", help="where the store goes: /dev/shm leaves the disk out")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        cube = Path(folder, "cube.raw")
        cube.write_bytes(amplitudes(1 << 18) * (DIMS[0] * DIMS[1] * DIMS[2] >> 18))
        server = subprocess.Popen([options.geosis, "serve", "--listen", "127.0.0.1:0", "--grpc", "127.0.0.1:0", "--admin", "",
                                   "--store", Path(folder, "store"), "--log-level", "error"], stdout=subprocess.PIPE, text=True)
        bare = subprocess.Popen([options.transfer, "bare"], stdout=subprocess.PIPE, text=True)
        try:
            http = server.stdout.readline().split()[-1]
            ours = server.stdout.readline().split("//")[-1].strip()
            other = bare.stdout.readline().strip()
            extraction = noise_extraction(http)
            runs = {name: [] for name in ("upload", "bare upload", "http upload", "stream", "bare stream", "echo")}
            dims = ",".join(map(str, DIMS))
            for _ in range(options.rounds):
                runs["upload"].append(measured(options.transfer, server.pid, "upload", ours, cube, dims))
                runs["bare upload"].append(measured(options.transfer, bare.pid, "upload", other, cube, dims))
                remove_cube(http)
                runs["http upload"].append(measured_http(f"{http}/v1/volumes?format=raw&dims={dims}", cube, server.pid))
                remove_cube(http)
                runs["stream"].append(measured(options.transfer, server.pid, "stream", ours, extraction))
                bytes_of_levels = runs["stream"][-1]["bytes"]
                runs["echo"].append(measured(options.transfer, bare.pid, "echo", other, cube))
                runs["bare stream"].append(measured(options.transfer, bare.pid, "stream", other, bytes_of_levels))
        finally:
            for process in (server, bare):
                process.terminate()
                process.wait()
    result = {name: medians(found) for name, found in runs.items()}
    for mine, other in (("upload", "echo"), ("stream", "echo"), ("upload", "bare upload"), ("stream", "bare stream"),
                        ("upload", "http upload")):
        pairs = zip(runs[mine], runs[other])
        result[f"{mine} / {other}"] = round(statistics.median(one["MB/s"] / two["MB/s"] for one, two in pairs), 3)
    print(json.dumps(result, indent=2))
    if options.json:
        commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
        machine = {"processors": os.cpu_count(), "load": os.getloadavg()[0], "commit": commit, "rounds": options.rounds,
                   "store": options.folder or "disk"}
        Path(options.json).write_text(json.dumps({"machine": machine, **result}, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
