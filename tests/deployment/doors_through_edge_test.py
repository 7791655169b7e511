"""The scenarios of the contract once more, with the edge between: same ids, same bytes, same error codes through both doors.

Environment: GEOSIS = the built binary; NGINX; PYTHONPATH = the contract's messages as protoc makes them.
"""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "contract"))

import doors_test  # noqa: E402
import grpc  # noqa: E402
from doors_test import BothDoors  # noqa: E402,F401  (its tests)
from edge import Edge, need_nginx  # noqa: E402
from geosis.v1 import volume_pb2, volume_pb2_grpc  # noqa: E402


class Through:
    """A service whose addresses are those of the edge before it."""

    def __init__(self, service, edge):
        self._service, self.address, self.grpc_address = service, edge.address, edge.http2_address

    def __getattr__(self, name):
        return getattr(self._service, name)


class Between:
    """What doors_test starts, and an edge before it; a context manager."""

    def __init__(self, *arguments, **named):
        self._service = Service(*arguments, **named)

    def __enter__(self):
        service = self._service.__enter__()
        self._folder = tempfile.TemporaryDirectory(prefix="geosis-edge-")
        self._edge = Edge(self._folder.name, service.address, service.grpc_address, rate="10000r/s")
        return Through(service, self._edge.__enter__())

    def __exit__(self, *problem):
        self._edge.__exit__()
        self._folder.cleanup()
        self._service.__exit__(*problem)


Service = doors_test.Service
doors_test.Service = Between


def setUpModule():
    need_nginx()
    doors_test.setUpModule()


class WithoutServers(unittest.TestCase):
    def test_a_call_is_told_that_it_may_be_tried_again(self):
        with tempfile.TemporaryDirectory() as folder, Edge(folder, "127.0.0.1:9", "127.0.0.1:9") as edge:
            with grpc.insecure_channel(edge.http2_address) as channel, self.assertRaises(grpc.RpcError) as refused:
                volume_pb2_grpc.VolumeServiceStub(channel).ListVolumes(volume_pb2.ListVolumesRequest(), timeout=20)
            self.assertEqual(refused.exception.code(), grpc.StatusCode.UNAVAILABLE)
            self.assertIn("no server answers", refused.exception.details())


if __name__ == "__main__":
    unittest.main()
