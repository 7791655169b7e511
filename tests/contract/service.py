"""The built binary (environment variable GEOSIS) as a running server, and a client that judges every answer."""
import dataclasses
import email
import email.policy
import http.client
import json
import os
import socket
import subprocess
import urllib.parse

GEOSIS = os.environ["GEOSIS"]


@dataclasses.dataclass
class Answer:
    status: int
    headers: dict  # by lower-case name
    body: bytes

    def json(self):
        return json.loads(self.body)

    def parts(self):
        """Those of a multipart answer: [(headers, bytes)]."""
        head = f"Content-Type: {self.headers['content-type']}\r\n\r\n".encode()
        message = email.message_from_bytes(head + self.body, policy=email.policy.HTTP)
        return [({k.lower(): v for k, v in part.items()}, part.get_payload(decode=True)) for part in message.iter_parts()]


class Service:
    """A server on a free port with a store of its own; a context manager."""

    def __init__(self, store, *flags, **popen):
        self._popen = popen
        self._has_grpc = "--grpc" in flags
        self._command = [GEOSIS, "serve", "--listen", "127.0.0.1:0", "--store", str(store), *flags]
        self._command += [] if self._has_grpc else ["--grpc", "off"]

    def __enter__(self):
        self.process = subprocess.Popen(self._command, stdout=subprocess.PIPE, text=True, **self._popen)
        line = self.process.stdout.readline()
        if not line.startswith(("listening on http://", "listening on https://")):
            self.process.kill()
            raise RuntimeError(f"the server did not start: {line!r}")
        self.address = urllib.parse.urlsplit(line.split()[-1]).netloc
        if self._has_grpc:
            self.grpc_address = urllib.parse.urlsplit(self.process.stdout.readline().split()[-1]).netloc
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=30)
        self.process.stdout.close()


class Client:
    """Calls a service; every answer is held against the contract."""

    def __init__(self, address, contract):
        self._address = address
        self._contract = contract

    def call(self, method, target, body=None, headers=None):
        connection = http.client.HTTPConnection(self._address, timeout=120)
        try:
            connection.request(method, target, body=body, headers=headers or {})
            reply = connection.getresponse()
            answer = Answer(reply.status, {k.lower(): v for k, v in reply.getheaders()}, reply.read())
        finally:
            connection.close()
        if method != "OPTIONS":
            self._contract.check(method, urllib.parse.urlsplit(target).path, answer)
        return answer

    def get(self, target, **headers):
        return self.call("GET", target, headers={name.replace("_", "-"): value for name, value in headers.items()})

    def send_json(self, method, target, document, **headers):
        text = document if isinstance(document, (str, bytes)) else json.dumps(document)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        return self.call(method, target, body=text, headers={"Content-Type": "application/json", **named})

    def upload(self, data, query="", **headers):
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        return self.call("POST", f"/v1/volumes?{query}", body=data,
                         headers={"Content-Type": "application/octet-stream", **named})

    def raw(self, head):
        """Sends bytes as they are and returns the answer. For what http.client would not send."""
        host, port = self._address.split(":")
        with socket.create_connection((host, int(port)), timeout=30) as connection:
            connection.sendall(head)
            reply = http.client.HTTPResponse(connection)
            reply.begin()
            return Answer(reply.status, {k.lower(): v for k, v in reply.getheaders()}, reply.read())
