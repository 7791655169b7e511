#!/usr/bin/env python3
"""A grid of placed nodes: its upload, and an extraction on it beside one on the axis grid, each by a server of its own.

    bench/load/placed_grid.py build/release/geosis [--side 256] [--rounds 3] [--folder DIR] [--json FILE]

Memory is RssAnon + RssShmem at its peak above what the idle server had. Needs 40 bytes a sample on the disk.
"""
import argparse
import array
import http.client
import json
import math
import os
import statistics
import subprocess
import tempfile
import threading
import time
import urllib.parse
from pathlib import Path


def write_files(folder, side):
    """A gyroid, and a grid whose inlines fan out around a far centre while samples thicken."""
    s = 0.09
    sines, cosines = [math.sin(s * n) for n in range(side)], [math.cos(s * n) for n in range(side)]
    with (folder / "volume").open("wb") as volume, (folder / "nodes").open("wb") as nodes:
        for i in range(side):
            samples, positions = array.array("f"), array.array("d")
            for j in range(side):
                samples.extend(sines[i] * cosines[j] + sines[j] * cosines[k] + sines[k] * cosines[i] for k in range(side))
                radius, hill = 9000 + 25 * j, 1000 + 20 * math.sin(0.03 * j)
                x, y = 5e5 + radius * math.sin(0.003 * i), 6e6 + radius * math.cos(0.003 * i)
                for k in range(side):
                    positions.extend((x, y, hill + 4 * k + 0.01 * k * k))
            samples.tofile(volume)
            positions.tofile(nodes)


class Server:
    """One with its memory watched; a context manager."""

    def __init__(self, binary, store):
        self._command = [binary, "serve", "--listen", "127.0.0.1:0", "--grpc", "off", "--admin", "", "--store", store,
                         "--log-level", "error"]

    def __enter__(self):
        self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE, text=True)
        self._address = urllib.parse.urlsplit(self._process.stdout.readline().split()[-1]).netloc
        self._peak, self._stop = 0, threading.Event()
        threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._process.terminate()
        self._process.wait()

    def _memory(self):
        status = Path(f"/proc/{self._process.pid}/status").read_text(encoding="ascii")
        return sum(int(line.split()[1]) for line in status.splitlines() if line.startswith(("RssAnon", "RssShmem"))) / 1024

    def _processor_seconds(self):
        fields = Path(f"/proc/{self._process.pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _watch(self):
        while not self._stop.wait(0.005):
            self._peak = max(self._peak, self._memory())

    def call(self, target, body, **headers):
        """The answer's document, and what it took."""
        named = {name.replace("_", "-"): str(value) for name, value in headers.items()}
        idle, begin, processor = self._memory(), time.monotonic(), self._processor_seconds()
        self._peak = idle
        connection = http.client.HTTPConnection(self._address, timeout=600)
        connection.request("POST", target, body, named)
        reply = connection.getresponse()
        document = json.loads(reply.read())
        assert reply.status < 300, document
        return document, {"seconds": time.monotonic() - begin, "processor_seconds": self._processor_seconds() - processor,
                          "memory_mb": self._peak - idle}

    def send_file(self, target, path):
        with path.open("rb") as file:
            return self.call(target, file, Content_Type="application/octet-stream", Content_Length=path.stat().st_size)


def measure(binary, folder, side, rounds):
    found = {"grid upload": [], "extraction, axis grid": [], "extraction, placed grid": []}
    for number in range(rounds):
        store = folder / f"store{number}"
        with Server(binary, store) as server:
            volume = server.send_file(f"/v1/volumes?format=raw&dims={side},{side},{side}", folder / "volume")[0]["id"]
            grid, took = server.send_file(f"/v1/volumes/{volume}/grids?dtype=float64", folder / "nodes")
            found["grid upload"].append(took)
        levels = {}
        for name, asked in (("extraction, axis grid", "given"), ("extraction, placed grid", grid["id"])):
            with Server(binary, store) as server:
                body = json.dumps({"range": [0, None], "grid": asked})
                done, took = server.call(f"/v1/volumes/{volume}/extractions", body, Content_Type="application/json", Prefer="wait=60")
                assert done["state"] == "done", done
                found[name].append({**took, **done["timings"]})
                levels[name] = [(level["triangles"], level["euler"], level["components"]) for level in done["levels"]]
        finest = {level[-1] for level in levels.values()}
        assert len(finest) == 1, levels
    return found, finest.pop()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binary")
    parser.add_argument("--side", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--folder", default=None)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        write_files(Path(folder), arguments.side)
        found, finest = measure(arguments.binary, Path(folder), arguments.side, arguments.rounds)
    medians = {name: {key: round(statistics.median(took[key] for took in all_took), 3) for key in all_took[0]}
               for name, all_took in found.items()}
    result = {"side": arguments.side, "rounds": arguments.rounds, "triangles, euler, components": finest, "medians": medians}
    print(json.dumps(result, indent=2))
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
