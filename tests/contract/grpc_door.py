"""The gRPC door as plain calls: documents in, documents out, Refused for a problem. Messages become the documents that HTTP
answers with, by a walk of this test's own."""
import hashlib
import math

import grpc
from geosis.v1 import extraction_pb2, extraction_pb2_grpc, grid_pb2, grid_pb2_grpc, volume_pb2, volume_pb2_grpc
from google.protobuf import descriptor, timestamp_pb2
import google_rpc_pb2

from refused import Refused

CHUNK = 256 * 1024
LISTS = {"Range", "NodeInterval", "Node", "Dims", "Point", "Box", "ValueRange"}  # lists of numbers in documents


def document_of(message):
    """What a message says, as a document: every field, those that are not set as None."""
    if isinstance(message, timestamp_pb2.Timestamp):
        return message.ToJsonString()
    values = {field.name: _value(message, field) for field in message.DESCRIPTOR.fields}
    return list(values.values()) if message.DESCRIPTOR.name in LISTS else values


def _value(message, field):
    value = getattr(message, field.name)
    if field.label == descriptor.FieldDescriptor.LABEL_REPEATED:
        return [_one(element, field) for element in value]
    if field.has_presence and not message.HasField(field.name):
        return None
    return _one(value, field)


def _one(value, field):
    if field.message_type:
        return document_of(value)
    if field.enum_type:
        return field.enum_type.values_by_number[value].name.rsplit("_", 1)[1].lower()
    return None if field.name == "error_cap" and math.isinf(value) else value


def message_of(kind, document):
    """A message from a request document; null ends and caps as the contract writes them."""
    message = kind()
    names = [field.name for field in kind.DESCRIPTOR.fields]
    members = zip(names, document) if isinstance(document, list) else document.items()
    for name, value in members:
        field = kind.DESCRIPTOR.fields_by_name[name]
        if name == "error_cap" and value is None:
            message.error_cap = math.inf
        elif value is None:
            continue
        elif field.label == descriptor.FieldDescriptor.LABEL_REPEATED:
            elements = [message_of(field.message_type._concrete_class, one) for one in value] if field.message_type else value
            getattr(message, name).extend(elements)
        elif field.message_type:
            getattr(message, name).CopyFrom(message_of(field.message_type._concrete_class, value))
            getattr(message, name).SetInParent()
        else:
            setattr(message, name, value)
    return message


def problem_of(error):
    """Refused from a failed call, with what its status details say."""
    metadata = {key: value for key, value in error.trailing_metadata() or ()}
    status = google_rpc_pb2.Status.FromString(metadata["grpc-status-details-bin"])
    assert status.code == error.code().value[0], (status, error)
    details = {detail.type_url.rsplit("/", 1)[1]: detail.value for detail in status.details}
    problem = document_of(volume_pb2.Problem.FromString(details["geosis.v1.Problem"]))
    info = google_rpc_pb2.ErrorInfo.FromString(details["google.rpc.ErrorInfo"])
    assert (info.reason, info.domain) == (problem["code"].upper(), "geosis"), info
    if problem["pointer"]:
        bad = google_rpc_pb2.BadRequest.FromString(details["google.rpc.BadRequest"])
        assert [v.field for v in bad.field_violations] == [problem["pointer"]], bad
    retry = details.get("google.rpc.RetryInfo")
    seconds = retry and google_rpc_pb2.RetryInfo.FromString(retry).retry_delay.seconds
    return Refused(problem, error.code().name, seconds)


def refusing(call):
    def judged(*arguments, **named):
        try:
            return call(*arguments, **named)
        except grpc.RpcError as error:
            raise problem_of(error) from error
    return judged


class GrpcDoor:
    name = "grpc"

    def __init__(self, address, key, credentials=None, **channel):
        self.channel = (grpc.secure_channel(address, credentials, **channel) if credentials else
                        grpc.insecure_channel(address, **channel))
        self.volume_stub = volume_pb2_grpc.VolumeServiceStub(self.channel)
        self.extraction_stub = extraction_pb2_grpc.ExtractionServiceStub(self.channel)
        self.grid_stub = grid_pb2_grpc.GridServiceStub(self.channel)
        self._metadata = (("authorization", f"Bearer {key}"),) if key else ()

    def _call(self, method, request, **options):
        return method(request, metadata=self._metadata, timeout=120, **options)

    @staticmethod
    def _upload(data, kind, options):
        yield kind(options=options)
        for start in range(0, len(data), CHUNK):
            yield kind(chunk=data[start:start + CHUNK])

    def _uploaded(self, data, **options):
        stated = volume_pb2.UploadOptions(**options)
        return self._call(self.volume_stub.UploadVolume, self._upload(data, volume_pb2.UploadVolumeRequest, stated))

    @refusing
    def upload(self, data, options=None, name="", sha256=None):
        answer = self._uploaded(data, name=name, sha256=sha256 or b"", bytes=len(data),
                                **{"import": message_of(volume_pb2.ImportOptions, options or {})})
        return document_of(answer.volume), answer.is_new

    @refusing
    def upload_for_later(self, data, options=None):
        answer = self._uploaded(data, respond_async=True,
                                **{"import": message_of(volume_pb2.ImportOptions, options or {})})
        return document_of(answer.volume)

    @refusing
    def volume(self, volume):
        return document_of(self._call(self.volume_stub.GetVolume, volume_pb2.GetVolumeRequest(id=volume)))

    @refusing
    def volumes(self, page_size=None, page_token=""):
        request = volume_pb2.ListVolumesRequest(page_size=page_size or 0, page_token=page_token)
        return document_of(self._call(self.volume_stub.ListVolumes, request))

    @refusing
    def remove(self, volume):
        self._call(self.volume_stub.DeleteVolume, volume_pb2.DeleteVolumeRequest(id=volume))

    @refusing
    def histogram(self, volume, bins=None):
        request = volume_pb2.GetHistogramRequest(id=volume, bins=bins or 0)
        return document_of(self._call(self.volume_stub.GetHistogram, request))

    @refusing
    def upload_grid(self, volume, data, options=None, sha256=None):
        stated = grid_pb2.UploadGridOptions(volume=volume, sha256=sha256 or b"", bytes=len(data), **(options or {}))
        reply = self._call(self.grid_stub.UploadGrid, self._upload(data, grid_pb2.UploadGridRequest, stated))
        return document_of(reply.grid), reply.is_new

    @refusing
    def create_grid(self, volume, coordinates):
        request = grid_pb2.CreateGridRequest(volume=volume, coordinates=grid_pb2.Coordinates(**coordinates))
        reply = self._call(self.grid_stub.CreateGrid, request)
        return document_of(reply.grid), reply.is_new

    @refusing
    def grids(self, volume, page_size=None, page_token=""):
        request = grid_pb2.ListGridsRequest(volume=volume, page_size=page_size or 0, page_token=page_token)
        return document_of(self._call(self.grid_stub.ListGrids, request))

    @refusing
    def grid(self, volume, grid):
        return document_of(self._call(self.grid_stub.GetGrid, grid_pb2.GetGridRequest(volume=volume, id=grid)))

    @refusing
    def remove_grid(self, volume, grid):
        self._call(self.grid_stub.DeleteGrid, grid_pb2.DeleteGridRequest(volume=volume, id=grid))

    @refusing
    def create(self, volume, request, priority="interactive"):
        asked = extraction_pb2.CreateExtractionRequest(
            volume=volume, request=message_of(extraction_pb2.Request, request),
            priority=extraction_pb2.Priority.Value(f"PRIORITY_{priority.upper()}"))
        return document_of(self._call(self.extraction_stub.CreateExtraction, asked))

    @refusing
    def extraction(self, extraction):
        request = extraction_pb2.GetExtractionRequest(id=extraction)
        return document_of(self._call(self.extraction_stub.GetExtraction, request))

    @refusing
    def watch(self, extraction, after=0):
        """[(id, kind, data)], until it ends."""
        request = extraction_pb2.WatchExtractionRequest(id=extraction, after_event=after)
        return [(event.id, event.WhichOneof("event"), document_of(getattr(event, event.WhichOneof("event"))))
                for event in self._call(self.extraction_stub.WatchExtraction, request)]

    @staticmethod
    def _levels(chunks):
        """[(level, part, parts, preview, SHA-256)] and the manifest."""
        parts, manifest, data = [], None, b""
        for chunk in chunks:
            assert manifest is None, "something follows the manifest"
            if chunk.WhichOneof("content") == "manifest":
                manifest = document_of(chunk.manifest)
                continue
            part = chunk.part
            assert 0 < len(part.data) <= CHUNK, len(part.data)
            data += part.data
            if part.is_last:
                assert part.bytes == len(data), (part.bytes, len(data))
                parts.append((part.level, part.part, part.parts, part.preview, hashlib.sha256(data).hexdigest()))
                data = b""
        assert data == b"", "the last part is not whole"
        return parts, manifest

    @refusing
    def stream(self, extraction, **options):
        request = extraction_pb2.StreamLodsRequest(id=extraction, **options)
        return self._levels(self._call(self.extraction_stub.StreamLods, request))

    @refusing
    def bodies(self, extraction):
        request = extraction_pb2.ListBodiesRequest(id=extraction)
        return document_of(self._call(self.extraction_stub.ListBodies, request))

    @refusing
    def cancel(self, extraction, purge=False):
        self._call(self.extraction_stub.CancelExtraction, extraction_pb2.CancelExtractionRequest(id=extraction, purge=purge))

    @refusing
    def extract(self, data, low, high, options=None):
        stated = extraction_pb2.ExtractOptions(
            request=message_of(extraction_pb2.Request, {"range": [low, high]}),
            **{"import": message_of(volume_pb2.ImportOptions, options or {})})
        return self._levels(self._call(self.extraction_stub.Extract,
                                       self._upload(data, extraction_pb2.ExtractRequest, stated)))
