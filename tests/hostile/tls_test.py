"""The door behind TLS: the same answers, old protocols refused, handshakes that take their time cut off.

Environment: GEOSIS = the built binary.
"""
import http.client
import json
import shutil
import ssl
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from hostile import connect, converse, read_all, start, statuses
from certificates import Certificates  # of the contract's tests

PATIENCE = 1  # second
SIDE = 700  # samples of a slice's side: 2 MB a slice


def setUpModule():
    global FOLDER, SERVICE, CERTIFICATE, KEY
    FOLDER = Path(tempfile.mkdtemp(prefix="geosis-tls-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    CERTIFICATE, KEY = Certificates(FOLDER).own("server")
    flags = ("--tls-cert", str(CERTIFICATE), "--tls-key", str(KEY))
    SERVICE = unittest.enterModuleContext(start(FOLDER, *flags, patience=PATIENCE))


def client_context():
    return ssl.create_default_context(cafile=CERTIFICATE)


def secure(context=None, **options):
    host = SERVICE.address.rsplit(":", 1)[0]
    return (context or client_context()).wrap_socket(connect(SERVICE.address, **options), server_hostname=host)


def call(method, target, body=None, headers=None):
    connection = http.client.HTTPSConnection(SERVICE.address, timeout=30, context=client_context())
    try:
        connection.request(method, target, body=body, headers=headers or {})
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


class Tls(unittest.TestCase):
    def test_answers_are_the_same(self):
        samples = bytes(n % 251 for n in range(SIDE * 2)) * SIDE
        status, said = call("POST", f"/v1/volumes?format=raw&dims={SIDE},{SIDE},2&dtype=uint8", samples)
        self.assertEqual(status, 201, said[:300])
        volume = json.loads(said)["id"]
        status, said = call("GET", f"/v1/volumes/{volume}/slices/sample/1?format=f32")
        self.assertEqual((status, len(said)), (200, SIDE * SIDE * 4))
        status, said = call("POST", f"/v1/volumes/{volume}/extractions", b'{"range": [300, 400]}', {"Prefer": "wait=60"})
        self.assertEqual(json.loads(said)["state"], "done")
        chunks = (samples[n:n + 10_000] for n in range(0, len(samples), 10_000))
        status, said = call("POST", f"/v1/volumes?format=raw&dims={SIDE},{SIDE},2&dtype=uint8", chunks)
        self.assertEqual((status, json.loads(said)["id"]), (200, volume))

    def test_curl_trusts_it(self):
        said = subprocess.run(["curl", "-sS", "--fail", "--cacert", CERTIFICATE, f"https://{SERVICE.address}/livez"],
                              capture_output=True, text=True, check=True)
        self.assertEqual(said.stdout, "ok\n")

    def test_pipelined_requests_keep_their_order(self):
        with secure() as client:
            client.sendall(b"GET /livez HTTP/1.1\r\nHost: a\r\n\r\n" * 20 +
                           b"GET /nothing HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
            self.assertEqual(statuses(read_all(client)), [200] * 20 + [404])

    def test_only_versions_from_1_2_on_are_spoken(self):
        for version, name in ((ssl.TLSVersion.TLSv1_2, "TLSv1.2"), (ssl.TLSVersion.TLSv1_3, "TLSv1.3")):
            context = client_context()
            context.minimum_version = context.maximum_version = version
            with secure(context) as client:
                self.assertEqual(client.version(), name)
        said = subprocess.run(["openssl", "s_client", "-connect", SERVICE.address, "-tls1_1", "-cipher", "ALL:@SECLEVEL=0"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=20)
        self.assertNotEqual(said.returncode, 0)
        self.assertIn("alert protocol version", said.stderr)

    def test_http_2_is_not_promised(self):
        context = client_context()
        context.set_alpn_protocols(["h2", "http/1.1"])
        with secure(context) as client:
            self.assertEqual(client.selected_alpn_protocol(), "http/1.1")
        context.set_alpn_protocols(["h2"])
        with self.assertRaises(ssl.SSLError):
            secure(context)

    def test_what_is_no_handshake_is_cut_off(self):
        for said in (b"GET /livez HTTP/1.1\r\nHost: a\r\n\r\n", b"\x16\x03\x01\xff\xff" + bytes(70_000), bytes(1000)):
            self.assertNotIn(b"HTTP", converse(SERVICE.address, said, half_close=True))

    def test_slow_handshakes_are_cut_off(self):
        greeting = bytearray()
        incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        try:
            client_context().wrap_bio(incoming, outgoing, server_hostname="127.0.0.1").do_handshake()
        except ssl.SSLWantReadError:
            greeting += outgoing.read()
        clients = [connect(SERVICE.address) for _ in range(200)]
        begin = time.monotonic()
        for sent, client in enumerate(clients):
            client.sendall(greeting[:sent % len(greeting)])
        self.assertEqual(call("GET", "/livez")[0], 200)
        for client in clients:
            read_all(client)
            client.close()
        self.assertLess(time.monotonic() - begin, PATIENCE + 3)

    def test_a_slow_reader_is_dropped_and_harms_nobody(self):
        status, said = call("POST", f"/v1/volumes?format=raw&dims={SIDE},{SIDE},3&dtype=uint8", bytes(SIDE * SIDE * 3))
        volume = json.loads(said)["id"]
        with secure(receive_bytes=4096) as client:
            client.sendall(f"GET /v1/volumes/{volume}/slices/sample/0?format=f32 HTTP/1.1\r\nHost: a\r\n\r\n".encode())
            time.sleep(0.2)
            self.assertEqual(call("GET", "/livez")[0], 200)
            time.sleep(2 * PATIENCE + 0.5)
            received = 0
            with self.assertRaises(OSError):
                while piece := client.recv(1 << 16):
                    received += len(piece)
                raise OSError("ended")
            self.assertLess(received, SIDE * SIDE * 4)

    def test_another_certificates_key_is_refused(self):
        _, other = Certificates(FOLDER).own("other")
        for certificate, key in ((CERTIFICATE, other), (FOLDER / "absent.pem", KEY), (KEY, KEY)):
            said = subprocess.run([SERVICE.process.args[0], "serve", "--listen", "127.0.0.1:0", "--grpc", "off", "--store", FOLDER / "store",
                                   "--tls-cert", certificate, "--tls-key", key], capture_output=True, text=True, timeout=20)
            self.assertNotEqual(said.returncode, 0)
            self.assertIn("TLS", said.stderr)


if __name__ == "__main__":
    unittest.main()
