#!/usr/bin/env python3
"""A level from this server's memory against the same file from nginx, in turns: requests a second and processor time.

    bench/load/level_against_nginx.py build/release/geosis [--rounds 9] [--seconds 3] [--json FILE]

Needs `nginx-light` and `wrk`. On a machine that has other work, compare processor time a request: nginx's two workers
get two shares of the processors, our one loop gets one.
"""
import argparse
import contextlib
import json
import os
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

DIMS = "340,340,256"  # a level of about 230 KB
REQUEST = {"range": [0.55, None], "levels": [{"ratio": 1}]}


def call(url, body=None, headers=None):
    with urllib.request.urlopen(urllib.request.Request(url, data=body, headers=headers or {})) as answer:
        return answer.read()


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def geosis(binary, folder):
    """(url of the level, pids)"""
    subprocess.run([binary, "synth", folder / "survey.sgy", "--dims", DIMS], check=True, stdout=subprocess.DEVNULL)
    process = subprocess.Popen([binary, "serve", "--listen", "127.0.0.1:0", "--grpc", "off", "--store", folder / "store"],
                               stdout=subprocess.PIPE, text=True)
    try:
        url = process.stdout.readline().split()[-1]
        volume = json.loads(call(f"{url}/v1/volumes", (folder / "survey.sgy").read_bytes()))["id"]
        extraction = json.loads(call(f"{url}/v1/volumes/{volume}/extractions", json.dumps(REQUEST).encode(),
                                     {"Prefer": "wait=60", "Content-Type": "application/json"}))
        assert extraction["state"] == "done", extraction
        yield f"{url}/v1/extractions/{extraction['id']}/lods/0.drc", [process.pid]
    finally:
        process.terminate()
        process.wait()


@contextlib.contextmanager
def nginx(folder):
    port = free_port()
    (folder / "nginx.conf").write_text(f"""
worker_processes 2; daemon off; pid {folder}/nginx.pid; error_log {folder}/nginx.log; events {{ worker_connections 1024; }}
http {{ access_log off; sendfile on; tcp_nopush on; keepalive_requests 1000000; client_body_temp_path {folder}/body;
        server {{ listen 127.0.0.1:{port}; root {folder}/www; }} }}
""", encoding="ascii")
    process = subprocess.Popen(["nginx", "-c", folder / "nginx.conf"])
    try:
        time.sleep(0.5)
        workers = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=True).stdout
        yield f"http://127.0.0.1:{port}/level.drc", [int(pid) for pid in workers.split()]
    finally:
        process.terminate()
        process.wait()


def processor_seconds(pids):
    ticks = 0
    for pid in pids:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def measure(url, pids, seconds):
    before = processor_seconds(pids)
    said = subprocess.run(["wrk", "-t2", "-c32", f"-d{seconds}", url], capture_output=True, text=True, check=True).stdout
    spent = processor_seconds(pids) - before
    assert "Non-2xx" not in said, said
    return {"requests_per_second": float(re.search(r"Requests/sec:\s+([\d.]+)", said)[1]),
            "processor_us": spent / int(re.search(r"(\d+) requests in", said)[1]) * 1e6}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("geosis", type=Path)
    arguments.add_argument("--rounds", type=int, default=9)
    arguments.add_argument("--seconds", type=int, default=3)
    arguments.add_argument("--json", type=Path)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)  # nginx's workers are another user
        (folder / "www").mkdir()
        with geosis(given.geosis.resolve(), folder) as ours:
            level = call(ours[0])
            (folder / "www" / "level.drc").write_bytes(level)
            with nginx(folder) as theirs:
                assert call(theirs[0]) == level
                rounds = [{name: measure(*server, given.seconds) for name, server in (("nginx", theirs), ("geosis", ours))}
                          for _ in range(given.rounds)]
    median = {name: {key: statistics.median(r[name][key] for r in rounds) for key in rounds[0][name]} for name in rounds[0]}
    ratio = statistics.median(r["geosis"]["requests_per_second"] / r["nginx"]["requests_per_second"] for r in rounds)
    result = {"level_bytes": len(level), "connections": 32, "rounds": rounds, "median": median, "median_ratio": ratio,
              "load": os.getloadavg()[0], "processors": os.cpu_count()}
    if given.json:
        given.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    print(f"{len(level)} bytes; median {median}; geosis/nginx {ratio:.2f}; load {result['load']:.1f}", file=sys.stderr)


main()
