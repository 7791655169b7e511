"""Holds docker/ against its rules, and the rules against a break of each."""
import copy
import unittest
from pathlib import Path

import yaml

from compose_rules import merged, violations

DOCKER = Path(__file__).resolve().parents[2] / "docker"
COMPOSE = yaml.safe_load((DOCKER / "compose.yaml").read_text())
KEYS = yaml.safe_load((DOCKER / "compose.keys.yaml").read_text())
DOCKERFILE = (DOCKER / "Dockerfile").read_text()
NGINX = (DOCKER / "nginx.conf").read_text()
ABSENT = object()


def broken(path, value, whole=COMPOSE):
    """compose.yaml, or another one, with another value, or none, at services/..."""
    compose = copy.deepcopy(whole)
    *folders, last = path.split("/")
    place = compose
    for name in folders:
        place = place[name]
    if value is ABSENT:
        del place[last]
    else:
        place[last] = value
    return compose


class ComposeRules(unittest.TestCase):
    def test_the_repository_keeps_them(self):
        self.assertEqual(list(violations(COMPOSE, DOCKERFILE, NGINX)), [])

    def test_keys_change_only_who_may_call(self):
        self.assertEqual(list(KEYS["services"]), ["geosis"])
        self.assertEqual(set(KEYS["services"]["geosis"]), {"environment", "secrets"})
        both = merged(COMPOSE, KEYS)
        self.assertEqual(list(violations(both, DOCKERFILE, NGINX)), [])
        self.assertEqual(both["services"]["geosis"]["environment"].pop("GEOSIS_AUTH"), "api_keys /run/secrets/geosis_keys")
        without = copy.deepcopy(COMPOSE["services"]["geosis"])
        del without["environment"]["GEOSIS_AUTH"]
        self.assertEqual({**both["services"]["geosis"], "secrets": None}, {**without, "secrets": None})
        self.assertEqual({**both, "services": None, "secrets": None}, {**COMPOSE, "services": None, "secrets": None})

    def test_each_break_in_the_file_of_keys_is_found(self):
        for path, value, said in (("secrets", {}, "nobody says where"), ("services/geosis/secrets", [], "is not there"),
                                  ("secrets/geosis_keys/file", "/etc/keys.txt", "nobody says where"),
                                  ("services/geosis/environment/GEOSIS_AUTH", "none", "does not read geosis_keys")):
            with self.subTest(path=path):
                found = list(violations(merged(COMPOSE, broken(path, value, KEYS)), DOCKERFILE, NGINX))
                self.assertTrue(any(said in line for line in found), found)

    def test_each_break_in_compose_is_found(self):
        server, edge = "services/geosis", "services/edge"
        for path, value, said in (
                (f"{server}/read_only", False, "its root can be written"), (f"{edge}/read_only", ABSENT, "its root can be written"),
                (f"{server}/cap_drop", ["NET_RAW"], "keeps capabilities"), (f"{edge}/cap_add", ["NET_BIND_SERVICE"], "keeps cap"),
                (f"{server}/security_opt", [], "may gain privileges"), (f"{server}/privileged", True, "shares the host's"),
                (f"{edge}/network_mode", "host", "shares the host's"), (f"{server}/mem_limit", ABSENT, "has no mem_limit"),
                (f"{server}/memswap_limit", "8g", "may swap"), (f"{edge}/pids_limit", ABSENT, "has no pids_limit"),
                (f"{server}/ulimits", ABSENT, "has no ulimits"), (f"{edge}/logging", ABSENT, "has no logging"),
                (f"{server}/tmpfs", ["/tmp"], "no bounded /tmp"), (f"{server}/volumes", ["/srv:/data"], "mounts /srv:/data"),
                (f"{server}/volumes", [], "does not outlive it"), (f"{server}/healthcheck", ABSENT, "looks after its health"),
                (f"{server}/healthcheck/test", ["CMD", "true"], "ask differently"),
                (f"{edge}/ports", ["8080:8080"], "beyond this machine"), (f"{server}/ports", ["127.0.0.1:80:80"], "around the edge"),
                (f"{server}/container_name", "geosis", "one replica only"),
                (f"{server}/networks", ["servers", "clients"], "not on an internal network"),
                ("networks/servers", {}, "not on an internal network"), (f"{server}/stop_grace_period", "20s", "before it has drained"),
                (f"{server}/environment/GEOSIS_DRAIN_DELAY_SECONDS", "15", "before it has drained"),
                (f"{edge}/stop_grace_period", "1m", "before it has drained"), (f"{edge}/depends_on", {}, "before there is a server"),
                (f"{server}/environment/GEOSIS_AUTH", ABSENT, "who may call"),
                (f"{server}/environment/GEOSIS_MAX_BODY", "1000", "different sizes"),
                (f"{server}/environment/GEOSIS_PEER_CONNECTIONS", ABSENT, "greedy client"),
                (f"{server}/build/target", "none", "no stage")):
            with self.subTest(path=path, value=value):
                found = list(violations(broken(path, value), DOCKERFILE, NGINX))
                self.assertTrue(any(said in line for line in found), found)

    def test_each_break_in_the_images_is_found(self):
        for said, instead, complaint in (
                ("FROM debian:bookworm-slim AS geosis", "FROM debian:latest AS geosis", "FROM debian:latest"),
                ("USER 10001:10001\n", "", "runs as root"), ("USER 10002:10002", "USER root", "runs as USER root"),
                ("STOPSIGNAL SIGTERM\n", "", "no STOPSIGNAL"), ('ENTRYPOINT ["geosis"]', "ENTRYPOINT geosis", "a shell stands"),
                ('"probe"', '"--version"', "ask differently"), ("ENV GEOSIS_LISTEN", "ENV GEOSIS_AUTH=none GEOSIS_LISTEN", "who may call"),
                ("--no-install-recommends nginx", "--no-install-recommends nginx-dev", "only building needs")):
            with self.subTest(instead):
                self.assertIn(said, DOCKERFILE)
                found = list(violations(COMPOSE, DOCKERFILE.replace(said, instead), NGINX))
                self.assertTrue(any(complaint in line for line in found), found)

    def test_an_edge_that_reaches_the_admin_door_is_found(self):
        found = list(violations(COMPOSE, DOCKERFILE, NGINX + "# proxy_pass http://geosis:9464;"))
        self.assertEqual(found, ["edge: knows the admin door"])


if __name__ == "__main__":
    unittest.main()
