"""The formal contract, api/openapi.yaml, as a judge of answers."""
import json
import re
from pathlib import Path

import jsonschema
import yaml

OPENAPI = Path(__file__).resolve().parents[2] / "api" / "openapi.yaml"


class Contract:
    """Finds the operation of a call and says what is wrong with its answer."""

    def __init__(self, path=OPENAPI):
        self.document = yaml.safe_load(path.read_text(encoding="utf-8"))
        self.seen = set()
        self._operations = []
        for template, item in self.document["paths"].items():
            for method in ("get", "post", "patch", "delete"):
                if method in item:
                    self._operations.append((method.upper(), self._pattern(template), item[method]))

    @staticmethod
    def _pattern(template):
        return re.compile(re.sub(r"\\\{\w+\\\}", "([^/]+?)", re.escape(template)))

    def operations(self):
        return {operation["operationId"] for _, _, operation in self._operations}

    def operation(self, method, path):
        """The operation of a call, or None. HEAD is GET without its body."""
        wanted = "GET" if method == "HEAD" else method
        for known, pattern, operation in self._operations:
            if known == wanted and pattern.fullmatch(path):
                return operation
        return None

    def resolve(self, node):
        while "$ref" in node:
            target = self.document
            for key in node["$ref"].removeprefix("#/").split("/"):
                target = target[key]
            node = target
        return node

    def validate(self, schema, value):
        """Raises jsonschema.ValidationError."""
        whole = {"components": self.document["components"], "allOf": [schema]}
        jsonschema.Draft202012Validator(whole).validate(value)

    def check(self, method, path, answer):
        """Raises AssertionError when the answer is not one that the contract allows."""
        operation = self.operation(method, path)
        if operation is None:
            assert answer.status >= 400 or path == "/", f"{method} {path}: answered, but not in the contract"
            if answer.status >= 400:
                self._check_problem(answer)
            return
        responses = operation["responses"]
        where = f"{method} {path}: {answer.status}"
        assert str(answer.status) in responses, f"{where}: not a documented status: {answer.body[:300]}"
        self.seen.add((operation["operationId"], answer.status))
        response = self.resolve(responses[str(answer.status)])
        self._check_headers(where, response, answer)
        if method != "HEAD":
            self._check_body(where, response, answer)

    def _check_problem(self, answer):
        assert answer.headers["content-type"] == "application/problem+json", answer.headers
        self.validate({"$ref": "#/components/schemas/Problem"}, json.loads(answer.body))

    def _check_headers(self, where, response, answer):
        for name, header in response.get("headers", {}).items():
            header = self.resolve(header)
            value = answer.headers.get(name.lower())
            assert value is not None or not header.get("required"), f"{where}: without {name}"
            if value is not None:
                self.validate(header["schema"], value)

    def _check_body(self, where, response, answer):
        content = response.get("content")
        if content is None:
            return
        media_type = answer.headers.get("content-type", "").partition(";")[0]
        assert media_type in content, f"{where}: content type {media_type!r}; expected one of {list(content)}"
        schema = content[media_type].get("schema")
        if schema:
            document = json.loads(answer.body)
            self.validate(schema, document)
            if media_type == "application/problem+json":
                assert document["status"] == answer.status, f"{where}: the document says {document['status']}"
