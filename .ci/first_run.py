#!/usr/bin/env python3
"""Uploads a survey to a running server, reconstructs a body, and prints its certificate.

usage: first_run.py SERVER_URL SURVEY LOW HIGH [--addresses]

Exit status 0 only if all levels are there. --addresses also prints where volume, manifest and page are.
"""
import json
import os
import sys
import urllib.error
import urllib.parse
import urllib.request

# The server is on this machine: a proxy of the environment is none of its business.
OPENER = urllib.request.build_opener(urllib.request.ProxyHandler({}))


def call(url, data=None, **headers):
    """The answer's JSON. `data` is bytes or an open file; headers have underscores for dashes."""
    request = urllib.request.Request(url, data=data, headers={k.replace("_", "-"): v for k, v in headers.items()})
    try:
        with OPENER.open(request) as answer:
            return json.load(answer)
    except urllib.error.HTTPError as refusal:
        problem = json.load(refusal)
        sys.exit(f"run: {problem['code']}: {problem['detail']}")


def upload(server, path):
    name = urllib.parse.quote(os.path.basename(path))
    with open(path, "rb") as survey:
        return call(f"{server}/v1/volumes?name={name}", data=survey, Content_Length=str(os.path.getsize(path)),
                    Content_Type="application/octet-stream")


def range_end(text):
    return None if text.lstrip("+-").lower() in ("inf", "infinity") else float(text)


def reconstruct(server, volume, low, high):
    request = json.dumps({"range": [range_end(low), range_end(high)]}).encode()
    extraction = call(f"{server}/v1/volumes/{volume['id']}/extractions", data=request, Prefer="wait=60",
                      Content_Type="application/json")
    while extraction["state"] in ("queued", "running"):
        extraction = call(f"{server}/v1/volumes/{volume['id']}/extractions", data=request, Prefer="wait=60")
    if extraction["state"] != "done":
        sys.exit(f"run: the extraction {extraction['state']}: {extraction['error']}")
    return extraction


def print_certificate(manifest):
    print(f"{'level':>5} {'triangles':>10} {'vertices':>10} {'components':>10} {'euler':>8} {'genus':>6} {'manifold':>8}"
          f" {'mean':>9} {'max':>9} {'bytes':>10}  stopped by")
    for level in manifest["levels"]:
        distance = level["distance"]
        print(f"{level['level']:>5} {level['triangles']:>10} {level['vertices']:>10} {level['components']:>10}"
              f" {level['euler']:>8} {level['genus']:>6} {'yes' if level['manifold'] else 'no':>8}"
              f" {distance['mean_voxels']:>9.4f} {distance['max_voxels']:>9.4f} {level['bytes']:>10}"
              f"  {level['stopped_by'] or '-'}")
    print("(mean, max: distance to level 0 in voxels)")


def main():
    show_addresses = sys.argv[5:] == ["--addresses"]
    if len(sys.argv) != 5 and not show_addresses:
        sys.exit(__doc__)
    server, survey, low, high = sys.argv[1:5]
    volume = upload(server, survey)
    inlines, crosslines, samples = volume["dims"]
    print(f"{volume['name']}: {inlines} inlines x {crosslines} crosslines x {samples} samples,"
          f" {volume['missing']['traces']} traces missing")
    extraction = reconstruct(server, volume, low, high)
    manifest = call(server + extraction["links"]["manifest"])
    print_certificate(manifest)
    if show_addresses:
        print(f"\nvolume    {server}{volume['links']['self']}")
        print(f"manifest  {server}{extraction['links']['manifest']}")
        print(f"page      {server}/?volume={volume['id']}")
    asked = len(manifest["request"]["levels"])
    if len(manifest["levels"]) != asked and not manifest["empty"]:
        sys.exit(f"run: {len(manifest['levels'])} levels of {asked}")


if __name__ == "__main__":
    main()
