#!/usr/bin/env python3
"""An upload of a raw volume against cp + fsync of the same file into the store's disk, in turns; and the server's memory.

    bench/load/upload_against_cp.py build/release/geosis [--rounds 5] [--side 1024] [--folder DIR] [--json FILE]

Needs `curl` and three times the volume's bytes on the disk (1024 a side: 13 GB). Memory is RssAnon + RssShmem at its
peak above what the idle server had.
"""
import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path


# A float32 is infinite or NaN only when its highest byte is 0x7f or 0xff.
FINITE = bytes(byte & 0xbf if byte in (0x7f, 0xff) else byte for byte in range(256))


def write_volume(path, side):
    """Finite float32 samples of random bytes: nothing on the way to the disk can make them less."""
    with path.open("wb") as out:
        for _ in range(side):
            samples = bytearray(os.urandom(4 * side * side))
            samples[3::4] = samples[3::4].translate(FINITE)
            out.write(samples)


def copy_and_sync(source, target):
    begin = time.monotonic()
    subprocess.run(["cp", source, target], check=True)
    with target.open("rb") as file:
        os.fsync(file.fileno())
    seconds = time.monotonic() - begin
    target.unlink()
    return seconds


def own_memory(pid):
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    return sum(int(line.split()[1]) for line in status.splitlines() if line.startswith(("RssAnon", "RssShmem"))) / 1024


def processor_seconds(pid):
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def upload(binary, folder, volume, side, order):
    store = folder / "store"
    process = subprocess.Popen([binary, "serve", "--listen", "127.0.0.1:0", "--store", store], stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, text=True)
    try:
        url = process.stdout.readline().split()[-1]
        time.sleep(0.5)
        idle, peak, done = own_memory(process.pid), [0.0], threading.Event()

        def watch():
            while not done.wait(0.02):
                peak[0] = max(peak[0], own_memory(process.pid))

        watcher = threading.Thread(target=watch)
        watcher.start()
        before, begin = processor_seconds(process.pid), time.monotonic()
        subprocess.run(["curl", "-sSf", "-o", folder / "answer", "-X", "POST", "-H", "Expect:", "-T", volume,
                        f"{url}/v1/volumes?format=raw&dtype=float32&dims={side},{side},{side}&order={order}"], check=True)
        seconds, spent = time.monotonic() - begin, processor_seconds(process.pid) - before
        done.set()
        watcher.join()
        return {"seconds": seconds, "processor_seconds": spent, "memory_mb": peak[0] - idle}
    finally:
        process.terminate()
        process.wait()
        shutil.rmtree(store, ignore_errors=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("geosis", type=Path)
    arguments.add_argument("--rounds", type=int, default=5)
    arguments.add_argument("--side", type=int, default=1024)
    arguments.add_argument("--folder", type=Path, help="on the disk to measure; default: the system's for temporary files")
    arguments.add_argument("--json", type=Path)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory(dir=given.folder) as name:
        folder, rounds = Path(name), []
        volume = folder / "volume.raw"
        write_volume(volume, given.side)
        for _ in range(given.rounds):
            taken = {"cp": copy_and_sync(volume, folder / "copy")}
            taken |= {order: upload(given.geosis.resolve(), folder, volume, given.side, order) for order in ("sample", "inline")}
            rounds.append(taken)
            print(json.dumps(taken), file=sys.stderr)
        size = volume.stat().st_size
    copy = statistics.median(r["cp"] for r in rounds)
    result = {"bytes": size, "cp_seconds": copy, "rounds": rounds, "load": os.getloadavg()[0]}
    for order in ("sample", "inline"):
        median = {key: statistics.median(r[order][key] for r in rounds) for key in rounds[0][order]}
        result[order] = median | {"speed_of_cp": statistics.median(r["cp"] / r[order]["seconds"] for r in rounds)}
        print(order, result[order], file=sys.stderr)
    if given.json:
        given.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


main()
