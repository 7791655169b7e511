#!/usr/bin/env python3
"""Uploads a survey, asks for the body of a range, and writes its levels as they come, over gRPC.

    protoc -I../proto --python_out=. --grpc_python_out=. --plugin=protoc-gen-grpc_python=$(command -v grpc_python_plugin) \
        ../proto/geosis/v1/volume.proto ../proto/geosis/v1/extraction.proto
    ./levels_grpc.py 127.0.0.1:8081 survey.sgy 0.5 inf levels

Debian: apt install protobuf-compiler protobuf-compiler-grpc python3-grpcio python3-protobuf. A server with keys: KEY=... ./levels_grpc.py ...
"""
import math
import os
import sys
from pathlib import Path

import grpc
from geosis.v1 import extraction_pb2, extraction_pb2_grpc, volume_pb2, volume_pb2_grpc
from google.protobuf import json_format

CHUNK = 256 * 1024
METADATA = [("authorization", "Bearer " + os.environ["KEY"])] if "KEY" in os.environ else []


def upload_requests(path):
    """The options, then the file in chunks."""
    yield volume_pb2.UploadVolumeRequest(
        options=volume_pb2.UploadOptions(name=path.name, bytes=path.stat().st_size))
    with open(path, "rb") as survey:
        while chunk := survey.read(CHUNK):
            yield volume_pb2.UploadVolumeRequest(chunk=chunk)


def range_of(low, high):
    """An end that is not set is open."""
    ends = {"low": low, "high": high}
    return extraction_pb2.Range(**{name: end for name, end in ends.items() if not math.isinf(end)})


def write_levels(chunks, out):
    """Writes each part when its last chunk is here, and at last the manifest."""
    data = bytearray()
    for chunk in chunks:
        if chunk.WhichOneof("content") == "manifest":
            text = json_format.MessageToJson(chunk.manifest, preserving_proto_field_name=True)
            (out / "manifest.json").write_text(text, encoding="utf-8")
            continue
        data += chunk.part.data
        if chunk.part.is_last:
            (out / f"lod{chunk.part.level}.{chunk.part.part}.drc").write_bytes(data)
            print(f"level {chunk.part.level} part {chunk.part.part}: {len(data)} bytes")
            data.clear()


def main():
    server, survey, low, high, out = sys.argv[1], Path(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4]), Path(sys.argv[5])
    out.mkdir(parents=True, exist_ok=True)
    with grpc.insecure_channel(server) as channel:
        volumes = volume_pb2_grpc.VolumeServiceStub(channel)
        extractions = extraction_pb2_grpc.ExtractionServiceStub(channel)
        try:
            volume = volumes.UploadVolume(upload_requests(survey), metadata=METADATA).volume
            print("volume", volume.id)
            request = extraction_pb2.Request(range=range_of(low, high))
            extraction = extractions.CreateExtraction(
                extraction_pb2.CreateExtractionRequest(volume=volume.id, request=request), metadata=METADATA)
            write_levels(extractions.StreamLods(extraction_pb2.StreamLodsRequest(id=extraction.id), metadata=METADATA), out)
        except grpc.RpcError as error:
            sys.exit(f"{error.code().name}: {error.details()}")


if __name__ == "__main__":
    main()
