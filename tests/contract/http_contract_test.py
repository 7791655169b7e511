"""Walks every HTTP call of api/openapi.yaml against a running server, good and bad ones.

Each answer has to have a documented status, the documented headers and a body of the documented schema. Environment:
GEOSIS = the built binary, GEOSIS_SHARED = folder of shared data (its surveys are left out when it is absent).
"""
import base64
import hashlib
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from urllib.parse import urljoin

from contract import OPENAPI, Contract
from placed_grids import (DIMS, bent, enclosed_volume, mapped, mirrored, node_bytes, pillar_bytes, read_ply, unmatched,
                          upright)
from service import GEOSIS, Answer, Client, Service
from surveys import raw_cube, seismic_line, two_grids

CONTRACT = Contract()
PAGE = "http://page.example"
ABSENT = "0" * 64
BODY = {"range": [0.55, None]}
SHARED = Path(os.environ.get("GEOSIS_SHARED", Path(__file__).resolve().parents[3] / "shared"))


def setUpModule():
    """One server with one small sample survey for all tests."""
    global FOLDER, SERVICE, CLIENT, SURVEY, VOLUME
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-contract-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    subprocess.run([GEOSIS, "synth", FOLDER / "survey.sgy", "--dims", "48,56,64"], check=True)
    SURVEY = (FOLDER / "survey.sgy").read_bytes()
    SERVICE = unittest.enterModuleContext(Service(FOLDER / "store", "--cors-origin", PAGE))
    CLIENT = Client(SERVICE.address, CONTRACT)
    VOLUME = CLIENT.upload(SURVEY, "name=survey.sgy").json()["id"]


def done_extraction(request=None, volume=None):
    """Id of an extraction that is done."""
    answer = CLIENT.send_json("POST", f"/v1/volumes/{volume or VOLUME}/extractions", request or BODY, Prefer="wait=60")
    resource = answer.json()
    assert resource["state"] == "done", resource
    return resource["id"]


class Refusals(unittest.TestCase):
    """A test case that expects problems."""

    def refused(self, answer, status, code=None, **members):
        problem = answer.json()
        self.assertEqual(answer.status, status, answer.body[:400])
        if code:
            self.assertEqual(problem["code"], code, problem)
        for name, value in members.items():
            self.assertEqual(problem.get(name), value, problem)
        return problem


class Volumes(Refusals):
    def test_the_same_file_is_the_same_volume(self):
        again = CLIENT.upload(SURVEY, "name=other.sgy")
        self.assertEqual((again.status, again.json()["id"]), (200, VOLUME))
        self.assertEqual(again.headers["location"], f"/v1/volumes/{VOLUME}")

    def test_another_file_is_a_new_volume_that_can_be_deleted(self):
        answer = CLIENT.upload(raw_cube(4, 5, 6), "format=raw&dims=4,5,6&name=cube")
        volume = answer.json()
        self.assertEqual((answer.status, volume["dims"], volume["name"]), (201, [4, 5, 6], "cube"))
        extraction = done_extraction({"range": [3, 6]}, volume["id"])
        self.assertEqual(CLIENT.call("DELETE", f"/v1/volumes/{volume['id']}").status, 204)
        self.refused(CLIENT.get(f"/v1/volumes/{volume['id']}"), 404, "not_found")
        self.refused(CLIENT.get(f"/v1/extractions/{extraction}"), 404, "not_found")
        self.refused(CLIENT.call("DELETE", f"/v1/volumes/{volume['id']}"), 404, "not_found")

    def test_a_form_is_read_like_a_plain_body(self):
        options = json.dumps({"format": "raw", "dims": [3, 4, 5]})
        lines = [b"--xyz", b'Content-Disposition: form-data; name="options"', b"", options.encode(), b"--xyz",
                 b'Content-Disposition: form-data; name="file"; filename="in.raw"', b"", raw_cube(3, 4, 5), b"--xyz--", b""]
        answer = CLIENT.call("POST", "/v1/volumes", body=b"\r\n".join(lines),
                             headers={"Content-Type": "multipart/form-data; boundary=xyz"})
        self.assertEqual((answer.status, answer.json()["name"]), (201, "in.raw"))

    def test_the_digest_is_checked(self):
        digest = base64.b64encode(hashlib.sha256(SURVEY).digest()).decode()
        self.assertEqual(CLIENT.upload(SURVEY, Content_Digest=f"sha-256=:{digest}:").status, 200)
        other = base64.b64encode(hashlib.sha256(b"").digest()).decode()
        self.refused(CLIENT.upload(SURVEY, Content_Digest=f"sha-256=:{other}:"), 400, "invalid_argument")
        self.refused(CLIENT.upload(SURVEY, Content_Digest="sha-256=:?:"), 400, "invalid_argument")
        longer, damaged = (base64.b64encode(hashlib.sha512(data).digest()).decode() for data in (SURVEY, SURVEY[1:]))
        self.assertEqual(CLIENT.upload(SURVEY, Content_Digest=f"md5=:x:, sha-512=:{longer}:").status, 200)
        self.refused(CLIENT.upload(SURVEY, Content_Digest=f"sha-256=:{digest}:, sha-512=:{damaged}:"), 400,
                     "invalid_argument")
        self.refused(CLIENT.upload(SURVEY, Content_Digest=f"sha-512=:{digest}:"), 400, "invalid_argument")

    def test_the_digest_of_a_form_is_that_of_the_whole_form(self):
        form = (b'--xyz\r\nContent-Disposition: form-data; name="file"; filename="a.sgy"\r\n\r\n' + SURVEY +
                b"\r\n--xyz--\r\n and an epilogue")
        for data, status in ((form, 200), (SURVEY, 400)):
            answer = CLIENT.call("POST", "/v1/volumes", body=form, headers={
                "Content-Type": "multipart/form-data; boundary=xyz",
                "Content-Digest": f"sha-256=:{base64.b64encode(hashlib.sha256(data).digest()).decode()}:"})
            self.assertEqual(answer.status, status, answer.body[:300])

    def test_a_survey_that_could_be_two_grids_is_refused_with_both(self):
        problem = self.refused(CLIENT.upload(two_grids(6, 8, 4)), 422)
        self.assertGreaterEqual(len(problem["candidates"]), 2)
        one = problem["candidates"][0]
        query = f"inline_byte={one['inline_byte']}&crossline_byte={one['crossline_byte']}"
        self.assertEqual(CLIENT.upload(two_grids(6, 8, 4), query).json()["dims"], one["dims"])

    def test_files_that_are_no_volume_leave_nothing_behind(self):
        before = CLIENT.get("/v1/volumes").json()
        for data in (seismic_line(40, 16), SURVEY[:-100], b"not a survey"):
            self.refused(CLIENT.upload(data), 422)
        self.refused(CLIENT.upload(raw_cube(2, 2, 2), "format=raw&dims=3,3,3"), 422)
        self.assertEqual(CLIENT.get("/v1/volumes").json(), before)

    def test_bad_options_are_named(self):
        for query in ("dims=1,2", "inline_byte=0", "format=gif", "no_such_option=1"):
            problem = self.refused(CLIENT.upload(SURVEY, query), 400, "invalid_argument")
            self.assertIn(query.partition("=")[0], problem["detail"])

    def test_an_import_may_go_on_after_the_answer(self):
        accepted = CLIENT.upload(raw_cube(7, 8, 9), "format=raw&dims=7,8,9&name=later", Prefer="respond-async")
        self.assertEqual(accepted.status, 202)
        self.assertEqual(accepted.headers["preference-applied"], "respond-async")
        document = self.ended(accepted.headers["location"])
        self.assertEqual((document["state"], document["dims"], document["name"]), ("ready", [7, 8, 9], "later"))
        self.assertEqual(CLIENT.upload(raw_cube(7, 8, 9), "format=raw&dims=7,8,9").json()["id"], document["id"])
        self.assertEqual(CLIENT.call("DELETE", accepted.headers["location"]).status, 204)
        self.refused(CLIENT.get(accepted.headers["location"]), 404, "not_found")
        self.assertEqual(CLIENT.get(f"/v1/volumes/{document['id']}").status, 200)

    def test_an_import_that_fails_later_says_why(self):
        accepted = CLIENT.upload(two_grids(6, 8, 4), "", Prefer="respond-async")
        failed = self.ended(accepted.headers["location"])
        self.assertEqual((failed["state"], failed["error"]["status"]), ("failed", 422))
        self.assertGreaterEqual(len(failed["error"]["candidates"]), 2)

    @staticmethod
    def ended(location):
        while (document := CLIENT.get(location).json())["state"] == "importing":
            time.sleep(0.02)
        return document

    def test_encoded_bodies_are_not_taken(self):
        self.refused(CLIENT.upload(SURVEY, Content_Encoding="gzip"), 415)

    def test_the_list_comes_in_pages(self):
        CLIENT.upload(raw_cube(2, 3, 4), "format=raw&dims=2,3,4")
        ids, token = [], ""
        while token is not None:
            page = CLIENT.get(f"/v1/volumes?page_size=1&page_token={token}").json()
            ids += [volume["id"] for volume in page["volumes"]]
            token = page["next_page_token"]
        self.assertIn(VOLUME, ids)
        self.assertEqual(len(ids), len(set(ids)))
        self.assertEqual(ids, [volume["id"] for volume in CLIENT.get("/v1/volumes").json()["volumes"]])
        self.refused(CLIENT.get("/v1/volumes?page_size=0"), 400, "invalid_argument")

    def test_name_and_crs_can_be_changed_and_nothing_else(self):
        target = f"/v1/volumes/{VOLUME}"
        changed = CLIENT.send_json("PATCH", target, {"name": "renamed", "crs": "EPSG:23031"}).json()
        self.assertEqual((changed["name"], changed["crs"]), ("renamed", "EPSG:23031"))
        self.assertEqual(CLIENT.get(target).json(), changed)
        self.assertIsNone(CLIENT.send_json("PATCH", target, {"crs": None}).json()["crs"])
        self.refused(CLIENT.send_json("PATCH", target, {"dims": [1, 2, 3]}), 400, "invalid_argument", pointer="/dims")
        self.refused(CLIENT.send_json("PATCH", target, "{"), 400, "invalid_argument")
        self.refused(CLIENT.send_json("PATCH", f"/v1/volumes/{ABSENT}", {"name": "x"}), 404, "not_found")

    def test_the_histogram_counts_every_sample_once(self):
        histogram = CLIENT.get(f"/v1/volumes/{VOLUME}/histogram?bins=10").json()
        self.assertEqual((len(histogram["edges"]), len(histogram["counts"])), (11, 10))
        self.assertEqual(sum(histogram["counts"]) + histogram["missing"], 48 * 56 * 64)
        self.assertEqual(len(CLIENT.get(f"/v1/volumes/{VOLUME}/histogram").json()["counts"]), 256)
        self.refused(CLIENT.get(f"/v1/volumes/{VOLUME}/histogram?bins=0"), 400, "invalid_argument")
        self.refused(CLIENT.get(f"/v1/volumes/{ABSENT}/histogram"), 404, "not_found")


class Grids(Refusals):
    """Surfaces on grids whose nodes somebody has placed, beside a mapping in Python of those on the plain grid."""

    @classmethod
    def setUpClass(cls):
        cls.volume = CLIENT.upload(raw_cube(*DIMS, lambda i, j, k: 50.0 - (i - 12) ** 2 - (j - 11) ** 2 - (k - 10) ** 2),
                                   "format=raw&dims=24,22,20").json()["id"]

    def add(self, data, query="", volume=None, **headers):
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        return CLIENT.call("POST", f"/v1/volumes/{volume or self.volume}/grids?{query}", data,
                           {"Content-Type": "application/octet-stream", **named})

    def manifest_and_mesh(self, request, level=0):
        extraction = done_extraction({"range": [0, None], **request}, self.volume)
        manifest = CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()
        return manifest, read_ply(CLIENT.get(f"/v1/extractions/{extraction}/lods/{level}.ply").body), extraction

    def test_a_grid_is_named_by_where_its_nodes_are(self):
        answer = self.add(pillar_bytes(), "kind=pillars&dtype=float64")
        grid = answer.json()
        self.assertEqual((answer.status, grid["kind"], grid["dims"], grid["volume"]),
                         (201, "pillars", list(DIMS), self.volume))
        self.assertEqual(answer.headers["location"], f"/v1/volumes/{self.volume}/grids/{grid['id']}")
        self.assertEqual(grid["box"], [list(upright(0, 0, 0)), list(upright(DIMS[0] - 1, DIMS[1] - 1, DIMS[2] - 1))])
        again = self.add(node_bytes(upright, ">d"), "kind=nodes&dtype=float64&byte_order=big")
        self.assertEqual((again.status, again.json()), (200, grid))
        self.assertEqual(CLIENT.get(answer.headers["location"]).json(), grid)
        self.assertIn(grid, CLIENT.get(f"/v1/volumes/{self.volume}/grids").json()["grids"])
        self.assertEqual(CLIENT.call("DELETE", answer.headers["location"]).status, 204)
        self.refused(CLIENT.get(answer.headers["location"]), 404, "not_found")
        self.refused(CLIENT.call("DELETE", answer.headers["location"]), 404, "not_found")

    def test_surfaces_lie_where_the_nodes_say(self):
        plain, (indices, same), _ = self.manifest_and_mesh({"space": "index"})
        for place, is_mirrored in ((bent, False), (mirrored, True)):
            grid = self.add(node_bytes(place, "<d"), "dtype=float64").json()
            self.assertEqual(grid["mirrored"], is_mirrored)
            manifest, (positions, triangles), extraction = self.manifest_and_mesh({"grid": grid["id"]})
            chosen = manifest["grid"]
            self.assertEqual((chosen["asked"], chosen["chosen"], chosen["id"], chosen["mirrored"], chosen["folded_share"]),
                             (grid["id"], "curvilinear", grid["id"], is_mirrored, 0))
            for level, other in zip(manifest["levels"], plain["levels"]):
                for name in ("components", "euler", "genus", "boundary_loops", "manifold"):
                    self.assertEqual(level[name], other[name])
            step = chosen["lattice_step"]
            self.assertEqual(manifest["transform"][0], 64 * step)
            self.assertEqual((len(positions), len(triangles)), (len(indices), len(same)))
            self.assertEqual(unmatched([mapped(place, point) for point in indices], positions, manifest["transform"]), [])
            volume = enclosed_volume(positions, triangles)
            self.assertGreater(volume, 0)
            self.assertAlmostEqual(volume, manifest["levels"][0]["volume"], delta=1e-6 * volume)
            body = CLIENT.get(f"/v1/extractions/{extraction}/bodies").json()["bodies"][0]
            self.assertAlmostEqual(body["volume"], volume, delta=1e-6 * volume)

    def test_index_space_is_the_plain_grid(self):
        grid = self.add(node_bytes(mirrored, "<d"), "dtype=float64").json()
        plain, _, _ = self.manifest_and_mesh({"space": "index"})
        manifest, _, _ = self.manifest_and_mesh({"space": "index", "grid": grid["id"]})
        self.assertEqual([level["parts"] for level in manifest["levels"]], [level["parts"] for level in plain["levels"]])
        self.assertIsNone(manifest["grid"]["lattice_step"])

    def test_regions_caps_levels_and_attributes_work_on_a_grid(self):
        grid = self.add(node_bytes(bent, "<d"), "dtype=float64").json()["id"]
        request = {"region": {"inline": [4, 13], "crossline": [3, 20], "sample": [2, 18]}, "cap": False,
                   "levels": [{"ratio": 1}, {"ratio": 0.25, "error_cap": 1}], "attributes": ["value", "body"],
                   "attribute_volume": self.volume, "codec": {"normals": True}}
        plain, (indices, _), _ = self.manifest_and_mesh(request)
        manifest, (positions, _), _ = self.manifest_and_mesh({**request, "grid": grid})
        for level, other in zip(manifest["levels"], plain["levels"]):
            self.assertEqual([level[name] for name in ("euler", "components", "boundary_loops")],
                             [other[name] for name in ("euler", "components", "boundary_loops")])
        self.assertEqual(manifest["levels"][0]["boundary_loops"], 1)
        self.assertEqual(unmatched([mapped(bent, point) for point in indices], positions, manifest["transform"]), [])
        nothing = done_extraction({"range": [1e6, None], "grid": grid}, self.volume)
        self.assertTrue(CLIENT.get(f"/v1/extractions/{nothing}/manifest").json()["empty"])

    def test_depths_come_from_another_volume(self):
        depths = raw_cube(*DIMS, lambda i, j, k: 1500.0 + 6 * k + k * k / 4 + i)
        z = CLIENT.upload(depths, "format=raw&dims=24,22,20&name=depths").json()["id"]
        answer = CLIENT.send_json("POST", f"/v1/volumes/{self.volume}/grids", {"z": z})
        self.assertEqual((answer.status, answer.json()["kind"], answer.json()["times"]), (201, "volumes", False))
        manifest, (positions, _), _ = self.manifest_and_mesh({"grid": answer.json()["id"]})
        _, (indices, _), _ = self.manifest_and_mesh({"space": "index"})
        truth = [mapped(lambda i, j, k: (i, j, 1500.0 + 6 * k + k * k / 4 + i), point) for point in indices]
        self.assertEqual(unmatched(truth, positions, manifest["transform"]), [])

    def test_a_time_survey_on_a_grid_of_depths_has_lengths(self):
        dims = CLIENT.get(f"/v1/volumes/{VOLUME}").json()["dims"]
        nodes = b"".join(struct.pack("<3f", 25 * i, 25 * j, 5 * k) for i in range(dims[0]) for j in range(dims[1])
                         for k in range(dims[2]))
        grid = self.add(nodes, volume=VOLUME).json()["id"]
        level = CLIENT.get(f"/v1/extractions/{done_extraction({**BODY, 'grid': grid})}/manifest").json()["levels"][0]
        self.assertGreater(level["volume"], 0)
        self.refused(CLIENT.send_json("POST", f"/v1/volumes/{VOLUME}/extractions", {**BODY, "grid": grid, "velocity": 2000}),
                     400, "invalid_argument", pointer="/velocity")
        filled = {**BODY, "missing": {"method": "linear"}, "levels": [{"ratio": 1}]}
        plain, placed = (CLIENT.get(f"/v1/extractions/{done_extraction({**filled, 'grid': one})}/manifest").json()["levels"][0]
                         for one in ("given", grid))
        for name in ("euler", "components", "genus", "boundary_loops", "interpolated_share"):
            self.assertEqual(placed[name], plain[name], name)
        self.assertGreater(placed["interpolated_share"], 0)
        xs = CLIENT.upload(raw_cube(*dims, lambda i, j, k: 25.0 * i), f"format=raw&dims={','.join(map(str, dims))}").json()["id"]
        ys = CLIENT.upload(raw_cube(*dims, lambda i, j, k: 25.0 * j), f"format=raw&dims={','.join(map(str, dims))}").json()["id"]
        times = CLIENT.send_json("POST", f"/v1/volumes/{VOLUME}/grids", {"x": xs, "y": ys}).json()
        self.assertTrue(times["times"])
        for velocity, has_volume in ((None, False), (2000, True)):
            request = {**BODY, "grid": times["id"], "velocity": velocity}
            level = CLIENT.get(f"/v1/extractions/{done_extraction(request)}/manifest").json()["levels"][0]
            self.assertEqual(level["volume"] is not None, has_volume)

    def test_what_makes_no_grid_is_refused_and_leaves_nothing(self):
        before = CLIENT.get(f"/v1/volumes/{self.volume}/grids").json()
        data = node_bytes(bent)
        problem = self.refused(self.add(data[:-4]), 422, "malformed_input")
        self.assertIn(f"{len(data) - 4} bytes; expected {len(data)}", problem["detail"])
        self.refused(self.add(iter([data, b"x"])), 422, "malformed_input")
        self.refused(self.add(iter([data[:100]])), 422, "malformed_input")
        node = (3 * DIMS[1] + 2) * DIMS[2] + 1
        odd = data[:12 * node] + struct.pack("<f", math.inf) + data[12 * node + 4:]
        self.assertIn("node [3,2,1] is (inf,", self.refused(self.add(odd), 422, "malformed_input")["detail"])
        folded = node_bytes(lambda i, j, k: (i, j, -k if i < 4 else k))
        self.assertRegex(self.refused(self.add(folded), 422, "malformed_input")["detail"],
                         r"[0-9.]+ % of the cells are folded; at most 1 %; the first is that from node \[0,0,0\]")
        self.refused(self.add(data, "kind=cells"), 400, "invalid_argument")
        self.refused(self.add(data, "dtype=int16"), 400, "invalid_argument")
        self.refused(self.add(data, "colour=red"), 400, "invalid_argument")
        self.refused(self.add(data, volume=ABSENT), 404, "not_found")
        digest = base64.b64encode(hashlib.sha256(b"").digest()).decode()
        self.refused(self.add(data, Content_Digest=f"sha-256=:{digest}:"), 400, "invalid_argument")
        target = f"/v1/volumes/{self.volume}/grids"
        for document, status, pointer in (({}, 400, "/z"), ({"w": ABSENT}, 400, "/w"), ({"x": 3}, 400, "/x"), ({"y": ABSENT}, 404, "/y"),
                                          ({"z": VOLUME}, 400, "/z"), ("{", 400, None), ([], 400, None)):
            problem = self.refused(CLIENT.send_json("POST", target, document), status)
            self.assertEqual(problem.get("pointer"), pointer, problem)
        self.refused(CLIENT.send_json("POST", target, " " * 70000), 413, "limit_exceeded")
        self.refused(CLIENT.send_json("POST", f"/v1/volumes/{self.volume}/extractions", {"range": [0, None], "grid": ABSENT}), 404,
                     "not_found", pointer="/grid")
        self.refused(CLIENT.get(target + "?page_size=0"), 400)
        self.refused(CLIENT.get(f"{target}/{ABSENT}"), 404)
        self.assertEqual(CLIENT.get(target).json(), before)

    def test_a_grid_goes_with_its_volume(self):
        volume = CLIENT.upload(raw_cube(*DIMS, lambda i, j, k: float(i * j + k)), "format=raw&dims=24,22,20").json()["id"]
        grid = self.add(node_bytes(bent), volume=volume).json()["id"]
        self.assertEqual(CLIENT.call("DELETE", f"/v1/volumes/{volume}").status, 204)
        self.refused(CLIENT.get(f"/v1/volumes/{volume}/grids/{grid}"), 404)
        left = [path for path in (FOLDER / "store" / "objects").rglob("*") if path.is_file() and grid in str(path)]
        self.assertEqual(left, [])


class Slices(Refusals):
    def test_samples_are_rows_of_float32(self):
        cube = raw_cube(3, 4, 5, lambda i, j, k: 100.0 * i + 10.0 * j + k)
        volume = CLIENT.upload(cube, "format=raw&dims=3,4,5").json()["id"]
        for axis, index, shape, first_row in (("inline", 2, "5,4", (200, 210, 220, 230)),
                                              ("crossline", 3, "5,3", (30, 130, 230)),
                                              ("sample", 1, "3,4", (1, 11, 21, 31))):
            answer = CLIENT.get(f"/v1/volumes/{volume}/slices/{axis}/{index}?format=f32")
            self.assertEqual(answer.headers["x-geosis-shape"], shape)
            self.assertEqual(struct.unpack_from(f"<{len(first_row)}f", answer.body), first_row)

    def test_images_have_one_pixel_a_sample(self):
        answer = CLIENT.get(f"/v1/volumes/{VOLUME}/slices/inline/10?range=-1,1&colormap=seismic")
        self.assertEqual(answer.body[:8], b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack_from(">II", answer.body, 16)
        rows, columns = map(int, answer.headers["x-geosis-shape"].split(","))
        self.assertEqual((height, width), (rows, columns))

    def test_what_is_not_there_is_refused(self):
        target = f"/v1/volumes/{VOLUME}/slices/inline"
        self.assertIn(CLIENT.get(f"{target}/48").status, (400, 404))
        for axis, last, number, called in (("inline", 47, 1021, "inline 1021"), ("crossline", 55, 2021, "crossline 2021"),
                                           ("sample", 63, 1080, "1080 ms")):
            refused = CLIENT.get(f"/v1/volumes/{VOLUME}/slices/{axis}/{number}").json()
            self.assertEqual(refused["detail"],
                             f"{axis} slice {number}; expected a node number, 0..{last}; {called} is node 20")
        self.assertNotIn("is node", CLIENT.get(f"{target}/99999").json()["detail"])
        self.refused(CLIENT.get(f"{target}/0?colormap=rainbow"), 400, "invalid_argument")
        self.refused(CLIENT.get(f"{target}/0?format=gif"), 400, "invalid_argument")
        self.refused(CLIENT.get(f"/v1/volumes/{ABSENT}/slices/inline/0"), 404, "not_found")
        self.refused(CLIENT.get(f"/v1/volumes/{VOLUME}/slices/time/0"), 404)


class Extractions(Refusals):
    def post(self, request, **headers):
        return CLIENT.send_json("POST", f"/v1/volumes/{VOLUME}/extractions", request, **headers)

    def test_a_dry_run_estimates_and_records_nothing(self):
        request = {"range": [0.31, None]}
        target = f"/v1/volumes/{VOLUME}/extractions?dry_run=true"
        answer = CLIENT.send_json("POST", target, request)
        self.assertEqual(answer.status, 200)
        estimate = answer.json()
        self.assertNotIn("location", answer.headers)
        self.assertLess(estimate["triangles"], estimate["bytes"])
        made = self.post(request, Prefer="wait=60").json()
        self.assertEqual(made["state"], "done")
        triangles = sum(part["triangles"] for part in made["levels"][-1]["parts"])
        self.assertLess(abs(math.log2(estimate["triangles"] / triangles)), 1)
        self.assertEqual(CLIENT.send_json("POST", target, {"range": [2, 1]}).status, 400)
        self.assertEqual(CLIENT.send_json("POST", target.replace("true", "maybe"), request).status, 400)

    def test_equal_requests_are_one_extraction(self):
        first = self.post({"range": [0.5, None]}, Prefer="wait=60")
        again = self.post({"mode": "exact", "range": [0.5, None], "cap": True})
        self.assertEqual((first.status, again.status), (200, 200))
        self.assertEqual(first.json()["id"], again.json()["id"])
        self.assertEqual(again.headers["location"], f"/v1/extractions/{first.json()['id']}")

    def test_without_waiting_it_is_accepted_and_gets_done(self):
        answer = self.post({"range": [0.56, None]})
        self.assertIn(answer.status, (200, 202))
        extraction = done_extraction({"range": [0.56, None]})
        self.assertEqual(answer.json()["id"], extraction)
        resource = CLIENT.get(f"/v1/extractions/{extraction}").json()
        self.assertEqual((resource["state"], resource["progress"], len(resource["levels"])), ("done", 1, 5))

    def test_bad_requests_are_refused_with_their_place(self):
        for request, status, pointer in (({"range": [0.5, None], "colour": 1}, 400, "/colour"),
                                         ({"range": [1, 0]}, 400, "/range"),
                                         ({}, 400, "/range"),
                                         ({"range": [0, "a"]}, 400, "/range/1"),
                                         ({"range": [0, 1], "grid": "bent"}, 400, "/grid"),
                                         ({"range": [0, 1], "preview": 1}, 400, "/preview"),
                                         ({"range": [0, 1], "preview": True, "grid": "0" * 64}, 400, "/preview"),
                                         ({"range": [0, 1], "levels": []}, 400, "/levels")):
            self.refused(self.post(request), status, pointer=pointer)
        self.refused(self.post("{nonsense"), 400)
        self.refused(self.post({"range": [0, 1], "region": {"inline": [0, 900], "crossline": [0, 5], "sample": [0, 5]}}), 400)

    def test_previews_are_results_of_their_own(self):
        preview = done_extraction({**BODY, "preview": True})
        self.assertEqual(preview, done_extraction({**BODY, "preview": True, "levels": [{"ratio": 0.5}], "grid": "auto"}))
        self.assertNotEqual(preview, done_extraction(BODY))
        manifest = CLIENT.get(f"/v1/extractions/{preview}/manifest").json()
        self.assertEqual([level["preview"] for level in manifest["levels"]], [True])
        self.assertIn(b"X-Geosis-Preview: true", CLIENT.get(f"/v1/extractions/{preview}/stream").body)
        self.refused(CLIENT.get(f"/v1/extractions/{preview}/bodies"), 422, "unsupported")

    def test_grids_that_follow_the_reflectors(self):
        manifests = {}
        for grid, space in (("structural", "world"), ("structural", "index"), ("auto", "world")):
            extraction = done_extraction({**BODY, "grid": grid, "space": space})
            manifests[grid, space] = manifest = CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()
            self.assertEqual((manifest["request"]["grid"], manifest["grid"]["asked"]), (grid, grid))
            self.assertTrue(all(level["manifold"] for level in manifest["levels"]))
            self.assertEqual(CLIENT.get(f"/v1/extractions/{extraction}/bodies").status, 200)
        chosen = manifests["structural", "world"]["grid"]
        self.assertEqual(chosen["chosen"], "structural")
        self.assertGreaterEqual(chosen["layers"], 64)
        given = CLIENT.get(f"/v1/extractions/{done_extraction()}/manifest").json()
        self.assertNotIn("grid", given)
        self.assertEqual(given["transform"], manifests["structural", "world"]["transform"])
        one_shot = CLIENT.call("POST", "/v1/extract?range=0.55,inf&grid=structural", body=SURVEY,
                               headers={"Content-Type": "application/octet-stream"})
        levels = json.loads(one_shot.parts()[-1][1])["levels"]
        self.assertEqual([level["triangles"] for level in levels],
                         [level["triangles"] for level in manifests["structural", "world"]["levels"]])

    def test_nothing_in_the_range_is_an_answer(self):
        extraction = done_extraction({"range": [1000, 2000]})
        manifest = CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()
        self.assertEqual((manifest["levels"], manifest["empty"]), ([], True))
        self.assertEqual(len(CLIENT.get(f"/v1/extractions/{extraction}/stream").parts()), 1)
        resource = CLIENT.get(f"/v1/extractions/{extraction}").json()
        self.assertEqual((resource["empty"], resource["empty_because"]["code"]), (True, "nothing_in_range"))
        self.refused(CLIENT.get(f"/v1/extractions/{extraction}/lods/0.drc"), 404, "not_found")

    def test_urls_of_the_extraction_and_its_events_resolve_against_their_address(self):
        target = f"/v1/extractions/{done_extraction()}"
        manifest = CLIENT.get(target + "/manifest").json()
        events = self.events(CLIENT.get(target + "/events"))
        told = [(target + "/events", data) for name, data in events if name == "level"]
        resource = CLIENT.get(target).json()
        self.assertFalse(resource["empty"])
        for base, level in [*told, *((target, level) for level in resource["levels"])]:
            certified = manifest["levels"][level["level"]]
            self.assertEqual(urljoin(base, level["url"]), urljoin(target + "/manifest", certified["url"]))
            part = CLIENT.get(urljoin(base, level["parts"][0]["url"]))
            self.assertEqual(hashlib.sha256(part.body).hexdigest(), certified["parts"][0]["sha256"])

    def test_events_tell_each_level_and_the_end(self):
        extraction = done_extraction()
        events = self.events(CLIENT.get(f"/v1/extractions/{extraction}/events"))
        levels = [data["level"] for name, data in events if name == "level"]
        self.assertEqual(levels, [4, 3, 2, 1, 0])
        self.assertEqual(events[-1][0], "done")
        CONTRACT.validate({"$ref": "#/components/schemas/Extraction"}, events[-1][1])
        for name, data in events:
            if name == "level":
                CONTRACT.validate({"$ref": "#/components/schemas/Level"}, data)
        rest = self.events(CLIENT.get(f"/v1/extractions/{extraction}/events", Last_Event_ID="3"))
        self.assertEqual([data["level"] for name, data in rest if name == "level"], [1, 0])

    def test_events_after_the_last_one_are_no_more(self):
        target = f"/v1/extractions/{done_extraction()}/events"
        self.assertIn(b"id: 6\nevent: done\n", CLIENT.get(target).body)
        self.assertEqual([name for name, _ in self.events(CLIENT.get(target, Last_Event_ID="5"))], ["done"])
        self.assertEqual(CLIENT.get(target, Last_Event_ID="6").status, 204)
        self.assertEqual(len(self.events(CLIENT.get(target, Last_Event_ID="6th"))), 6)

    @staticmethod
    def events(answer):
        """[(name, data)] of an answer of server-sent events."""
        events = []
        for block in answer.body.decode().strip().split("\n\n"):
            fields = dict(line.split(": ", 1) for line in block.splitlines() if not line.startswith(":"))
            if "event" in fields:
                events.append((fields["event"], json.loads(fields["data"])))
        return events

    def test_purging_removes_the_result_and_asking_again_brings_it_back(self):
        extraction = done_extraction({"range": [0.57, None]})
        level, part = f"/v1/extractions/{extraction}/lods/0.drc", f"/v1/extractions/{extraction}/lods/0/parts/0.drc"
        for target in (level, part, level, part):  # the second time from memory
            self.assertEqual(CLIENT.get(target).status, 200)
        self.assertEqual(CLIENT.call("DELETE", f"/v1/extractions/{extraction}?purge=true").status, 204)
        for target in (f"/v1/extractions/{extraction}", level, part):
            self.refused(CLIENT.get(target), 404, "not_found")
        self.assertEqual(done_extraction({"range": [0.57, None]}), extraction)

    def test_interest_can_be_withdrawn(self):
        extraction = self.post({"range": [0.58, None]}).json()["id"]
        self.assertEqual(CLIENT.call("DELETE", f"/v1/extractions/{extraction}").status, 204)
        self.assertEqual(done_extraction({"range": [0.58, None]}), extraction)
        self.refused(CLIENT.call("DELETE", f"/v1/extractions/{extraction}?purge=maybe"), 400, "invalid_argument")

    def test_what_is_unknown_is_not_found(self):
        for rest in ("", "/events", "/stream", "/manifest", "/bodies", "/lods/0.drc", "/lods/0/parts/0.drc"):
            self.refused(CLIENT.get(f"/v1/extractions/{ABSENT}{rest}"), 404, "not_found")
        self.refused(CLIENT.call("DELETE", f"/v1/extractions/{ABSENT}"), 404, "not_found")
        self.refused(CLIENT.send_json("POST", f"/v1/volumes/{ABSENT}/extractions", BODY), 404, "not_found")


class Results(Refusals):
    def test_the_stream_is_coarsest_first_and_ends_with_the_manifest(self):
        extraction = done_extraction()
        *parts, (headers, text) = CLIENT.get(f"/v1/extractions/{extraction}/stream").parts()
        self.assertEqual(headers["content-type"], "application/json")
        manifest = json.loads(text)
        CONTRACT.validate({"$ref": "#/components/schemas/Manifest"}, manifest)
        expected = [(level["level"], number, part["sha256"])
                    for level in reversed(manifest["levels"]) for number, part in enumerate(level["parts"])]
        received = [(int(head["x-geosis-level"]), int(head["x-geosis-part"]), hashlib.sha256(body).hexdigest())
                    for head, body in parts]
        self.assertEqual(received, expected)

    def test_a_post_may_be_answered_by_the_stream(self):
        answer = CLIENT.send_json("POST", f"/v1/volumes/{VOLUME}/extractions", BODY, Accept="multipart/mixed")
        stream = CLIENT.get(f"/v1/extractions/{done_extraction()}/stream")
        self.assertEqual([body for _, body in answer.parts()], [body for _, body in stream.parts()])

    def test_urls_of_the_manifest_lead_to_the_bytes_it_certifies(self):
        extraction = done_extraction()
        base = f"/v1/extractions/{extraction}/"
        for level in CLIENT.get(base + "manifest").json()["levels"]:
            for part in level["parts"]:
                answer = CLIENT.get(base + part["url"])
                self.assertEqual(hashlib.sha256(answer.body).hexdigest(), part["sha256"])
                self.assertEqual(answer.headers["etag"], f'"{part["sha256"]}"')
                self.assertEqual(len(answer.body), part["bytes"])
            self.assertEqual(CLIENT.get(base + level["url"]).status, 200)

    def test_every_format_has_a_tag_a_range_and_a_head(self):
        extraction = done_extraction()
        for name in ("lods/1.drc", "lods/1.glb", "lods/1.ply", "lods/1.obj", "lods/1.stl", "lods/1/parts/0.drc", "manifest"):
            target = f"/v1/extractions/{extraction}/{name}"
            whole = CLIENT.get(target)
            self.assertEqual(CLIENT.get(target, If_None_Match=whole.headers["etag"]).status, 304)
            some = CLIENT.get(target, Range="bytes=10-19")
            self.assertEqual((some.status, some.body), (206, whole.body[10:20]))
            self.assertEqual(some.headers["content-range"], f"bytes 10-19/{len(whole.body)}")
            self.assertEqual(CLIENT.get(target, Range=f"bytes={len(whole.body)}-").status, 416)
            head = CLIENT.call("HEAD", target)
            self.assertEqual((head.body, head.headers["content-length"]), (b"", str(len(whole.body))))

    def test_downloads_have_names_that_tell_them_apart(self):
        extraction = done_extraction()
        CLIENT.get(f"/v1/extractions/{extraction}/lods/0.drc")  # the second time from memory
        for name, saved in (("lods/0.drc", "level-0.drc"), ("lods/1.glb", "level-1.glb"), ("bodies", "bodies.json"),
                            ("lods/1/parts/0.drc", "level-1-part-0.drc"), ("manifest", "manifest.json")):
            target = f"/v1/extractions/{extraction}/{name}"
            for answer in (CLIENT.get(target), CLIENT.call("HEAD", target), CLIENT.get(target, Range="bytes=0-3")):
                self.assertEqual(answer.headers["content-disposition"], f'inline; filename="{extraction[:12]}-{saved}"')
        for form, saved in (("png", "crossline-3.png"), ("f32", "crossline-3.f32")):
            answer = CLIENT.get(f"/v1/volumes/{VOLUME}/slices/crossline/3?format={form}")
            self.assertEqual(answer.headers["content-disposition"], f'inline; filename="{VOLUME[:12]}-{saved}"')

    def test_glb_and_stl_come_with_their_types_and_counts(self):
        extraction = done_extraction()
        level = CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()["levels"][1]
        glb = CLIENT.get(f"/v1/extractions/{extraction}/lods/1.glb")
        self.assertEqual(glb.headers["content-type"], "model/gltf-binary")
        magic, version, length, json_length = struct.unpack("<4sIII", glb.body[:16])
        self.assertEqual((magic, version, length), (b"glTF", 2, len(glb.body)))
        indices = json.loads(glb.body[20 : 20 + json_length])["accessors"][-1]
        self.assertEqual(indices["count"], 3 * level["triangles"])
        stl = CLIENT.get(f"/v1/extractions/{extraction}/lods/1.stl")
        self.assertEqual(stl.headers["content-type"], "model/stl")
        self.assertEqual(struct.unpack("<I", stl.body[80:84])[0], level["triangles"])
        self.assertEqual(len(stl.body), 84 + 50 * level["triangles"])

    def test_draco_files_say_how_they_lie_in_the_world(self):
        extraction = done_extraction()
        manifest = CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()
        answer = CLIENT.get(f"/v1/extractions/{extraction}/lods/4.drc")
        self.assertEqual([float(number) for number in answer.headers["x-geosis-transform"].split(",")], manifest["transform"])

    def test_levels_that_are_not_there_are_refused(self):
        base = f"/v1/extractions/{done_extraction()}/lods"
        for name in ("9.drc", "0/parts/99.drc", "0.gif", "99999999999999999999.drc"):
            self.refused(CLIENT.get(f"{base}/{name}"), 404)

    def test_one_shot_keeps_nothing_and_gives_the_same_bytes(self):
        stored = CLIENT.get(f"/v1/extractions/{done_extraction()}/stream").parts()
        before = CLIENT.get("/v1/volumes").json()
        answer = CLIENT.call("POST", "/v1/extract?range=0.55,inf", body=SURVEY)
        self.assertEqual([body for _, body in answer.parts()][:-1], [body for _, body in stored][:-1])
        self.assertEqual(CLIENT.get("/v1/volumes").json(), before)
        self.refused(CLIENT.call("POST", "/v1/extract", body=SURVEY), 400, "invalid_argument")
        self.refused(CLIENT.call("POST", "/v1/extract?range=1,0", body=SURVEY), 400, "invalid_argument")
        self.refused(CLIENT.call("POST", "/v1/extract?range=0,1", body=b"not a survey"), 422)


class MissingSamples(Refusals):
    """The sample survey has holes; its outline is a polygon."""

    @staticmethod
    def levels(**request):
        extraction = done_extraction({**BODY, **request})
        return CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()["levels"]

    def test_every_way_of_filling_gives_a_certified_body(self):
        bytes_of_finest = {level["parts"][0]["sha256"] for level in (self.levels()[0],)}
        for missing in ({"method": "linear"}, {"method": "rbf"}, {"method": "rbf", "steer": "off"},
                        {"method": "rbf", "kernel": "inverse_distance"}):
            finest = self.levels(missing=missing)[0]
            self.assertTrue(finest["manifold"])
            self.assertGreater(finest["interpolated_share"], 0, missing)
            bytes_of_finest.add(finest["parts"][0]["sha256"])
        self.assertEqual(len(bytes_of_finest), 5, "each way gives another surface")

    def test_what_is_measured_only_interpolates_nothing(self):
        self.assertEqual({level["interpolated_share"] for level in self.levels()}, {0})

    def test_a_distance_near_zero_fills_nothing(self):
        self.assertEqual(self.levels(missing={"method": "linear", "max_distance": 0.5})[0]["interpolated_share"], 0)

    def test_one_shot_fills_too(self):
        answer = CLIENT.call("POST", "/v1/extract?range=0.55,inf&missing=linear", body=SURVEY)
        manifest = json.loads(answer.parts()[-1][1])
        self.assertEqual(manifest["request"]["missing"]["method"], "linear")
        self.assertGreater(manifest["levels"][0]["interpolated_share"], 0)
        self.refused(CLIENT.call("POST", "/v1/extract?range=0,1&missing=maybe", body=SURVEY), 400, "invalid_argument")


class Bodies(Refusals):
    REQUEST = {"range": [0.1, 0.3]}  # many pieces

    def bodies(self, request):
        extraction = done_extraction(request)
        manifest = CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()
        return CLIENT.get(f"/v1/extractions/{extraction}/{manifest['bodies_url']}").json()["bodies"], manifest

    def test_each_is_described_largest_first(self):
        bodies, manifest = self.bodies(self.REQUEST)
        self.assertGreater(len(bodies), 3)
        volumes = [body["volume_voxels"] for body in bodies]
        self.assertEqual(volumes, sorted(volumes, reverse=True))
        self.assertEqual([body["body"] for body in bodies], list(range(len(bodies))))
        finest = manifest["levels"][0]
        self.assertEqual(sum(body["components"] for body in bodies), finest["components"])
        self.assertEqual(sum(body["genus"] for body in bodies), finest["genus"])
        for body in bodies:
            if body["amplitude"]:
                self.assertLessEqual(0.1 - 1e-6, body["amplitude"]["min"])
                self.assertLessEqual(body["amplitude"]["max"], 0.3 + 1e-6)

    def test_filters_keep_the_same_bodies(self):
        everything, _ = self.bodies(self.REQUEST)
        largest, manifest = self.bodies({**self.REQUEST, "bodies": {"largest": 2}})
        self.assertEqual(largest, everything[:2])
        self.assertEqual(manifest["levels"][0]["components"], sum(body["components"] for body in largest))
        least = everything[2]["volume_voxels"]
        kept, _ = self.bodies({**self.REQUEST, "bodies": {"min_voxels": least}})
        self.assertEqual(kept, [body for body in everything if body["volume_voxels"] >= least])

    def test_a_seed_outside_every_body_keeps_none(self):
        bodies, manifest = self.bodies({"range": [0.999, None], "bodies": {"seeds": [[0, 0, 0]]}})
        self.assertEqual((bodies, manifest["levels"], manifest["empty"]), ([], [], True))
        resource = CLIENT.get(f"/v1/extractions/{manifest['id']}").json()
        self.assertEqual(resource["empty_because"], {"code": "no_seeded_body", "detail": "No body contains a seed."})

    def test_they_have_a_tag_and_come_again(self):
        target = f"/v1/extractions/{done_extraction()}/bodies"
        first = CLIENT.get(target)
        self.assertEqual(CLIENT.get(target).body, first.body)
        self.assertEqual(CLIENT.get(target, If_None_Match=first.headers["etag"]).status, 304)
        self.refused(CLIENT.get(f"/v1/extractions/{ABSENT}/bodies"), 404, "not_found")

    def test_seeds_must_be_nodes(self):
        answer = CLIENT.send_json("POST", f"/v1/volumes/{VOLUME}/extractions", {**BODY, "bodies": {"seeds": [[0, 0, 999]]}})
        self.refused(answer, 400, pointer="/bodies/seeds")


class Attributes(Refusals):
    def test_a_value_comes_from_another_volume(self):
        cube = raw_cube(8, 9, 10, lambda i, j, k: 1.0 if 2 <= i <= 5 and 2 <= j <= 6 and 3 <= k <= 7 else 0.0)
        other = raw_cube(8, 9, 10, lambda i, j, k: float(100 * i + 10 * j + k))
        volume = CLIENT.upload(cube, "format=raw&dims=8,9,10").json()["id"]
        values = CLIENT.upload(other, "format=raw&dims=8,9,10").json()["id"]
        request = {"range": [0.5, None], "attributes": ["value", "body"], "attribute_volume": values, "levels": [{"ratio": 1}]}
        extraction = done_extraction(request, volume)
        ply = CLIENT.get(f"/v1/extractions/{extraction}/lods/0.ply").body
        header, _, data = ply.partition(b"end_header\n")
        self.assertIn(b"property uint body\nproperty float value", header)
        count = int(header.split(b"element vertex ")[1].split()[0])
        for n in range(count):
            i, j, k, body, value = struct.unpack_from("<dddIf", data, 32 * n)
            self.assertEqual(body, 0)
            self.assertAlmostEqual(value, 100 * i + 10 * j + k, places=3)
        self.assertEqual(CLIENT.call("DELETE", f"/v1/volumes/{values}").status, 204)
        self.refused(CLIENT.get(f"/v1/extractions/{extraction}"), 404, "not_found")

    def test_the_other_volume_must_fit(self):
        small = CLIENT.upload(raw_cube(2, 2, 2), "format=raw&dims=2,2,2").json()["id"]
        target = f"/v1/volumes/{VOLUME}/extractions"
        for other, status in ((small, 400), (ABSENT, 404), (None, 400)):
            request = {**BODY, "attributes": ["value"], "attribute_volume": other}
            self.refused(CLIENT.send_json("POST", target, request), status, pointer="/attribute_volume")

    def test_a_velocity_turns_times_into_depths(self):
        times = CLIENT.get(f"/v1/extractions/{done_extraction()}/manifest").json()
        depths = CLIENT.get(f"/v1/extractions/{done_extraction({**BODY, 'velocity': 3000})}/manifest").json()
        self.assertAlmostEqual(depths["transform"][10], 1.5 * times["transform"][10])
        self.assertIsNone(times["levels"][0]["volume"])
        self.assertGreater(depths["levels"][0]["volume"], 0)
        self.assertGreater(depths["levels"][4]["distance"]["max"], 0)
        cube = CLIENT.upload(raw_cube(4, 4, 4), "format=raw&dims=4,4,4").json()["id"]
        self.refused(CLIENT.send_json("POST", f"/v1/volumes/{cube}/extractions", {"range": [1, 3], "velocity": 2000}), 400,
                     pointer="/velocity")


class SameBytes(unittest.TestCase):
    """The service and the command line are one pipeline."""

    def check(self, path, low, high):
        volume = CLIENT.upload(path.read_bytes()).json()["id"]
        ends = [None if abs(end) == float("inf") else end for end in (low, high)]
        extraction = done_extraction({"range": ends}, volume)
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([GEOSIS, "reconstruct", path, "--range", str(low), str(high), "--out", folder],
                           check=True, capture_output=True)
            manifest = json.loads(Path(folder, "manifest.json").read_text(encoding="utf-8"))
            self.assertEqual((manifest["volume"], manifest["id"]), (volume, extraction))
            for level in manifest["levels"]:
                for number, part in enumerate(level["parts"]):
                    answer = CLIENT.get(f"/v1/extractions/{extraction}/lods/{level['level']}/parts/{number}.drc")
                    self.assertEqual(answer.body, Path(folder, part["url"]).read_bytes())
        return CLIENT.get(f"/v1/extractions/{extraction}/manifest").json()["levels"], manifest["levels"]

    def assert_same(self, path, low, high):
        for ours, theirs in zip(*self.check(path, low, high), strict=True):
            for name in set(ours) - {"url", "parts"}:
                self.assertEqual(ours[name], theirs[name], name)

    def test_of_the_sample_survey(self):
        self.assert_same(FOLDER / "survey.sgy", 0.55, float("inf"))

    def test_of_a_field_survey(self):
        found = sorted(SHARED.glob("data/**/petrel_buildup*.sgy")) + sorted(SHARED.glob("data/**/petrel_buildup*.segy"))
        if not found:
            self.skipTest(f"no petrel_buildup below {SHARED}")
        self.assert_same(found[0], 0.5, float("inf"))


class Protocol(Refusals):
    def test_the_service_says_how_it_is(self):
        self.assertEqual(CLIENT.get("/livez").status, 200)
        self.assertTrue(CLIENT.get("/readyz").json()["ready"])
        self.assertGreaterEqual(CLIENT.get("/version").json()["result_version"], 1)

    def test_it_serves_the_contract_it_was_built_with(self):
        self.assertEqual(CLIENT.get("/openapi.yaml").body, OPENAPI.read_bytes())

    def test_unknown_paths_and_methods_are_refused(self):
        self.refused(CLIENT.get("/v1/nothing"), 404, "not_found")
        answer = CLIENT.call("DELETE", "/v1/volumes")
        self.refused(answer, 405)
        self.assertIn("POST", answer.headers["allow"])
        for method, body in (("PUT", b""), ("PUT", b"some"), ("PATCH", b"{}"), ("TRACE", None)):
            answer = CLIENT.call(method, "/v1/volumes", body=body)
            self.refused(answer, 405, "unsupported", title="Unsupported")
            self.assertEqual(answer.headers["allow"], "GET, HEAD, POST, OPTIONS")
        self.refused(CLIENT.call("PUT", "/v1/nothing", body=b"some"), 404, "not_found", title="Not found")
        self.refused(CLIENT.get(f"/v1/volumes/{ABSENT}"), 404, "not_found", title="Not found")
        self.refused(CLIENT.call("BREW", "/v1/volumes"), 501)

    def test_a_body_without_length_is_refused(self):
        host = b"Host: " + SERVICE.address.encode()
        answer = CLIENT.raw(b"POST /v1/volumes HTTP/1.1\r\n" + host + b"\r\n\r\n")
        self.refused(answer, 411)
        CONTRACT.check("POST", "/v1/volumes", answer)

    def test_too_large_a_body_is_refused_before_it_is_read(self):
        head = f"POST /v1/volumes HTTP/1.1\r\nHost: {SERVICE.address}\r\nContent-Length: {1 << 60}\r\n\r\n"
        answer = CLIENT.raw(head.encode())
        self.assertIn(answer.status, (413, 507))
        CONTRACT.check("POST", "/v1/volumes", answer)
        big = json.dumps({"range": [0, 1], "padding": "x" * (1 << 20)})
        self.refused(CLIENT.send_json("POST", f"/v1/volumes/{VOLUME}/extractions", big), 413, "limit_exceeded")

    def test_pages_of_named_origins_may_call(self):
        preflight = CLIENT.call("OPTIONS", f"/v1/volumes/{VOLUME}/extractions", headers={
            "Origin": PAGE, "Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "content-type"})
        self.assertEqual(preflight.status, 204)
        self.assertEqual(preflight.headers["access-control-allow-origin"], PAGE)
        self.assertIn("POST", preflight.headers["access-control-allow-methods"])
        self.assertEqual(CLIENT.get("/v1/volumes", Origin=PAGE).headers["access-control-allow-origin"], PAGE)
        self.assertNotIn("access-control-allow-origin", CLIENT.get("/v1/volumes", Origin="http://other.example").headers)


class TheJudge(unittest.TestCase):
    """A judge that lets everything pass would prove nothing."""

    def judge(self, target, status, headers, body):
        Contract().check("GET", target, Answer(status, headers, body))

    def test_refuses_other_statuses_types_and_members(self):
        good = {"name": "geosis", "version": "1", "result_version": 1}
        as_json = {"content-type": "application/json"}
        self.judge("/version", 200, as_json, json.dumps(good).encode())
        for status, headers, document in ((203, as_json, good), (200, {"content-type": "text/plain"}, good),
                                          (200, as_json, {**good, "result_version": 0}), (200, as_json, {})):
            with self.assertRaises(Exception, msg=document):
                self.judge("/version", status, headers, json.dumps(document).encode())


if __name__ == "__main__":
    program = unittest.main(exit=False)
    missed = CONTRACT.operations() - {operation for operation, status in CONTRACT.seen if status < 300}
    if missed and len(sys.argv) == 1:
        print(f"operations that were never answered well: {', '.join(sorted(missed))}", file=sys.stderr)
        sys.exit(1)
    sys.exit(not program.result.wasSuccessful())
