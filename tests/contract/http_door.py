"""The HTTP door as plain calls: documents in, documents out, Refused for a problem."""
import base64
import hashlib
import json
import urllib.parse

from contract import Contract
from refused import Refused
from service import Client


class HttpDoor:
    name = "http"

    def __init__(self, address, key):
        self._client = Client(address, Contract())
        self._headers = {"Authorization": f"Bearer {key}"} if key else {}

    def _call(self, method, target, body=None, **headers):
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        answer = self._client.call(method, target, body, {**self._headers, **named})
        if answer.status >= 400:
            wait = answer.headers.get("retry-after")
            raise Refused(answer.json(), answer.status, wait and int(wait))
        return answer

    def _json(self, method, target, document):
        return self._call(method, target, json.dumps(document), Content_Type="application/json").json()

    @staticmethod
    def _query(options):
        texts = {name: ",".join(map(str, value)) if isinstance(value, list) else value for name, value in options.items()}
        return urllib.parse.urlencode(texts)

    def upload(self, data, options=None, name="", sha256=None):
        digest = {"Content_Digest": f"sha-256=:{base64.b64encode(sha256).decode()}:"} if sha256 else {}
        answer = self._call("POST", f"/v1/volumes?{self._query({**(options or {}), 'name': name})}", data,
                            Content_Type="application/octet-stream", **digest)
        return answer.json(), answer.status == 201

    def upload_for_later(self, data, options=None):
        return self._call("POST", f"/v1/volumes?{self._query(options or {})}", data,
                          Content_Type="application/octet-stream", Prefer="respond-async").json()

    def volume(self, volume):
        return self._call("GET", f"/v1/volumes/{volume}").json()

    def volumes(self, page_size=None, page_token=""):
        size = {} if page_size is None else {"page_size": page_size}
        return self._call("GET", f"/v1/volumes?{self._query({**size, 'page_token': page_token})}").json()

    def remove(self, volume):
        self._call("DELETE", f"/v1/volumes/{volume}")

    def histogram(self, volume, bins=None):
        return self._call("GET", f"/v1/volumes/{volume}/histogram" + ("" if bins is None else f"?bins={bins}")).json()

    def upload_grid(self, volume, data, options=None, sha256=None):
        digest = {"Content_Digest": f"sha-256=:{base64.b64encode(sha256).decode()}:"} if sha256 else {}
        answer = self._call("POST", f"/v1/volumes/{volume}/grids?{self._query(options or {})}", data,
                            Content_Type="application/octet-stream", **digest)
        return answer.json(), answer.status == 201

    def create_grid(self, volume, coordinates):
        answer = self._call("POST", f"/v1/volumes/{volume}/grids", json.dumps(coordinates), Content_Type="application/json")
        return answer.json(), answer.status == 201

    def grids(self, volume, page_size=None, page_token=""):
        size = {} if page_size is None else {"page_size": page_size}
        return self._call("GET", f"/v1/volumes/{volume}/grids?{self._query({**size, 'page_token': page_token})}").json()

    def grid(self, volume, grid):
        return self._call("GET", f"/v1/volumes/{volume}/grids/{grid}").json()

    def remove_grid(self, volume, grid):
        self._call("DELETE", f"/v1/volumes/{volume}/grids/{grid}")

    def create(self, volume, request, priority="interactive"):
        return self._call("POST", f"/v1/volumes/{volume}/extractions", json.dumps(request),
                          Content_Type="application/json", Priority=priority).json()

    def extraction(self, extraction):
        return self._call("GET", f"/v1/extractions/{extraction}").json()

    def watch(self, extraction, after=0):
        """[(id, kind, data)], until it ends."""
        text = self._call("GET", f"/v1/extractions/{extraction}/events", Last_Event_ID=str(after)).body.decode()
        events = []
        for block in text.split("\n\n"):
            fields = dict(line.split(": ", 1) for line in block.splitlines() if ": " in line)
            if "event" in fields:
                events.append((int(fields.get("id", 0)), fields["event"], json.loads(fields["data"])))
        return events

    @staticmethod
    def _levels(answer):
        """[(level, part, parts, preview, SHA-256)] and the manifest."""
        parts, manifest = [], None
        for headers, data in answer.parts():
            if headers["content-type"] == "application/json":
                manifest = json.loads(data)
            else:
                numbers = [int(headers[f"x-geosis-{name}"]) for name in ("level", "part", "parts")]
                parts.append((*numbers, headers["x-geosis-preview"] == "true", hashlib.sha256(data).hexdigest()))
        return parts, manifest

    def stream(self, extraction):
        return self._levels(self._call("GET", f"/v1/extractions/{extraction}/stream"))

    def bodies(self, extraction):
        return self._call("GET", f"/v1/extractions/{extraction}/bodies").json()

    def cancel(self, extraction, purge=False):
        self._call("DELETE", f"/v1/extractions/{extraction}" + ("?purge=true" if purge else ""))

    def extract(self, data, low, high, options=None):
        ends = ["-inf" if low is None else low, "inf" if high is None else high]
        return self._levels(self._call("POST", f"/v1/extract?{self._query({**(options or {}), 'range': ends})}", data,
                                       Content_Type="application/octet-stream"))
