"""prober.py ADDRESS TARGET SECONDS: asks for TARGET on new and kept connections in turn, prints latencies as JSON."""
import http.client
import json
import sys
import time


def main(address, target, seconds):
    kept = http.client.HTTPConnection(address, timeout=30)
    times, failures = [], []
    end = time.monotonic() + float(seconds)
    while time.monotonic() < end:
        for connection in (kept, http.client.HTTPConnection(address, timeout=30)):
            start = time.monotonic()
            try:
                connection.request("GET", target)
                answer = connection.getresponse()
                answer.read()
                if answer.status != 200:
                    failures.append(answer.status)
            except (OSError, http.client.HTTPException) as error:
                failures.append(repr(error))
                kept = http.client.HTTPConnection(address, timeout=30)
            times.append(time.monotonic() - start)
            if connection is not kept:
                connection.close()
        time.sleep(0.005)
    times.sort()
    print(json.dumps({"count": len(times), "failures": failures[:5], "p50": times[len(times) // 2],
                      "p99": times[int(len(times) * 0.99)], "max": times[-1]}))


main(*sys.argv[1:])
