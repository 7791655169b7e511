"""What a door says no with, and what api/README.md says of it."""
import re
from pathlib import Path

README = Path(__file__).resolve().parents[2] / "api" / "README.md"


class Refused(Exception):
    """A problem, and the status number that its door gave it."""

    def __init__(self, problem, status, retry_seconds=None):
        super().__init__(f"{status}: {problem}")
        self.code = problem["code"]
        self.detail = problem["detail"]
        self.pointer = problem.get("pointer") or None
        self.candidates = problem.get("candidates") or []
        self.status = status
        self.retry_seconds = retry_seconds


def error_table():
    """{code: (HTTP status, gRPC status)} of the contract."""
    rows = re.findall(r"^\| (\w+) \| (\d{3})[^|]* \| ([A-Z_]+) \|$", README.read_text(encoding="utf-8"), re.MULTILINE)
    return {code: (int(http), grpc) for code, http, grpc in rows}
