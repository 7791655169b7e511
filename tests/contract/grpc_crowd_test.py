"""Clients of the gRPC door who do nothing wrong and much at a time: none of them is taken for a flood.

GEOSIS = the built binary; PYTHONPATH = the messages that protoc made of api/proto.
"""
import tempfile
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import grpc
from geosis.v1 import volume_pb2

from grpc_door import GrpcDoor, message_of
from service import Service

LARGEST = (4 << 20) - 64  # bytes of a chunk whose message may just be sent
SIDE = 2048
SAMPLES = bytes(range(256)) * (2 * SIDE * SIDE // 256)
RAW = message_of(volume_pb2.ImportOptions, {"format": "raw", "dims": [2, SIDE, SIDE], "dtype": "uint8"})
SENDING = [("grpc.max_send_message_length", -1)]


def pieces(data, size=LARGEST, pause=0.0, begun=None):
    yield volume_pb2.UploadVolumeRequest(options=volume_pb2.UploadOptions(**{"import": RAW}))
    for start in range(0, len(data), size):
        yield volume_pb2.UploadVolumeRequest(chunk=data[start:start + size])
        if begun:
            begun.set()
        time.sleep(pause)


class Crowd(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.service = self.enterContext(Service(Path(folder) / "store", "--grpc", "127.0.0.1:0", "--admin", "", "--log-level", "error"))
        self.door = self.new_door()

    def new_door(self):
        door = GrpcDoor(self.service.grpc_address, None, options=[*SENDING, ("grpc.use_local_subchannel_pool", 1)])
        self.addCleanup(door.channel.close)
        return door

    def upload(self, number, door=None, **how):
        data = bytes((number,)) + SAMPLES[1:]  # each another volume
        return (door or self.door).volume_stub.UploadVolume(pieces(data, **how), timeout=100).volume.id

    def test_uploads_side_by_side_in_one_connection(self):
        with ThreadPoolExecutor(20) as crowd:
            self.assertEqual(len(set(crowd.map(self.upload, range(20)))), 20)

    def test_uploads_that_are_taken_back_leave_others_alone(self):
        """Half a megabyte at a time for some seconds, beside three that end in the middle of a message, again and again."""
        with ThreadPoolExecutor(1) as beside:
            steady = beside.submit(self.upload, 0, size=1 << 19, pause=0.25)
            for _ in range(8):
                begun = [threading.Event() for _ in range(3)]
                calls = [self.door.volume_stub.UploadVolume.future(pieces(SAMPLES, begun=event)) for event in begun]
                for event in begun:
                    self.assertTrue(event.wait(20))
                for call in calls:
                    call.cancel()
                time.sleep(0.1)
            self.assertEqual(len(steady.result()), 64)

    def test_a_message_that_is_too_large_is_answered_and_leaves_others_alone(self):
        with ThreadPoolExecutor(1) as beside:
            steady = beside.submit(self.upload, 0, size=1 << 19, pause=0.1)
            for size in (5 << 20, 8 << 20):
                with self.assertRaises(grpc.RpcError) as refused:
                    self.upload(1, size=size)
                self.assertEqual(refused.exception.code(), grpc.StatusCode.RESOURCE_EXHAUSTED)
            self.assertEqual(len(steady.result()), 64)

    def test_others_come_in_while_many_have_sent_and_wait(self):
        waiting, doors = threading.Event(), [self.new_door() for _ in range(20)]
        half = [threading.Event() for _ in doors]

        def unfinished(event):
            yield from pieces(SAMPLES[:3 << 20], begun=event)
            waiting.wait(60)

        calls = [door.volume_stub.UploadVolume.future(unfinished(event)) for door, event in zip(doors, half)]
        for event in half:
            self.assertTrue(event.wait(30))
        time.sleep(0.5)
        start = time.monotonic()
        self.new_door().volume_stub.ListVolumes(volume_pb2.ListVolumesRequest(), timeout=20)
        self.assertLess(time.monotonic() - start, 5)
        for call in calls:
            call.cancel()
        waiting.set()


if __name__ == "__main__":
    unittest.main()
