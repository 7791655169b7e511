"""Holds .ci/check_own_headers.py against a small tree with one violation of each kind."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).resolve().parents[2] / ".ci" / "check_own_headers.py"


def check(files):
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = Path(root) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        run = subprocess.run([sys.executable, CHECK, root], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout


class CheckOwnHeaders(unittest.TestCase):
    def test_accepts_own_header_first_and_sources_without_header(self):
        sound = {
            "engine/base/a.h": "#pragma once\n",
            "engine/base/a.cpp": '// why\n#include "engine/base/a.h"\n\n#include <vector>\n',
            "server/main.cpp": "#include <vector>\n",
            "engine/base/b.h": "// why\n#if defined(GEOSIS_B_H) == defined(HWY_TARGET_TOGGLE)\n",
        }
        self.assertEqual(check(sound), (0, ""))

    def test_finds_another_include_before_the_own_header(self):
        status, said = check({"engine/base/a.h": "#pragma once\n", "engine/base/a.cpp": "#include <vector>\n"})
        self.assertEqual((status, said), (1, "engine/base/a.cpp: includes vector before its own header\n"))

    def test_finds_a_header_without_guard(self):
        status, said = check({"server/app/a.h": "#include <vector>\n"})
        self.assertEqual((status, said), (1, "server/app/a.h: is not guarded\n"))


if __name__ == "__main__":
    unittest.main()
