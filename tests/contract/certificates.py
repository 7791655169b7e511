"""Certificates as openssl makes them, in a folder that is thrown away."""
import subprocess
from pathlib import Path


class Certificates:
    """(certificate, key), paths of files in PEM, by name."""

    def __init__(self, folder):
        self._folder = Path(folder)

    def _make(self, name, *more):
        certificate, key = self._folder / f"{name}.pem", self._folder / f"{name}.key"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                        "-subj", f"/CN={name}", "-keyout", key, "-out", certificate, *more], check=True, stderr=subprocess.DEVNULL)
        return certificate, key

    def own(self, name, addresses="IP:127.0.0.1"):
        """One that signed itself, for these addresses."""
        return self._make(name, "-addext", f"subjectAltName={addresses}")

    def signed(self, name, authority, addresses="IP:127.0.0.1"):
        certificate, key = authority
        return self._make(name, "-CA", certificate, "-CAkey", key, "-addext", "basicConstraints=critical,CA:false", "-addext",
                          f"subjectAltName={addresses}")
