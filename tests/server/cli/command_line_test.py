"""Runs the built binary (environment variable GEOSIS) on files it makes itself and checks what it leaves behind."""
import hashlib
import json
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "contract"))

from surveys import segy_head, two_grids  # noqa: E402  (of the contract's tests)

GEOSIS = os.environ["GEOSIS"]
BODY = ("--range", "0.55", "inf")


def geosis(*arguments):
    return subprocess.run([GEOSIS, *map(str, arguments)], capture_output=True, text=True, check=False)


def files_in(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def decoded_counts(path):
    """(vertices, triangles) of a Draco file as Debian's draco_decoder sees it."""
    with tempfile.TemporaryDirectory() as folder:
        mesh = Path(folder, "mesh.obj")
        subprocess.run(["draco_decoder", "-i", path, "-o", mesh], check=True, capture_output=True)
        lines = mesh.read_text(encoding="ascii").splitlines()
    return sum(line.startswith("v ") for line in lines), sum(line.startswith("f ") for line in lines)


def seismic_line(traces, samples):
    """A 2D line as SEG-Y: ensembles numbered along the line, no inline or crossline numbers."""
    data = segy_head(samples)
    for trace in range(traces):
        header = bytearray(240)
        struct.pack_into(">ii", header, 0, trace + 1, trace + 1)
        struct.pack_into(">ii", header, 20, 100 + trace, 1)
        struct.pack_into(">ii", header, 180, 456000 + 25 * trace, 6781000)
        struct.pack_into(">hh", header, 114, samples, 4000)
        data += header + struct.pack(f">{samples}f", *(float(k) for k in range(samples)))
    return bytes(data)


class WithFolder(unittest.TestCase):
    """A folder for each class, with a small sample survey in it."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="geosis-test-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.survey = cls.folder / "survey.sgy"
        cls.expect_success(geosis("synth", cls.survey, "--dims", "48,56,64"))

    @classmethod
    def expect_success(cls, run):
        if run.returncode != 0 or run.stderr:
            raise AssertionError(f"exit status {run.returncode}: {run.stderr}")

    def reconstruct(self, name, *arguments, survey=None):
        """Runs reconstruct into a folder of that name; returns the folder and its manifest."""
        out = self.folder / name
        self.expect_success(geosis("reconstruct", survey or self.survey, "--out", out, *arguments))
        return out, json.loads((out / "manifest.json").read_text(encoding="utf-8"))

    def expect_parts(self, out, manifest):
        """Every part is there as the manifest says, for a reader that is not ours as well."""
        for level in manifest["levels"]:
            for part in level["parts"]:
                data = (out / part["url"]).read_bytes()
                self.assertEqual(len(data), part["bytes"])
                self.assertEqual(hashlib.sha256(data).hexdigest(), part["sha256"])
                vertices, triangles = decoded_counts(out / part["url"])
                self.assertEqual(triangles, part["triangles"])
                if len(level["parts"]) == 1:
                    self.assertEqual(vertices, level["vertices"])
            self.assertEqual(sum(part["triangles"] for part in level["parts"]), level["triangles"])
            self.assertEqual(sum(part["bytes"] for part in level["parts"]), level["bytes"])


class Synth(WithFolder):
    def test_same_seed_gives_the_same_bytes(self):
        for name, seed in (("a", 7), ("b", 7), ("c", 8)):
            self.expect_success(geosis("synth", self.folder / name, "--dims", "20,20,20", "--seed", seed))
        data = files_in(self.folder)
        self.assertEqual(data["a"], data["b"])
        self.assertNotEqual(data["a"], data["c"])

    def test_missing_none_leaves_no_trace_out(self):
        full = self.folder / "full.sgy"
        self.expect_success(geosis("synth", full, "--dims", "20,30,40", "--missing", "none", "--kind", "reflectors"))
        self.assertEqual(full.stat().st_size, 3600 + 20 * 30 * (240 + 4 * 40))

    def test_refuses_a_survey_of_one_line(self):
        run = geosis("synth", self.folder / "line.sgy", "--dims", "1,30,40")
        self.assertEqual((run.returncode, run.stderr),
                         (1, "geosis: invalid_argument: --dims 1,30,40: at least 2 an axis\n"))
        self.assertFalse((self.folder / "line.sgy").exists())


class Info(WithFolder):
    def test_prints_the_volume_document(self):
        run = geosis("info", self.survey)
        self.expect_success(run)
        document = json.loads(run.stdout)
        self.assertEqual(document["dims"], [48, 56, 64])
        self.assertEqual(document["axes"]["inline"], {"first": 1001, "step": 1, "byte": 189})
        self.assertEqual(document["axes"]["sample"], {"first": 1000, "step": 4, "unit": "ms"})
        self.assertEqual(document["bytes"], self.survey.stat().st_size)
        self.assertGreater(document["missing"]["traces"], 100)
        self.assertEqual(document["missing"]["samples"], 64 * document["missing"]["traces"])

    def test_gives_the_id_that_manifests_name(self):
        _, manifest = self.reconstruct("named", *BODY)
        self.assertEqual(json.loads(geosis("info", self.survey).stdout)["id"], manifest["volume"])

    def test_id_is_the_same_whether_an_option_is_given_or_found(self):
        found = json.loads(geosis("info", self.survey).stdout)["id"]
        given = json.loads(geosis("info", self.survey, "--inline-byte", "189", "--crossline-byte", "193").stdout)["id"]
        other = json.loads(geosis("info", self.survey, "--null-value", "0").stdout)["id"]
        self.assertEqual(found, given)
        self.assertNotEqual(found, other)

    def test_reads_raw_samples(self):
        raw = self.folder / "volume.raw"
        raw.write_bytes(bytes(range(24)))
        run = geosis("info", raw, "--format", "raw", "--dims", "2,3,4", "--dtype", "uint8", "--null-value", "5")
        self.expect_success(run)
        document = json.loads(run.stdout)
        self.assertEqual(document["value_range"], [0, 23])
        self.assertEqual(document["missing"]["samples"], 1)


    def test_names_no_period_longer_than_a_trace(self):
        raw = self.folder / "slow.raw"
        raw.write_bytes(struct.pack("<600f", *(1000.0 * i + k for i in range(6) for _ in range(5) for k in range(20))))
        structure = json.loads(geosis("info", raw, "--format", "raw", "--dims", "6,5,20").stdout)["structure"]
        self.assertEqual((structure["period"], structure["auto"]), (None, "given"))
        self.assertTrue(structure["because"].endswith("the dominant period, which is longer than a trace"), structure)


class PlacedGrids(WithFolder):
    """The sample survey on grids of files."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.nodes = cls.folder / "nodes"
        cls.nodes.write_bytes(b"".join(struct.pack("<3d", *cls.place(i, j, k)) for i in range(48) for j in range(56) for k in range(64)))
        cls.by_nodes = ("--grid-nodes", cls.nodes, "--grid-dtype", "float64")

    @staticmethod
    def place(i, j, k):
        return 5e5 + 25.0 * j + 0.25 * k, 6e6 + 25.0 * i, 1000 + 8.0 * k

    def test_info_says_what_the_grid_is(self):
        run = geosis("info", self.survey, *self.by_nodes)
        self.expect_success(run)
        document = json.loads(run.stdout)
        grid = document["grid"]
        self.assertEqual((grid["kind"], grid["volume"], grid["dims"]), ("nodes", document["id"], [48, 56, 64]))
        self.assertEqual((grid["mirrored"], grid["folded_share"], grid["box"][0]), (True, 0, [5e5, 6e6, 1000]))

    def test_pillars_make_the_same_grid(self):
        pillars = self.folder / "pillars"
        traces = [(i, j) for i in range(48) for j in range(56)]
        pillars.write_bytes(
            b"".join(struct.pack(">6d", *self.place(i, j, 0), *self.place(i, j, 32)) for i, j in traces) +
            b"".join(struct.pack(">64d", *(self.place(i, j, k)[2] for k in range(64))) for i, j in traces))
        ids = [json.loads(geosis("info", self.survey, *flags).stdout)["grid"]["id"] for flags in
               (self.by_nodes, ("--grid-pillars", pillars, "--grid-dtype", "float64", "--grid-byte-order", "big"))]
        self.assertEqual(ids[0], ids[1])

    def test_surfaces_lie_where_the_nodes_say(self):
        levels = self.folder / "one-level.json"
        levels.write_text('{"levels": [{"ratio": 1}]}', encoding="utf-8")
        request = (*BODY, "--request", levels, "--formats", "obj")
        out, manifest = self.reconstruct("placed", *request, *self.by_nodes)
        index_out, plain = self.reconstruct("index", *request, "--space", "index")
        self.assertEqual(manifest["grid"]["chosen"], "curvilinear")
        self.assertEqual(manifest["request"]["grid"], manifest["grid"]["id"])
        for name in ("euler", "components", "boundary_loops", "vertices", "triangles"):
            self.assertEqual(manifest["levels"][0][name], plain["levels"][0][name], name)
        found, truth = ([tuple(map(float, line.split()[1:])) for line in (folder / "lod0.obj").read_text(encoding="ascii").splitlines()
                         if line.startswith("v ")] for folder in (out, index_out))
        for position, index in zip(found, truth):  # in the same order; linear, so that cells need no looking up
            wanted = self.place(*index)
            self.assertLess(max(abs(a - b) for a, b in zip(position, wanted)), 0.51 * manifest["grid"]["lattice_step"])

    def test_depths_come_from_another_survey(self):
        run = geosis("info", self.survey, "--grid-z", self.survey)  # amplitudes are no depths
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stderr, r"malformed_input: (z: node \[\d+,\d+,\d+\] is missing|node positions: .* folded)")

    def test_flags_that_make_no_sense_are_refused(self):
        short = self.folder / "short"
        short.write_bytes(b"1234")
        for flags, expected in ((("--grid-nodes", short), "short: node positions: 4 bytes; expected 2064384 for the 48 x 56 x 64 nodes"),
                                (("--grid-nodes", short, "--grid-z", short), "one of these"),
                                (("--grid-dtype", "float64"), "need --grid-nodes"),
                                (("--grid-nodes", short, "--grid-dtype", "int8"), "dtype"),
                                (("--grid-nodes", self.folder / "absent"), "not_found")):
            run = geosis("reconstruct", self.survey, *BODY, "--out", self.folder / "refused", *flags)
            self.assertEqual(run.returncode, 1)
            self.assertIn(expected, run.stderr)
        for grid, expected in (("structural", "structural, but the files give a grid"), ("auto", "auto, but the files"),
                               ("0" * 64, "the grid in the files is another one, ")):
            run = geosis("reconstruct", self.survey, *BODY, "--out", self.folder / "refused", *self.by_nodes, "--grid", grid)
            self.assertIn(f"request /grid: {expected}", run.stderr)
        run = geosis("reconstruct", self.survey, *BODY, "--out", self.folder / "refused", "--grid", "0" * 64)
        self.assertIn("request /grid: give the grid's file", run.stderr)


class Reconstruct(WithFolder):
    def test_writes_five_levels_as_the_manifest_says(self):
        out, manifest = self.reconstruct("five", *BODY)
        self.assertEqual([level["level"] for level in manifest["levels"]], [0, 1, 2, 3, 4])
        self.assertEqual(sorted(files_in(out)), sorted(["bodies.json", "manifest.json", *(f"lod{k}.drc" for k in range(5))]))
        self.expect_parts(out, manifest)

    def test_every_level_keeps_the_topology_of_the_finest(self):
        _, manifest = self.reconstruct("topology", *BODY)
        finest = manifest["levels"][0]
        self.assertGreater(finest["triangles"], 1000)
        for level in manifest["levels"]:
            self.assertTrue(level["manifold"])
            self.assertEqual(level["boundary_loops"], 0)
            for count in ("euler", "components", "genus"):
                self.assertEqual(level[count], finest[count], count)
            if level["level"] > 0:
                self.assertLess(level["triangles"], manifest["levels"][level["level"] - 1]["triangles"])

    def test_gives_the_same_bytes_on_one_and_two_threads(self):
        one, _ = self.reconstruct("one", *BODY, "--threads", "1", "--formats", "drc,glb,ply,obj,stl")
        two, _ = self.reconstruct("two", *BODY, "--threads", "2", "--formats", "drc,glb,ply,obj,stl")
        self.assertEqual(files_in(one), files_in(two))

    def test_request_file_means_the_same_as_flags(self):
        request = self.folder / "request.json"
        request.write_text('{"range": [0.55, null], "cap": false, "space": "index", '
                           '"region": {"inline": [0, 40], "crossline": [3, 50], "sample": [0, 60]}}', encoding="utf-8")
        _, by_file = self.reconstruct("file", "--request", request)
        _, by_flags = self.reconstruct("flags", *BODY, "--no-cap", "--space", "index", "--region", "0:40,3:50,0:60")
        self.assertEqual(by_file, by_flags)
        self.assertEqual(by_file["transform"], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])

    def test_flags_win_over_the_request_file(self):
        request = self.folder / "other.json"
        request.write_text('{"range": [0.2, 0.3], "mode": "sampled"}', encoding="utf-8")
        _, manifest = self.reconstruct("win", "--request", request, "--range", "-inf", "-0.25")
        self.assertEqual(manifest["request"]["range"], [None, -0.25])
        self.assertEqual(manifest["request"]["mode"], "sampled")

    def test_uncapped_body_has_boundary_loops(self):
        _, manifest = self.reconstruct("open", *BODY, "--no-cap")
        self.assertGreater(manifest["levels"][0]["boundary_loops"], 0)
        self.assertTrue(manifest["levels"][0]["manifold"])

    def test_writes_ply_and_obj_in_world_coordinates(self):
        out, manifest = self.reconstruct("formats", *BODY, "--formats", "ply,obj")
        for level in manifest["levels"]:
            lines = (out / f"lod{level['level']}.obj").read_text(encoding="ascii").splitlines()
            vertices = [line.split()[1:] for line in lines if line.startswith("v ")]
            self.assertEqual(len(vertices), level["vertices"])
            self.assertEqual(sum(line.startswith("f ") for line in lines), level["triangles"])
            self.assertTrue(all(454000 < float(x) < 460000 and 6780000 < float(y) < 6784000 for x, y, _ in vertices))
            header = (out / f"lod{level['level']}.ply").read_bytes().split(b"end_header\n")[0].decode("ascii")
            self.assertIn(f"element vertex {level['vertices']}\n", header)
            self.assertIn(f"element face {level['triangles']}\n", header)

    def test_writes_glb_and_stl_around_the_origin(self):
        out, manifest = self.reconstruct("origin", *BODY, "--formats", "glb,stl")
        for level in manifest["levels"]:
            stl = (out / f"lod{level['level']}.stl").read_bytes()
            self.assertEqual(len(stl), 84 + 50 * level["triangles"])
            self.assertEqual([float(number) for number in stl[:80].split()[1:]], manifest["origin"])
            first = struct.unpack("<12f", stl[84:132])[3:]
            self.assertTrue(all(abs(coordinate) < 10_000 for coordinate in first), first)
            glb = (out / f"lod{level['level']}.glb").read_bytes()
            document = json.loads(glb[20 : 20 + struct.unpack("<I", glb[12:16])[0]])
            self.assertEqual(document["nodes"][0]["extras"]["origin"], manifest["origin"])
            self.assertEqual(document["accessors"][0]["count"], level["vertices"])

    def test_empty_range_leaves_the_documents_alone(self):
        out, manifest = self.reconstruct("empty", "--range", "1000", "inf")
        self.assertEqual((manifest["empty"], manifest["levels"]), (True, []))
        self.assertEqual(sorted(files_in(out)), ["bodies.json", "manifest.json"])

    def test_says_why_there_are_no_levels(self):
        for flags, reason in ((("1000", "inf"), "Nothing lies in the range."),
                              (("0.55", "inf", "--seed", "0,0,0"), "No body contains a seed."),
                              (("0.55", "inf", "--min-voxels", "1e9"),
                               "Every body that could be kept is smaller than min_voxels.")):
            run = geosis("reconstruct", self.survey, "--out", self.folder / "why", "--range", *flags)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn(reason + " There are no levels.", run.stdout)

    def test_removes_the_files_of_an_earlier_result(self):
        out, _ = self.reconstruct("again", *BODY, "--formats", "obj")
        (out / "notes.txt").write_text("mine", encoding="utf-8")
        self.reconstruct("again", "--range", "1000", "inf")
        self.assertEqual(sorted(files_in(out)), ["bodies.json", "manifest.json", "notes.txt"])

    def test_failed_run_leaves_an_earlier_result_as_it_was(self):
        out, _ = self.reconstruct("kept", *BODY)
        before = files_in(out)
        run = geosis("reconstruct", self.survey, "--out", out, "--range", "0", "1", "--region", "0:1,0:1,0:9999")
        self.assertEqual(run.returncode, 1)
        self.assertEqual(files_in(out), before)

    def test_manifest_holds_neither_times_nor_folders(self):
        out, _ = self.reconstruct("pure", *BODY)
        text = (out / "manifest.json").read_text(encoding="utf-8")
        self.assertNotIn(str(self.folder), text)
        self.assertNotIn("seconds", text)


class BigReconstruct(WithFolder):
    def test_writes_big_levels_in_parts(self):
        survey = self.folder / "reflectors.sgy"
        self.expect_success(geosis("synth", survey, "--dims", "90,100,120", "--kind", "reflectors"))
        out, manifest = self.reconstruct("parts", "--range", "0.1", "inf", survey=survey)
        finest = manifest["levels"][0]
        self.assertGreater(len(finest["parts"]), 1)
        self.assertIsNone(finest["url"])
        self.assertEqual([part["url"] for part in finest["parts"]],
                         [f"lod0.{part}.drc" for part in range(len(finest["parts"]))])
        self.expect_parts(out, manifest)


class Refusals(WithFolder):
    def expect_refusal(self, code, *arguments, says=""):
        """The run fails with one line that holds the code, and leaves nothing behind."""
        before = sorted(self.folder.rglob("*"))
        run = geosis(*arguments)
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertEqual(run.stdout, "")
        self.assertRegex(run.stderr, rf"\Ageosis: {code}: [^\n]+\n\Z")
        self.assertIn(says, run.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def expect_file_refusal(self, code, name, data, says=""):
        path = self.folder / name
        path.write_bytes(data)
        self.expect_refusal(code, "reconstruct", path, "--out", self.folder / "out", *BODY, says=says)
        self.expect_refusal(code, "info", path, says=says)

    def test_missing_file(self):
        self.expect_refusal("not_found", "reconstruct", self.folder / "none.sgy", *BODY, "--out", self.folder / "out",
                            says="none.sgy")

    def test_seismic_line(self):
        self.expect_file_refusal("unsupported", "line.sgy", seismic_line(60, 50), says="SEG-Y: not a stacked 3D survey: a 2D line")

    def test_survey_cut_short(self):
        self.expect_file_refusal("malformed_input", "short.sgy", self.survey.read_bytes()[:-100])

    def test_file_that_is_no_volume(self):
        for name, data in (("empty", b""), ("text", b"hello\n" * 1000), ("zeros", bytes(10000))):
            path = self.folder / name
            path.write_bytes(data)
            run = geosis("info", path)
            self.assertEqual(run.returncode, 1, name)
            self.assertRegex(run.stderr, r"\Ageosis: (malformed_input|unsupported|invalid_argument): [^\n]+\n\Z")

    def test_ranges_that_make_no_sense(self):
        for low, high in (("2", "1"), ("nan", "1"), ("0", "NaN"), ("a", "1"), ("inf", "inf"), ("0", "-inf"), ("", "1")):
            self.expect_refusal("invalid_argument", "reconstruct", self.survey, "--out", self.folder / "out",
                                "--range", low, high, says="range")

    def test_no_range(self):
        self.expect_usage("--range LOW HIGH is required", "reconstruct", self.survey, "--out", self.folder / "out")
        request = self.folder / "rangeless.json"
        request.write_text("{}", encoding="utf-8")
        self.expect_refusal("invalid_argument", "reconstruct", self.survey, "--request", request, "--out", self.folder / "out",
                            says="/range")

    def test_a_grid_of_no_such_name_is_not_looked_for_by_id(self):
        run = geosis("reconstruct", self.survey, *BODY, "--grid", "foo", "--out", self.folder / "out")
        self.assertEqual((run.returncode, run.stderr),
                         (1, "geosis: invalid_argument: --grid foo: expected given, structural or auto\n"))

    def test_synth_of_two_dimensions(self):
        self.expect_refusal("invalid_argument", "synth", self.folder / "flat.sgy", "--dims", "10,10",
                            says="--dims 10,10: expected I,J,K")

    def test_header_bytes_in_doubt_are_listed_once(self):
        path = self.folder / "doubt.sgy"
        path.write_bytes(two_grids(6, 5, 20))
        run = geosis("info", path)
        self.assertEqual(run.returncode, 1)
        self.assertIn("give one of --inline-byte", run.stderr)
        pairs = re.findall(r"--inline-byte (\d+) --crossline-byte (\d+)", run.stderr)
        self.assertGreater(len(pairs), 1)
        for inline, crossline in pairs:
            self.assertEqual(len(re.findall(rf"\b{inline}\b\D+\b{crossline}\b", run.stderr)), 1, run.stderr)
            chosen = geosis("info", path, "--inline-byte", inline, "--crossline-byte", crossline)
            self.assertEqual(chosen.returncode, 0, chosen.stderr)

    def expect_usage(self, says, *arguments):
        run = geosis(*arguments)
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertRegex(run.stderr, r"\Ageosis: usage: [^\n]+\n\Z")
        self.assertIn(says, run.stderr)

    def test_a_word_that_is_no_command_is_named(self):
        self.expect_usage("there is no command frobnicate", "frobnicate")
        self.expect_usage("there is no command frobnicate", "frobnicate", "--range", "0", "1")

    def test_help_shows_values_and_defaults_as_people_write_them(self):
        text = geosis("serve", "--help").stdout
        self.assertRegex(text, r"--log-format text\|json=text")
        self.assertRegex(text, r"--log-level debug\|info\|warning\|error=info")
        self.assertRegex(text, r"--cors-origin ORIGIN \.\.\.\s+origins")
        for ugly in ("ENUM", "->", "[]"):
            self.assertNotIn(ugly, text)

    def test_region_outside_the_volume(self):
        for region in ("0:48,0:55,0:63", "5:5,0:1,0:1", "0:1,0:1", "a"):
            self.expect_refusal("invalid_argument", "reconstruct", self.survey, *BODY, "--region", region,
                                "--out", self.folder / "out", says="region")

    def test_request_with_an_unknown_field(self):
        request = self.folder / "request.json"
        request.write_text('{"range": [0, 1], "levels": [{"ratio": 1, "rato": 1}]}', encoding="utf-8")
        self.expect_refusal("invalid_argument", "reconstruct", self.survey, "--request", request,
                            "--out", self.folder / "out", says="/levels/0/rato")

    def test_folder_that_cannot_be_written(self):
        out = self.survey / "out"  # below a file, so that it is refused to root as well
        self.expect_refusal("unavailable", "reconstruct", self.survey, *BODY, "--out", out, says=str(out))

    def test_synth_into_a_folder_that_is_not_there(self):
        self.expect_refusal("(unavailable|not_found)", "synth", self.folder / "none" / "out.sgy")

    def test_unknown_format(self):
        self.expect_refusal("invalid_argument", "reconstruct", self.survey, *BODY, "--formats", "step",
                            "--out", self.folder / "out", says="step")

    def test_command_lines_that_make_no_sense(self):
        for arguments in ((), ("paint",), ("reconstruct",), ("reconstruct", self.survey, "--range", "1"),
                          ("info", self.survey, "--colour", "1"), ("synth", "x.sgy", "--kind", "reef"),
                          ("reconstruct", self.survey, *BODY, "--threads", "0")):
            run = geosis(*arguments)
            self.assertEqual(run.returncode, 2, arguments)
            self.assertRegex(run.stderr, r"\Ageosis: usage: [^\n]+\n\Z")


class Settings(unittest.TestCase):
    """A flag wins over the environment, the environment over the configuration file."""

    def served_at(self, *flags, **variables):
        """The port that the server says it listens on; it is stopped at once."""
        with subprocess.Popen([GEOSIS, "serve", "--grpc", "off", "--store", self.store, *flags], stdout=subprocess.PIPE, text=True,
                              stderr=subprocess.DEVNULL, env={**os.environ, **variables}) as server:
            line = server.stdout.readline()
            server.terminate()
            self.assertEqual(server.wait(20), 0)
        return line.strip().removeprefix("listening on http://")

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="geosis-test-")
        self.addCleanup(folder.cleanup)
        self.store = str(Path(folder.name, "store"))
        self.config = Path(folder.name, "geosis.ini")
        self.config.write_text("[serve]\nlisten=127.0.0.2:0\n", encoding="ascii")

    def test_file_is_read(self):
        self.assertTrue(self.served_at("--config", str(self.config)).startswith("127.0.0.2:"))

    def test_environment_wins_over_the_file(self):
        served = self.served_at("--config", str(self.config), GEOSIS_LISTEN="127.0.0.3:0")
        self.assertTrue(served.startswith("127.0.0.3:"), served)

    def test_flag_wins_over_the_environment(self):
        served = self.served_at("--listen", "127.0.0.4:0", GEOSIS_LISTEN="127.0.0.3:0")
        self.assertTrue(served.startswith("127.0.0.4:"), served)

    def test_an_empty_variable_is_none(self):
        served = self.served_at("--config", str(self.config), "--admin", "off", GEOSIS_LISTEN="", GEOSIS_AUTH="", GEOSIS_ADMIN="",
                                GEOSIS_MEMORY="", GEOSIS_CORS_ORIGIN="", GEOSIS_TLS_CERT="")
        self.assertTrue(served.startswith("127.0.0.2:"), served)

    def test_variables_stand_for_flags_of_every_command(self):
        folder = Path(self.store).parent
        survey = folder / "survey.sgy"
        subprocess.run([GEOSIS, "synth", survey], env={**os.environ, "GEOSIS_DIMS": "20,24,28"}, check=True,
                       capture_output=True)
        document = json.loads(geosis("info", survey).stdout)
        self.assertEqual(document["dims"], [20, 24, 28])
        subprocess.run([GEOSIS, "reconstruct", survey, "--out", folder / "out"], check=True, capture_output=True,
                       env={**os.environ, "GEOSIS_RANGE": "-inf 0.1", "GEOSIS_NO_CAP": "true"})
        request = json.loads((folder / "out/manifest.json").read_text(encoding="utf-8"))["request"]
        self.assertEqual((request["range"][0], request["cap"]), (None, False))

    def test_a_taken_port_leaves_nothing_behind(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            taken = f"127.0.0.1:{other.getsockname()[1]}"
            for address in ("listen", "grpc", "admin"):
                free = {"listen": "127.0.0.1:0", "grpc": "off", "admin": "off", address: taken}
                flags = [f"--{name}={value}" for name, value in free.items()]
                run = geosis("serve", "--store", self.store, *flags)
                self.assertEqual(run.returncode, 1)
                self.assertRegex(run.stderr, rf"\Ageosis: unavailable: cannot listen at {taken}: [^\n]+\n\Z")
                self.assertFalse(Path(self.store).exists(), flags)

    def test_addresses_that_make_no_sense_are_refused(self):
        for address in ("127.0.0.1:99999", "127.0.0.1", "127.0.0.1:http", ":8080", "0.0.0.0:0"):
            for flags in (["--listen", address, "--grpc", "off"], ["--listen", "127.0.0.1:0", "--grpc", address]):
                refused = geosis("serve", "--store", self.store, *flags)
                self.assertEqual(refused.returncode, 1, flags)
                self.assertIn("invalid_argument", refused.stderr)


if __name__ == "__main__":
    unittest.main()
