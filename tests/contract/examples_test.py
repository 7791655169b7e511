"""Runs the clients of api/examples against a server that asks for keys: all get the same levels, and the bytes that the manifest
names. Environment: GEOSIS = the built binary, NODE = node, PYTHONPATH = the contract's messages as protoc makes them."""
import hashlib
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from service import GEOSIS, Service

EXAMPLES = Path(__file__).resolve().parents[2] / "api" / "examples"
RUN_IN_NODE = """
import { readFileSync, writeFileSync } from 'node:fs';
const [module, server, survey, out] = process.argv.slice(1);
const { Geosis } = await import('data:text/javascript,' + encodeURIComponent(readFileSync(module)));
const geosis = new Geosis(server, process.env.KEY);
const volume = await geosis.upload(new Blob([readFileSync(survey)]), 'survey.sgy');
for await (const { name, blob, level } of geosis.levels(volume, [0.5, null])) {
  console.log(level);
  writeFileSync(`${out}/${name}`, Buffer.from(await blob.arrayBuffer()));
}
try { await geosis.extract(volume, [2, 1]); } catch (error) { console.log(error.message); }
"""


def setUpModule():
    global FOLDER, SERVICE, SURVEY, KEY
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-examples-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    SURVEY = FOLDER / "survey.sgy"
    subprocess.run([GEOSIS, "synth", SURVEY, "--dims", "48,56,64"], check=True)
    KEY, line = subprocess.run([GEOSIS, "key"], check=True, capture_output=True, text=True).stdout.splitlines()
    (FOLDER / "keys").write_text(line + "\n", encoding="ascii")
    SERVICE = unittest.enterModuleContext(
        Service(FOLDER / "store", "--grpc", "127.0.0.1:0", "--admin", "", "--auth", "api_keys", str(FOLDER / "keys"),
                "--log-level", "error"))


def run(*command, key=None):
    return subprocess.run(list(map(str, command)), env={**os.environ, "KEY": key or KEY}, capture_output=True, text=True,
                          timeout=120)


def files(folder, ending):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.name.endswith(ending)}


class Examples(unittest.TestCase):
    def folder(self, name):
        made = FOLDER / name
        made.mkdir(exist_ok=True)
        return made

    def run_python(self, name, address):
        out = self.folder(name)
        done = run(sys.executable, EXAMPLES / f"{name}.py", address, SURVEY, "0.5", "inf", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
        parts = files(out, ".drc")
        named = {f"lod{level.get('level', 0)}.{number}.drc": part["sha256"]
                 for level in manifest["levels"] for number, part in enumerate(level["parts"])}
        self.assertEqual({name: hashlib.sha256(data).hexdigest() for name, data in parts.items()}, named)
        self.assertEqual(len(manifest["levels"]), 5)
        return parts

    def test_python_gets_the_same_parts_over_both_doors(self):
        self.assertEqual(self.run_python("levels_http", f"http://{SERVICE.address}"),
                         self.run_python("levels_grpc", SERVICE.grpc_address))

    def test_shell_and_javascript_get_the_same_files(self):
        shell, script = self.folder("shell"), self.folder("script")
        done = run(EXAMPLES / "levels.sh", f"http://{SERVICE.address}", SURVEY, "0.5", "null", shell)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = run(os.environ["NODE"], "--input-type=module", "-e", RUN_IN_NODE, EXAMPLES / "levels.js",
                   f"http://{SERVICE.address}", SURVEY, script)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.split("\n")[:5], ["4", "3", "2", "1", "0"])
        self.assertIn("invalid_argument: ", done.stdout)
        self.assertEqual(len(files(shell, ".glb")), 5)
        self.assertEqual(files(shell, ".glb"), files(script, ".glb"))

    def test_shell_places_the_nodes(self):
        nodes, out = FOLDER / "nodes", self.folder("placed")
        nodes.write_bytes(b"".join(struct.pack("<3d", 25 * i, 25 * j, 5 * k + 0.02 * k * k)
                                   for i in range(48) for j in range(56) for k in range(64)))
        done = subprocess.run([EXAMPLES / "levels.sh", f"http://{SERVICE.address}", SURVEY, "0.5", "null", out], timeout=120,
                              env={**os.environ, "KEY": KEY, "NODES": str(nodes)}, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
        self.assertEqual(manifest["grid"]["chosen"], "curvilinear")
        self.assertEqual(len(files(out, ".glb")), 5)

    def test_problems_are_told(self):
        http, out = f"http://{SERVICE.address}", self.folder("refused")
        for command, said in (
                ((sys.executable, EXAMPLES / "levels_http.py", http, SURVEY, "2", "1", out), "invalid_argument"),
                ((sys.executable, EXAMPLES / "levels_grpc.py", SERVICE.grpc_address, SURVEY, "2", "1", out), "INVALID_ARGUMENT")):
            done = run(*command)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)
            self.assertNotIn("Traceback", done.stderr)
        self.assertNotEqual(run(EXAMPLES / "levels.sh", http, SURVEY, "2", "1", out).returncode, 0)
        self.assertNotEqual(run(EXAMPLES / "levels.sh", http, SURVEY, "0.5", "null", out, key="none").returncode, 0)


if __name__ == "__main__":
    unittest.main()
