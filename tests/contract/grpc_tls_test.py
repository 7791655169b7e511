"""The gRPC door behind TLS: the same answers, no plaintext, and clients that must show a certificate.

GEOSIS = the built binary; PYTHONPATH = the messages that protoc made of api/proto.
"""
import socket
import ssl
import subprocess
import tempfile
import time
import unittest
import urllib.request
from pathlib import Path

import grpc
from geosis.v1 import volume_pb2

from certificates import Certificates
from grpc_door import GrpcDoor
from service import GEOSIS, Service

SIDE = 24
SAMPLES = bytes((i - 12) ** 2 // 2 + (j - 12) ** 2 // 2 for i in range(SIDE) for j in range(SIDE) for _ in range(SIDE))
RAW = {"format": "raw", "dims": [SIDE, SIDE, SIDE], "dtype": "uint8"}


def setUpModule():
    global FOLDER, CERTIFICATES, SERVER, CLIENTS, OTHERS
    FOLDER = Path(unittest.enterModuleContext(tempfile.TemporaryDirectory(prefix="geosis-grpc-tls-")))
    CERTIFICATES = Certificates(FOLDER)
    SERVER, CLIENTS, OTHERS = (CERTIFICATES.own(name) for name in ("server", "clients", "others"))


def start(name, *flags):
    return Service(FOLDER / name, "--grpc", "127.0.0.1:0", "--admin", "", "--tls-cert", str(SERVER[0]), "--tls-key", str(SERVER[1]),
                   "--probe-seconds", "1", *flags)


def secure(address, authority=None, identity=None):
    """A door over a channel that believes the authority, the server's own certificate by default, and may show one."""
    certificate, key = (file.read_bytes() for file in identity) if identity else (None, None)
    believed = (authority or SERVER[0]).read_bytes()
    return GrpcDoor(address, None, credentials=grpc.ssl_channel_credentials(believed, key, certificate))


class WithDoor(unittest.TestCase):
    flags = ()

    @classmethod
    def setUpClass(cls):
        cls.service = cls.enterClassContext(start(cls.__name__, *cls.flags))

    def is_let_in(self, door):
        """Whether a call is answered, over a connection that is closed then."""
        with door.channel:
            try:
                door.volume_stub.ListVolumes(volume_pb2.ListVolumesRequest(), timeout=20)
                return True
            except grpc.RpcError as error:
                self.assertEqual(error.code(), grpc.StatusCode.UNAVAILABLE)
                return False


class Tls(WithDoor):
    def test_levels_come_as_by_https(self):
        door = secure(self.service.grpc_address)
        volume, _ = door.upload(SAMPLES, RAW)
        levels, manifest = door.stream(door.create(volume["id"], {"range": [40, None]})["id"])
        door.channel.close()
        self.assertEqual(len(levels), 5)
        url = f"https://{self.service.address}/v1/extractions/{manifest['id']}/manifest"
        with urllib.request.urlopen(url, context=ssl.create_default_context(cafile=SERVER[0])) as answer:
            self.assertIn(manifest["id"].encode(), answer.read())

    def test_plaintext_is_refused(self):
        self.assertFalse(self.is_let_in(GrpcDoor(self.service.grpc_address, None)))
        host, port = self.service.grpc_address.split(":")
        with socket.create_connection((host, int(port)), timeout=20) as client:
            client.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes((0, 0, 0, 4, 0, 0, 0, 0, 0)))
            said = b""
            while piece := client.recv(1 << 12):
                said += piece
        self.assertNotIn(said[3:4], (b"\4",), said)  # no SETTINGS
        self.assertLess(len(said), 100)

    def test_clients_that_believe_somebody_else_do_not_call(self):
        self.assertFalse(self.is_let_in(secure(self.service.grpc_address, OTHERS[0])))
        self.assertTrue(self.is_let_in(secure(self.service.grpc_address)))

    def test_http_2_over_tls_1_2_or_1_3_is_spoken(self):
        host, port = self.service.grpc_address.split(":")
        for version in (ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3):
            context = ssl.create_default_context(cafile=SERVER[0])
            context.minimum_version = context.maximum_version = version
            context.set_alpn_protocols(["h2"])
            with context.wrap_socket(socket.create_connection((host, int(port)), timeout=20), server_hostname=host) as client:
                self.assertEqual(client.selected_alpn_protocol(), "h2")
                client.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes((0, 0, 0, 4, 0, 0, 0, 0, 0)))
                self.assertEqual(client.recv(9)[3], 4)  # SETTINGS
        said = subprocess.run(["openssl", "s_client", "-connect", self.service.grpc_address, "-tls1_1", "-cipher", "ALL:@SECLEVEL=0"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=20)
        self.assertNotEqual(said.returncode, 0)


class ClientsThatAreKnown(WithDoor):
    @classmethod
    def setUpClass(cls):
        authorities = FOLDER / "authorities.pem"
        authorities.write_text(CLIENTS[0].read_text() + CERTIFICATES.own("further")[0].read_text())
        cls.flags = ("--grpc-client-ca", str(authorities))
        super().setUpClass()

    def test_a_certificate_of_the_authority_opens_the_door(self):
        known, unknown = CERTIFICATES.signed("known", CLIENTS), CERTIFICATES.signed("unknown", OTHERS)
        self.assertTrue(self.is_let_in(secure(self.service.grpc_address, identity=known)))
        self.assertFalse(self.is_let_in(secure(self.service.grpc_address)))
        self.assertFalse(self.is_let_in(secure(self.service.grpc_address, identity=unknown)))
        self.assertFalse(self.is_let_in(GrpcDoor(self.service.grpc_address, None)))
        # Its own questions were let in all the while, and HTTP asks nobody for a certificate.
        with urllib.request.urlopen(f"https://{self.service.address}/livez",
                                    context=ssl.create_default_context(cafile=SERVER[0])) as answer:
            self.assertEqual(answer.status, 200)


class Renewal(unittest.TestCase):
    def setUp(self):
        self.files = FOLDER / "renewed.pem", FOLDER / "renewed.key", FOLDER / "renewed-authorities.pem"
        self.renew(SERVER)
        self.trust(CLIENTS)

    def renew(self, certificate, key=None):
        """Each file in one step, as renewing programs do it."""
        for source, target in zip((certificate[0], key or certificate[1]), self.files):
            (FOLDER / "next").write_bytes(source.read_bytes())
            (FOLDER / "next").rename(target)

    def trust(self, authority):
        self.files[2].write_bytes(authority[0].read_bytes())

    def served(self, service):
        """The certificates that HTTP and gRPC show now."""
        return [ssl.get_server_certificate(address.split(":"), timeout=20) for address in (service.address, service.grpc_address)]

    def comes_true(self, question, seconds=20):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if question():
                return True
            time.sleep(0.2)
        return False

    def test_files_are_taken_while_both_doors_are_open(self):
        other, first = CERTIFICATES.own("other-server"), SERVER[0].read_text()
        flags = ("--grpc-client-ca", str(self.files[2]))
        with Service(FOLDER / "renewal", "--grpc", "127.0.0.1:0", "--admin", "", "--tls-cert", str(self.files[0]), "--tls-key",
                     str(self.files[1]), "--probe-seconds", "1", *flags) as service:
            self.assertEqual(self.served(service), [first, first])
            # Half of a renewal is not taken, even if it stays so.
            self.renew(other, key=SERVER[1])
            time.sleep(7)
            self.assertEqual(self.served(service), [first, first])
            self.renew(other)
            second = other[0].read_text()
            self.assertTrue(self.comes_true(lambda: self.served(service) == [second, second]))

            known = CERTIFICATES.signed("later-known", OTHERS)
            def is_known():
                door = secure(service.grpc_address, other[0], known)
                with door.channel:
                    try:
                        return door.volume_stub.ListVolumes(volume_pb2.ListVolumesRequest(), timeout=5) is not None
                    except grpc.RpcError:
                        return False
            self.assertFalse(is_known())
            self.trust(OTHERS)
            self.assertTrue(self.comes_true(is_known))
            # The door's own questions were answered all the while.
            with urllib.request.urlopen(f"https://{service.address}/livez", context=ssl.create_default_context(cafile=other[0])) as answer:
                self.assertEqual(answer.status, 200)


class Refusals(unittest.TestCase):
    def test_what_is_no_certificate_is_refused_at_the_start(self):
        (FOLDER / "text.pem").write_text("nobody\n")
        (FOLDER / "cut.pem").write_text(CLIENTS[0].read_text() + CLIENTS[0].read_text()[:200])
        tls = ("--tls-cert", SERVER[0], "--tls-key", SERVER[1])
        for flags, status in (((*tls, "--grpc-client-ca", FOLDER / "absent.pem"), 1), ((*tls, "--grpc-client-ca", FOLDER / "text.pem"), 1),
                              ((*tls, "--grpc-client-ca", FOLDER / "cut.pem"), 1), (("--grpc-client-ca", CLIENTS[0]), 2)):
            refused = subprocess.run([GEOSIS, "serve", "--listen", "127.0.0.1:0", "--grpc", "127.0.0.1:0", "--admin", "", "--store",
                                      FOLDER / "refused", *flags], capture_output=True, text=True, timeout=60)
            self.assertEqual((refused.returncode, refused.stdout), (status, ""), refused.stderr)
            self.assertRegex(refused.stderr, r"\.pem|--tls-cert")


class Probe(unittest.TestCase):
    """`geosis probe https://...` believes the system's authorities, those of a file, or everybody."""

    def probe(self, address, *flags):
        asked = subprocess.run([GEOSIS, "probe", f"https://{address}/livez", "--timeout-seconds", "2", *map(str, flags)],
                               capture_output=True, text=True, timeout=60)
        return asked.returncode, asked.stderr

    def test_certificates_are_judged_unless_it_is_told_not_to(self):
        with start("probe") as service:
            self.assertEqual(self.probe(service.address, "--ca", SERVER[0]), (0, ""))
            self.assertEqual(self.probe(service.address, "--any-certificate"), (0, ""))
            for flags, said in (((), "self-signed"), (("--ca", OTHERS[0]), "self-signed"), (("--ca", SERVER[1]), "no certificates")):
                status, why = self.probe(service.address, *flags)
                self.assertEqual((status, said in why), (1, True), (flags, why))
            # The certificate is for 127.0.0.1 alone.
            status, why = self.probe(service.address.replace("127.0.0.1", "localhost"), "--ca", SERVER[0])
            self.assertEqual((status, "ostname mismatch" in why), (1, True), why)
            asked = subprocess.run([GEOSIS, "probe", f"https://{service.address}/nothing", "--ca", SERVER[0]], capture_output=True,
                                   text=True, timeout=60)
            self.assertEqual((asked.returncode, "HTTP/1.1 404" in asked.stderr), (1, True), asked.stderr)

    def test_what_speaks_no_tls_is_not_well(self):
        with Service(FOLDER / "plain", "--admin", "") as service:
            self.assertEqual(self.probe(service.address, "--any-certificate")[0], 1)
        with socket.create_server(("127.0.0.1", 0)) as silent:
            self.assertEqual(self.probe(f"127.0.0.1:{silent.getsockname()[1]}", "--any-certificate")[0], 1)


if __name__ == "__main__":
    unittest.main()
