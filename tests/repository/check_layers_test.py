"""Plants one violation of each kind in a small tree and expects .ci/check_layers.py to name it, and nothing else."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECKER = Path(__file__).resolve().parents[2] / ".ci" / "check_layers.py"
LAYERS = """
engine/base:
engine/mesh: engine/base
server/cli:  engine/mesh engine/base
tests:       *
engine excludes nlohmann
"""
SOUND_TREE = {
    ".ci/layers.txt": LAYERS,
    "engine/base/result.h": "#include <string>\n",
    "engine/mesh/mesh.h": '#include "engine/base/result.h"\n#include "engine/mesh/corner.h"\n',
    "engine/mesh/corner.h": "// see #include <nlohmann/json.hpp>\n",
    "engine/mesh/CMakeLists.txt": "geosis_room(mesh SOURCES mesh.cpp ROOMS base LIBRARIES draco)\n",
    "server/cli/cli.cpp": '#include <nlohmann/json.hpp>\n#include "engine/mesh/mesh.h"\n',
    "tests/mesh_test.cpp": '#include "server/cli/cli.h"\n#include "tests/support.h"\n',
    "server/cli/cli.h": "",
    "tests/support.h": "",
}


def problems_with(**changed):
    """Lines the checker prints for the sound tree with these files changed, and its exit status."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in {**SOUND_TREE, **changed.get("files", {})}.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        run = subprocess.run([sys.executable, CHECKER, folder], capture_output=True, text=True, check=False)
        assert not run.stderr, run.stderr
        return run.stdout.splitlines(), run.returncode


class CheckLayers(unittest.TestCase):
    def expect(self, files, problem):
        self.assertEqual(problems_with(files=files), ([problem], 1))

    def test_accepts_a_sound_tree(self):
        self.assertEqual(problems_with(), ([], 0))

    def test_refuses_an_upward_include(self):
        self.expect({"engine/base/result.h": '#include "engine/mesh/mesh.h"\n'},
                    'engine/base/result.h: engine/base must not include "engine/mesh/mesh.h"')

    def test_refuses_tests_in_the_product(self):
        self.expect({"server/cli/cli.h": '#include "tests/support.h"\n'},
                    'server/cli/cli.h: server/cli must not include "tests/support.h"')

    def test_refuses_another_include_root(self):
        self.expect({"engine/mesh/corner.h": '#include "mesh.h"\n'},
                    'engine/mesh/corner.h: "mesh.h" is no file below the repository root, the only include root')

    def test_refuses_our_headers_in_angle_brackets(self):
        self.expect({"engine/mesh/corner.h": "#include <engine/base/result.h>\n"},
                    "engine/mesh/corner.h: <engine/base/result.h> is ours: include it in quotes")

    def test_refuses_json_in_the_engine(self):
        self.expect({"engine/mesh/corner.h": "#include <nlohmann/json.hpp>\n"},
                    "engine/mesh/corner.h: must not include <nlohmann/json.hpp>")

    def test_refuses_a_file_outside_every_room(self):
        self.expect({"engine/stray.h": ""}, "engine/stray.h: in no room of .ci/layers.txt")

    def test_refuses_an_upward_link(self):
        self.expect({"engine/base/CMakeLists.txt": "geosis_room(base\n  SOURCES a.cpp\n  ROOMS mesh)\n"},
                    "engine/base/CMakeLists.txt: base must not link mesh")

    def test_refuses_rooms_in_a_circle(self):
        lines, status = problems_with(files={".ci/layers.txt": LAYERS.replace("engine/base:", "engine/base: engine/mesh")})
        self.assertEqual(status, 1)
        self.assertIn("engine/base names engine/mesh, which is not written above it", lines[0])


if __name__ == "__main__":
    unittest.main()
