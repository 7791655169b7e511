"""One list of scenarios walks both doors of a running server: same ids, same bytes, same documents, same error codes.

Each door has a tenant of its own, so each scenario meets the same store behind both. Environment: GEOSIS = the built binary,
PYTHONPATH = the contract's messages as protoc makes them.
"""
import hashlib
import json
import shutil
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.request
from pathlib import Path

from grpc_door import GrpcDoor
from http_door import HttpDoor
from placed_grids import bent, mirrored, node_bytes, pillar_bytes, upright
from refused import Refused, error_table
from service import GEOSIS, Service
from surveys import raw_cube, seismic_line, two_grids

ABSENT = "0" * 64
BALL = {"format": "raw", "dims": [24, 22, 20]}
RAW = {"format": "raw", "dims": [6, 5, 4]}
HTTP_ONLY = {"links", "url", "bodies_url", "type", "title", "status"}
CHANGING = {"created_at", "timings", "stage", "progress", "state"}


def ball():
    return raw_cube(24, 22, 20, lambda i, j, k: 64.0 - (i - 12) ** 2 - (j - 11) ** 2 - (k - 10) ** 2)


def setUpModule():
    global SERVICE, SURVEY, DOORS, READERS
    folder = Path(tempfile.mkdtemp(prefix="geosis-doors-"))
    unittest.addModuleCleanup(shutil.rmtree, folder)
    subprocess.run([GEOSIS, "synth", folder / "survey.sgy", "--dims", "40,48,44"], check=True)
    SURVEY = (folder / "survey.sgy").read_bytes()
    keys, lines = {}, []
    for tenant in ("http", "grpc"):
        for name, scopes in (("all", "volumes:read,volumes:write"), ("reader", "volumes:read")):
            made = subprocess.run([GEOSIS, "key", "--name", f"{tenant}-{name}", "--tenant", tenant, "--scopes", scopes],
                                  check=True, capture_output=True, text=True).stdout.splitlines()
            keys[tenant, name] = made[0]
            lines.append(made[1])
    (folder / "keys").write_text("\n".join(lines) + "\n", encoding="ascii")
    SERVICE = unittest.enterModuleContext(
        Service(folder / "store", "--grpc", "127.0.0.1:0", "--admin", "", "--auth", "api_keys", str(folder / "keys"),
                "--max-body", str(8 << 20), "--log-level", "error"))
    DOORS, READERS = ([HttpDoor(SERVICE.address, keys["http", name]), GrpcDoor(SERVICE.grpc_address, keys["grpc", name])]
                      for name in ("all", "reader"))


def plain(value):
    """A document without what only HTTP says, and without what is not set: null, empty, absent are one."""
    if isinstance(value, dict):
        kept = {name: plain(member) for name, member in value.items() if name not in HTTP_ONLY}
        return {name: member for name, member in kept.items() if member not in (None, "", [], {})}
    return [plain(element) for element in value] if isinstance(value, (list, tuple)) else value


def without(document, names):
    return {name: value for name, value in document.items() if name not in names}


def refusal(call, *arguments, **named):
    """What a call is refused with, after a look whether its numbers are those of the contract's table."""
    try:
        got = call(*arguments, **named)
    except Refused as refused:
        http, grpc = error_table()[refused.code]
        assert refused.status in (http, grpc), refused
        assert (refused.retry_seconds is not None) == (refused.code in ("unavailable", "quota_exceeded")), refused
        return refused
    raise AssertionError(f"it was not refused: {got}")


# ---- scenarios: each takes a door and returns what must be the same through both

def upload(door):
    volume, is_new = door.upload(SURVEY, name="survey.sgy", sha256=hashlib.sha256(SURVEY).digest())
    assert is_new and volume["state"] == "ready", volume
    again, is_new = door.upload(SURVEY, name="another name")
    assert not is_new and again["id"] == volume["id"], again
    return without(volume, {"created_at"})


def upload_of_raw_samples(door):
    volume, _ = door.upload(ball(), {**BALL, "origin": [1.5, -2, 3e6], "spacing": [25, 12.5, 4], "null_value": -0.5}, "ball")
    return without(volume, {"created_at"})


def upload_for_later(door):
    volume = door.upload_for_later(ball(), BALL)
    assert volume["state"] == "importing", volume
    while volume["state"] == "importing":
        volume = door.volume(volume["id"])
    assert volume["state"] == "ready", volume
    return without(volume, {"created_at"})


def upload_for_later_that_fails(door):
    volume = door.upload_for_later(seismic_line(6, 5))
    while volume["state"] == "importing":
        volume = door.volume(volume["id"])
    assert volume["state"] == "failed", volume
    return volume["error"]


def list_of_volumes(door):
    first = door.volumes(page_size=1)
    rest = door.volumes(page_token=first["next_page_token"])
    volumes = first["volumes"] + rest["volumes"]
    assert len(first["volumes"]) == 1 and not rest["next_page_token"], (first, rest)
    return [without(volume, {"created_at"}) for volume in volumes]


def survey_of(door):
    return door.upload(SURVEY)[0]["id"]


def ball_of(door):
    return door.upload(ball(), BALL)[0]["id"]


def histogram(door):
    return [door.histogram(survey_of(door)), door.histogram(survey_of(door), bins=7)]


def whole_request(door):
    """Every field of a request, and what the server makes of it."""
    request = {
        "range": [-0.25, None], "mode": "sampled", "missing": {"method": "rbf", "kernel": "inverse_distance", "steer": "auto",
                                                               "max_distance": 6},
        "grid": "given", "space": "index", "cap": False, "velocity": None,
        "region": {"inline": [2, 30], "crossline": [0, 40], "sample": [1, 40]},
        "bodies": {"min_voxels": 4.5, "largest": 3, "seeds": [[20, 20, 20], [10, 11, 12]]},
        "levels": [{"ratio": 1}, {"ratio": 0.5, "error_cap": None}, {"max_error": 25, "drop": {"max_voxels": 3, "max_error": 1}},
                   {"max_cost": 1e6}],
        "simplify": {"strategy": "multiple_choice", "placement": "subset", "seed": 7},
        "codec": {"position_bits": 20, "normals": True, "speed": 3},
        "attributes": ["reliability", "body", "value"], "attribute_volume": survey_of(door), "preview": False}
    created = door.create(survey_of(door), request, priority="batch")
    events = door.watch(created["id"])
    assert events[-1][1] == "done", events[-1]
    return without(created, CHANGING), without(events[-1][2], CHANGING)


def extraction(door):
    created = door.create(ball_of(door), {"range": [0, None]})
    assert created["state"] in ("queued", "running", "done"), created
    events = door.watch(created["id"])
    levels = [(number, without(data, {"distance", "volume_drift"})) for number, kind, data in events if kind == "level"]
    assert [number for number, _ in levels] == [1, 2, 3, 4, 5], levels
    assert events[-1][:2] == (6, "done"), events[-1]
    done = door.extraction(created["id"])
    assert done["state"] == "done" and done["timings"]["total"] > 0, done
    return levels, without(done, {"created_at", "timings", "stage"})


def preview(door):
    created = door.create(survey_of(door), {"range": [0.5, None], "preview": True, "attributes": ["body"]})
    parts, manifest = door.stream(created["id"])
    assert [part[3] for part in parts] == [True], parts
    assert refusal(door.bodies, created["id"]).code == "unsupported"
    return created["id"], parts, manifest


def watch_again(door):
    created = door.create(ball_of(door), {"range": [0, None]})
    door.watch(created["id"])
    assert door.watch(created["id"], after=6) == []
    return [event[:2] for event in door.watch(created["id"], after=3)]


def stream(door):
    created = door.create(ball_of(door), {"range": [0, None]})
    parts, manifest = door.stream(created["id"])
    assert [part[0] for part in parts] == [4, 3, 2, 1, 0], parts
    for number, level in enumerate(manifest["levels"]):
        for part, entry in enumerate(level["parts"]):
            assert entry["sha256"] == next(p[4] for p in parts if p[:2] == (number, part)), entry
    return parts, manifest


def structural_grid(door):
    created = door.create(survey_of(door), {"range": [0.1, None], "grid": "structural", "levels": [{"ratio": 0.25}]})
    parts, manifest = door.stream(created["id"])
    assert manifest["grid"]["chosen"] == "structural" and manifest["grid"]["layers"] > 0, manifest
    return parts, manifest


def grids(door):
    """However the same positions come, they are one grid."""
    volume = ball_of(door)
    first, is_new = door.upload_grid(volume, pillar_bytes(), {"kind": "pillars", "dtype": "float64"})
    assert is_new and first["kind"] == "pillars", first
    data = node_bytes(upright, ">d")
    again, is_new = door.upload_grid(volume, data, {"dtype": "float64", "byte_order": "big"}, hashlib.sha256(data).digest())
    assert not is_new and again["id"] == first["id"], again
    other, _ = door.upload_grid(volume, node_bytes(mirrored))
    assert other["mirrored"], other
    page = door.grids(volume, page_size=1)
    rest = door.grids(volume, page_token=page["next_page_token"])
    shown = door.grid(volume, other["id"])
    door.remove_grid(volume, other["id"])
    gone = refusal(door.grid, volume, other["id"])
    found = [first, other, shown, *page["grids"], *rest["grids"]]
    return [without(grid, {"created_at"}) for grid in found], gone.code


def depths_of(door):
    depths = raw_cube(24, 22, 20, lambda i, j, k: 1500 + 6 * k + k * k / 4 + i)
    return door.upload(depths, BALL, name="depths")[0]["id"]


def grid_from_volumes(door):
    grid, is_new = door.create_grid(ball_of(door), {"z": depths_of(door)})
    assert is_new and grid["kind"] == "volumes", grid
    assert door.create_grid(ball_of(door), {"z": depths_of(door)})[1] is False
    return without(grid, {"created_at"})


def stream_on_a_grid(door):
    volume = ball_of(door)
    grid, _ = door.upload_grid(volume, node_bytes(bent))
    plain_manifest = door.stream(door.create(volume, {"range": [0, None]})["id"])[1]
    parts, manifest = door.stream(door.create(volume, {"range": [0, None], "grid": grid["id"]})["id"])
    assert manifest["grid"]["chosen"] == "curvilinear" and manifest["grid"]["id"] == grid["id"], manifest
    for level, same in zip(manifest["levels"], plain_manifest["levels"]):
        for name in ("euler", "components", "genus", "boundary_loops", "manifold"):
            assert level[name] == same[name], (name, level, same)
    return parts, manifest


def results_go_with_their_grid(door):
    volume = ball_of(door)
    grid, _ = door.upload_grid(volume, node_bytes(mirrored, "<d"), {"dtype": "float64"})
    created = door.create(volume, {"range": [5, None], "grid": grid["id"]})
    door.watch(created["id"])
    door.remove_grid(volume, grid["id"])
    return refusal(door.extraction, created["id"]).code, created["id"]


def refused_grids(door):
    volume, data = ball_of(door), node_bytes(bent)
    holes = door.upload(raw_cube(24, 22, 20, lambda i, j, k: -1.0 if (i, j, k) == (3, 2, 1) else 1000.0 + i + 4 * k),
                        {**BALL, "null_value": -1})[0]["id"]
    small = door.upload(raw_cube(6, 5, 4), RAW)[0]["id"]
    odd = data[:12 * 45] + b"\0\0\xc0\x7f" + data[12 * 45 + 4:]
    calls = [(door.upload_grid, (volume, data[:-4])), (door.upload_grid, (volume, data + b"\0")), (door.upload_grid, (volume, odd)),
             (door.upload_grid, (volume, node_bytes(lambda i, j, k: (i, j, -k if i < 4 else k)))),
             (door.upload_grid, (volume, data, {"kind": "pillars"})), (door.upload_grid, (volume, data, {"kind": "round"})),
             (door.upload_grid, (volume, data, {"dtype": "int8"})), (door.upload_grid, (volume, data, {"byte_order": "any"})),
             (door.upload_grid, (volume, data, {}, hashlib.sha256(b"").digest())), (door.upload_grid, (ABSENT, data)),
             (door.create_grid, (volume, {})), (door.create_grid, (volume, {"z": "no-id"})), (door.create_grid, (volume, {"x": ABSENT})),
             (door.create_grid, (volume, {"z": small})), (door.create_grid, (volume, {"y": holes})),
             (door.create_grid, (ABSENT, {"z": volume})), (door.grids, (ABSENT,)), (door.grids, (volume, 1001)),
             (door.grid, (volume, ABSENT)), (door.grid, (ABSENT, ABSENT)), (door.remove_grid, (volume, ABSENT)),
             (door.create, (volume, {"range": [0, None], "grid": ABSENT}))]
    before = door.grids(volume)["grids"]
    found = [refusal(call, *arguments) for call, arguments in calls]
    assert door.grids(volume)["grids"] == before, "a refused grid is still there"
    pointers = [refused.pointer for (call, _), refused in zip(calls, found) if call in (door.create_grid, door.create)]
    assert any(pointers)
    return [refused.code for refused in found], pointers


def nothing_in_range(door):
    created = door.create(ball_of(door), {"range": [1e6, None]})
    parts, manifest = door.stream(created["id"])
    assert parts == [] and manifest["empty"], manifest
    unseeded = door.create(ball_of(door), {"range": [0, None], "bodies": {"seeds": [[0, 0, 0]]}})
    door.stream(unseeded["id"])
    reasons = [door.extraction(extraction["id"])["empty_because"] for extraction in (created, unseeded)]
    assert [reason["code"] for reason in reasons] == ["nothing_in_range", "no_seeded_body"], reasons
    return manifest, reasons


def bodies(door):
    created = door.create(survey_of(door), {"range": [0.5, None], "bodies": {"min_voxels": 20}})
    door.watch(created["id"])
    return door.bodies(created["id"])


def one_shot(door):
    parts, manifest = door.extract(ball(), 0, None, BALL)
    volumes = {volume["id"] for volume in door.volumes()["volumes"]}
    assert manifest["volume"] in volumes, "the ball was uploaded before"
    return parts, manifest


def one_shot_leaves_nothing(door):
    _, manifest = door.extract(ball()[:-4] + b"\0\0\0\0", None, 1, BALL)
    return [refusal(door.volume, manifest["volume"]).code, refusal(door.extraction, manifest["id"]).code, manifest["id"]]


def cancel(door):
    slow = {"range": [0.1, None], "missing": {"method": "rbf"}, "simplify": {"strategy": "multiple_choice"}}
    created = door.create(survey_of(door), slow)
    door.cancel(created["id"])
    events = door.watch(created["id"])
    state = door.extraction(created["id"])["state"]
    refused = refusal(door.bodies, created["id"])
    assert "cancelled, not done" in refused.detail, refused.detail
    again = door.create(survey_of(door), slow)
    assert door.watch(again["id"])[-1][1] == "done"
    return events[-1][1:], state, refused.code, again["id"]


def purge(door):
    created = door.create(ball_of(door), {"range": [10, None]})
    door.watch(created["id"])
    door.cancel(created["id"], purge=True)
    return refusal(door.extraction, created["id"]).code


def two_interests(door):
    request = {"range": [20, None]}
    for _ in range(2):
        created = door.create(ball_of(door), request)
    door.cancel(created["id"])
    return door.watch(created["id"])[-1][1]


def refused_requests(door):
    volume = ball_of(door)
    wanted = [{"range": [2, 1]}, {}, {"range": [0, None], "mode": "other"}, {"range": [0, None], "space": "moon"},
              {"range": [0, None], "missing": {"method": "guess"}}, {"range": [0, None], "missing": {"max_distance": -1}},
              {"range": [0, None], "region": {"inline": [0, 99], "crossline": [0, 5], "sample": [0, 5]}},
              {"range": [0, None], "region": {"inline": [3, 2], "crossline": [0, 5], "sample": [0, 5]}},
              {"range": [0, None], "bodies": {"largest": 0}}, {"range": [0, None], "bodies": {"min_voxels": -2}},
              {"range": [0, None], "bodies": {"seeds": [[1, 2, 3], [1, -2, 3]]}},
              {"range": [0, None], "levels": [{"ratio": 0.5}, {"ratio": 0.7}]}, {"range": [0, None], "levels": [{}]},
              {"range": [0, None], "levels": [{"ratio": 2}]}, {"range": [0, None], "levels": [{"ratio": 1}] * 17},
              {"range": [0, None], "levels": [{"ratio": 1, "error_cap": -1}]},
              {"range": [0, None], "simplify": {"strategy": "luck"}}, {"range": [0, None], "codec": {"position_bits": 3}},
              {"range": [0, None], "codec": {"speed": 11}}, {"range": [0, None], "attributes": ["colour"]},
              {"range": [0, None], "attributes": ["value"]}, {"range": [0, None], "attribute_volume": ABSENT},
              {"range": [0, None], "attributes": ["value"], "attribute_volume": ABSENT},
              {"range": [0, None], "velocity": -3}, {"range": [0, None], "velocity": 2000}, {"range": [0, None], "grid": "round"},
              {"range": [0, None], "grid": ABSENT, "preview": True}]
    found = [refusal(door.create, volume, request) for request in wanted]
    return [(refused.code, refused.pointer, refused.detail) for refused in found]


def refused_numbers(door):
    volume = ball_of(door)
    return [refusal(call, *arguments).code for call, arguments in (
        (door.volumes, (1001,)), (door.volumes, (-1,)), (door.histogram, (volume, 4097)), (door.histogram, (volume, -1)))]


def unknown_ids(door):
    calls = (door.volume, door.remove, door.histogram, door.extraction, door.watch, door.stream, door.bodies, door.cancel,
             lambda one: door.cancel(one, purge=True), lambda one: door.create(one, {"range": [0, None]}))
    found = [refusal(call, one) for call in calls for one in (ABSENT, "no-id", "%2e%2e")]
    return [refused.code for refused in found]


def refused_files(door):
    digest = hashlib.sha256(b"").digest()
    files = [(b"", None, None), (b"no survey", None, None), (SURVEY[:5000], None, None), (seismic_line(7, 9), None, None),
             (two_grids(4, 5, 6), None, None), (raw_cube(6, 5, 4)[:-1], RAW, None), (raw_cube(6, 5, 4) + b"\0", RAW, None),
             (raw_cube(6, 5, 4), {"format": "raw"}, None), (raw_cube(6, 5, 4), {**RAW, "dtype": "float16"}, None),
             (raw_cube(6, 5, 4), {**RAW, "order": "any"}, None), (raw_cube(6, 5, 4), {**RAW, "dims": [6, 5, 0]}, None),
             (raw_cube(6, 5, 4), {**RAW, "dims": [2 ** 31 - 1] * 3}, None), (SURVEY, {"inline_byte": 241}, None),
             (SURVEY, {"inline_width": 3}, None), (SURVEY, {"format": "wav"}, None), (SURVEY, {}, digest),
             (raw_cube(6, 5, 4), RAW, digest), (bytes(9 << 20), {"format": "raw", "dims": [96, 128, 192]}, None)]
    found = [refusal(door.upload, data, options, sha256=sha256) for data, options, sha256 in files]
    assert any(refused.candidates for refused in found)
    return [(refused.code, plain(refused.candidates)) for refused in found]


def refused_one_shots(door):
    found = [refusal(door.extract, *arguments) for arguments in (
        (ball(), 2, 1, BALL), (b"no survey", 0, None), (two_grids(4, 5, 6), 0, None), (b"", 0, None),
        (ball()[:-1], 0, None, BALL), (ball(), 0, None, {**BALL, "dtype": "float16"}))]
    return [(refused.code, plain(refused.candidates)) for refused in found]


def remove(door):
    volume, _ = door.upload(raw_cube(6, 5, 4), RAW)
    created = door.create(volume["id"], {"range": [2, None]})
    door.watch(created["id"])
    door.remove(volume["id"])
    return [refusal(call, one).code for call, one in ((door.volume, volume["id"]), (door.extraction, created["id"]),
                                                      (door.stream, created["id"]), (door.remove, volume["id"]))]


SCENARIOS = [upload, upload_of_raw_samples, upload_for_later, upload_for_later_that_fails, list_of_volumes, histogram,
             whole_request, extraction, watch_again, stream, preview, structural_grid, grids,
             grid_from_volumes, stream_on_a_grid, results_go_with_their_grid, refused_grids, nothing_in_range, bodies, one_shot,
             one_shot_leaves_nothing,
             cancel, purge, two_interests, refused_requests, refused_numbers, unknown_ids, refused_files, refused_one_shots,
             remove]


class BothDoors(unittest.TestCase):
    maxDiff = 4000

    def test_every_scenario_ends_the_same(self):
        for scenario in SCENARIOS:
            with self.subTest(scenario.__name__):
                http, grpc = (plain([scenario(door)]) for door in DOORS)
                self.assertEqual(self.comparable(http), self.comparable(grpc))

    def comparable(self, value):
        """Without members of value 0 or false: a message cannot tell them from those that are absent."""
        if isinstance(value, dict):
            members = {name: self.comparable(member) for name, member in value.items()}
            return {name: member for name, member in members.items() if member not in (0, False, {}, [])}
        return [self.comparable(element) for element in value] if isinstance(value, (list, tuple)) else value

    def test_what_one_door_takes_the_other_shows(self):
        http, grpc = DOORS
        own = GrpcDoor(SERVICE.grpc_address, http._headers["Authorization"].removeprefix("Bearer "))
        volume = survey_of(http)
        self.assertEqual(self.comparable(plain(own.volume(volume))), self.comparable(plain(http.volume(volume))))
        created = own.create(volume, {"range": [0.7, None]})
        self.assertEqual(own.stream(created["id"])[0], http.stream(created["id"])[0])

    def test_keys_count_at_both(self):
        table = error_table()
        for make, address in ((HttpDoor, SERVICE.address), (GrpcDoor, SERVICE.grpc_address)):
            for key in (None, "geosis_" + "0" * 64):
                door = make(address, key)
                for call in (door.volumes, lambda: door.upload(b"x"), lambda: door.extract(b"x", 0, 1),
                             lambda: door.stream(ABSENT), lambda: door.watch(ABSENT)):
                    refused = refusal(call)
                    self.assertEqual(refused.code, "unauthenticated")
                    self.assertIn(refused.status, table["unauthenticated"])
        for owner, reader in zip(DOORS, READERS):
            volume = survey_of(owner)
            self.assertEqual(reader.volume(volume)["id"], volume)
            created = reader.create(volume, {"range": [0.8, None]})
            reader.stream(created["id"])
            reader.cancel(created["id"])
            for call in (lambda: reader.upload(b"x"), lambda: reader.remove(volume), lambda: reader.extract(b"x", 0, 1),
                         lambda: reader.cancel(created["id"], purge=True)):
                self.assertEqual(refusal(call).code, "permission_denied")


class Operations(unittest.TestCase):
    def test_calls_are_logged_and_counted(self):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            admin = f"127.0.0.1:{probe.getsockname()[1]}"
        with tempfile.TemporaryDirectory() as folder, open(Path(folder) / "log", "w+", encoding="utf-8") as log, \
                Service(Path(folder) / "store", "--grpc", "127.0.0.1:0", "--admin", admin, "--log-format", "json",
                        stderr=log) as service:
            door = GrpcDoor(service.grpc_address, None)
            door.volumes()
            refusal(door.volume, ABSENT)
            metrics, end = "", time.monotonic() + 10
            while metrics.count("geosis_grpc_call_seconds_count") < 2 and time.monotonic() < end:  # a moment after the client
                with urllib.request.urlopen(f"http://{admin}/metrics") as answer:
                    metrics = answer.read().decode()
            for status, method in (("OK", "ListVolumes"), ("NOT_FOUND", "GetVolume")):
                self.assertIn(f'geosis_grpc_call_seconds_count{{method="geosis.v1.VolumeService/{method}",status="{status}"}} 1\n',
                              metrics)
            self.assertIn("geosis_grpc_connections 1\n", metrics)
            with urllib.request.urlopen(f"http://{admin}/livez") as answer:
                self.assertEqual(answer.status, 200)
            door.channel.close()
            service.process.terminate()
            self.assertEqual(service.process.wait(30), 0)
            log.seek(0)
            calls = [line for line in map(json.loads, filter(lambda line: line.startswith("{"), log)) if line["message"] == "call"]
        self.assertEqual({(call["method"].split("/")[1], call["status"]) for call in calls},
                         {("ListVolumes", "OK"), ("GetVolume", "NOT_FOUND")})
        self.assertTrue(all(call["request_id"] and call["tenant"] == "default" for call in calls))

    def test_a_taken_port_is_said(self):
        with tempfile.TemporaryDirectory() as folder, socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            address = f"127.0.0.1:{taken.getsockname()[1]}"
            refused = subprocess.run([GEOSIS, "serve", "--listen", "127.0.0.1:0", "--admin", "", "--grpc", address, "--store",
                                      folder], capture_output=True, text=True, timeout=60)
        self.assertEqual(refused.returncode, 1)
        self.assertRegex(refused.stderr, rf"unavailable: cannot listen at {address}: .*--grpc off")


class Admission(unittest.TestCase):
    def test_both_doors_say_when_to_come_again(self):
        slow = {"missing": {"method": "rbf"}, "simplify": {"strategy": "multiple_choice"}}
        with tempfile.TemporaryDirectory() as folder, \
                Service(Path(folder) / "store", "--grpc", "127.0.0.1:0", "--admin", "", "--workers", "1", "--queued", "2",
                        "--queued-per-tenant", "1", "--drain-seconds", "0", "--log-level", "error") as service:
            doors = [HttpDoor(service.address, None), GrpcDoor(service.grpc_address, None)]
            volume = survey_of(doors[0])
            for door, status in zip(doors, (429, "RESOURCE_EXHAUSTED")):
                for attempt in range(50):
                    try:
                        door.create(volume, {"range": [attempt / 64 - 1, None], **slow})
                    except Refused as refused:
                        self.assertEqual((refused.code, refused.status), ("quota_exceeded", status))
                        self.assertGreaterEqual(refused.retry_seconds, 1)
                        break
                else:
                    self.fail("everything was taken")


if __name__ == "__main__":
    unittest.main()
