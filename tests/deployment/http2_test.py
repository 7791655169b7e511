"""Clients of HTTP/2 that mean harm, at the edge: others are served through both doors, and no memory grows.

Environment: GEOSIS = the built binary; NGINX; PYTHONPATH = the contract's messages as protoc makes them.
"""
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "contract"))

import grpc  # noqa: E402
from edge import Edge, need_nginx  # noqa: E402
from geosis.v1 import volume_pb2, volume_pb2_grpc  # noqa: E402
from http2_client import ATTACKS, repeat  # noqa: E402
from hostile import Service, memory_of  # noqa: E402

SECONDS = 0.6
CALL = "/geosis.v1.VolumeService/ListVolumes"
GROWTH = 48 << 20  # bytes that the edge's workers together, and the server, may hold more than before


class HarmfulHttp2(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        need_nginx()
        folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="geosis-http2-"))
        cls.service = cls.enterClassContext(Service(Path(folder) / "store", "--grpc", "127.0.0.1:0", "--admin", "", "--log-level", "error"))
        cls.edge = cls.enterClassContext(Edge(folder, cls.service.address, cls.service.grpc_address))

    def ask(self):
        """One question at each door, gRPC over a connection of its own."""
        self.assertEqual(self.edge.call("GET", "/version")[0], 200)
        options = [("grpc.use_local_subchannel_pool", 1)]
        with grpc.insecure_channel(self.edge.http2_address, options=options) as channel:
            volume_pb2_grpc.VolumeServiceStub(channel).ListVolumes(volume_pb2.ListVolumesRequest(), timeout=10)

    def test_others_are_served_and_memory_stays(self):
        for _ in range(5):
            self.ask()
        before = self.edge.worker_memory(), memory_of(self.service.process)
        for name, attack in ATTACKS.items():
            with self.subTest(name):
                attackers = [threading.Thread(target=repeat, args=(SECONDS, attack(self.edge.http2_address, CALL))) for _ in range(2)]
                for thread in attackers:
                    thread.start()
                served, most = 0, [0, 0]
                while any(thread.is_alive() for thread in attackers):
                    self.ask()
                    served += 1
                    grown = self.edge.worker_memory() - before[0], memory_of(self.service.process) - before[1]
                    most = [max(pair) for pair in zip(most, grown)]
                    time.sleep(0.01)  # its own share of requests is bounded too
                for thread in attackers:
                    thread.join()
                print(f"{name}: {served} served, edge {most[0] / 1e6:+.1f} MB, server {most[1] / 1e6:+.1f} MB")
                self.assertGreater(served, 0)
                self.assertLess(max(most), GROWTH)
        self.assertEqual([self.edge.process.poll(), self.service.process.poll()], [None, None])
        self.assertNotIn("[alert]", self.edge.errors())
        self.assertGreater(self.edge.log().count(CALL), 200, "nobody was attacked")


if __name__ == "__main__":
    unittest.main()
