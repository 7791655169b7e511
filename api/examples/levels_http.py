#!/usr/bin/env python3
"""Uploads a survey, asks for the body of a range, and writes its levels as they come, over HTTP with requests.

    ./levels_http.py http://127.0.0.1:8080 survey.sgy 0.5 inf levels

Debian: apt install python3-requests. A server with keys: KEY=... ./levels_http.py ...
"""
import email
import email.policy
import json
import math
import os
import sys
from pathlib import Path

import requests


def session():
    session = requests.Session()
    if "KEY" in os.environ:
        session.headers["Authorization"] = "Bearer " + os.environ["KEY"]
    return session


def checked(answer):
    """The answer; a problem ends the program with what the server says of it."""
    if answer.status_code >= 400:
        problem = answer.json()
        sys.exit(f"{problem['code']}: {problem['detail']}")
    return answer


def upload(http, server, path):
    with open(path, "rb") as survey:  # sent as it is read: any size will do
        answer = http.post(f"{server}/v1/volumes", params={"name": path.name}, data=survey,
                           headers={"Content-Type": "application/octet-stream"})
    return checked(answer).json()


def levels(http, server, volume, low, high):
    """Yields (level, part, bytes), coarsest level first, and at last (None, None, manifest). The whole answer is read here; a
    program that shows levels as they come reads it part by part."""
    ends = [None if math.isinf(end) else end for end in (low, high)]
    answer = http.post(server + volume["links"]["self"] + "/extractions", json={"range": ends},
                       headers={"Accept": "multipart/mixed"})
    head = f"Content-Type: {checked(answer).headers['Content-Type']}\r\n\r\n"
    for part in email.message_from_bytes(head.encode() + answer.content, policy=email.policy.HTTP).iter_parts():
        data = part.get_payload(decode=True)
        if part.get_content_type() == "application/json":
            yield None, None, json.loads(data)
        else:
            yield int(part["X-Geosis-Level"]), int(part["X-Geosis-Part"]), data


def main():
    server, survey, low, high, out = sys.argv[1], Path(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4]), Path(sys.argv[5])
    out.mkdir(parents=True, exist_ok=True)
    http = session()
    volume = upload(http, server, survey)
    print("volume", volume["id"], volume["dims"])
    for level, part, data in levels(http, server, volume, low, high):
        if level is None:
            (out / "manifest.json").write_text(json.dumps(data, indent=2), encoding="utf-8")
        else:
            (out / f"lod{level}.{part}.drc").write_bytes(data)
            print(f"level {level} part {part}: {len(data)} bytes")


if __name__ == "__main__":
    main()
