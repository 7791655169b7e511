"""Containers by runc as docker/compose.yaml says, on a network of their own, from the images that .ci/images.sh left.

Needs root. The process must have unshared its network and mounts: then nothing outlives it.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

from compose_rules import merged

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
IMAGES = REPOSITORY / "build" / "images"
COMPOSE, KEYS = (yaml.safe_load((REPOSITORY / "docker" / name).read_text()) for name in ("compose.yaml", "compose.keys.yaml"))
BRIDGE = "10.77.0.1"
MASKED = ["/proc/acpi", "/proc/kcore", "/proc/keys", "/proc/latency_stats", "/proc/timer_list", "/proc/sched_debug", "/sys/firmware"]
READ_ONLY = ["/proc/bus", "/proc/fs", "/proc/irq", "/proc/sys", "/proc/sysrq-trigger"]


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, **options).stdout


def make_network():
    Path("/run/netns").mkdir(exist_ok=True)
    run("mount", "-t", "tmpfs", "tmpfs", "/run/netns")  # the machine's own names stay out of it
    run("ip", "link", "set", "lo", "up")
    run("ip", "link", "add", "servers", "type", "bridge")
    run("ip", "addr", "add", f"{BRIDGE}/24", "dev", "servers")
    run("ip", "link", "set", "servers", "up")


def remove_control_groups():
    for folder in sorted(Path("/sys/fs/cgroup").rglob(f"geosis-test-{os.getpid()}")):
        folder.rmdir()


def size(text):
    """Bytes of compose's "4g", where a variable may stand with its default."""
    number, unit = re.fullmatch(r"(?:\$\{\w+:-)?(\d+)([kmg])\}?", text).groups()
    return int(number) << {"k": 10, "m": 20, "g": 30}[unit]


class Container:
    """One container of a service of compose.yaml; a context manager.

    address   its own on the bridge.    volumes   {path inside: folder}.    environment   beside compose's; None = without.
    keys      a file of keys, with compose.keys.yaml over compose.yaml; None = compose.yaml alone.
    """

    def __init__(self, folder, service, name, address, volumes, environment=None, memory=None, keys=None):
        compose = merged(COMPOSE, KEYS) if keys else COMPOSE
        self.service, self.name, self.address = compose["services"][service], name, address
        self.image = json.loads((IMAGES / f"{service}.json").read_text())["Docker"]["config"]
        self.bundle = Path(tempfile.mkdtemp(prefix=f"{name}-", dir=folder))
        self.memory = memory or size(self.service["mem_limit"])
        variables = dict(line.split("=", 1) for line in self.image["Env"])
        variables.update(self.service.get("environment", {}))
        variables.update(environment or {})
        secrets = {f"/run/secrets/{secret}": keys for secret in self.service.get("secrets", [])}
        (self.bundle / "config.json").write_text(json.dumps(self._configuration(service, variables, volumes, secrets)))
        self._runc = ["runc", "--root", str(Path(folder) / "runc")]
        self.log = self.bundle / "log"

    def _configuration(self, service, variables, volumes, secrets):
        user, group = (int(number) for number in self.image["User"].split(":"))
        files = self.service["ulimits"]["nofile"]
        tmp = self.service["tmpfs"][0].partition(":")[2].split(",")
        mounts = [{"destination": "/proc", "type": "proc", "source": "proc"},
                  {"destination": "/dev", "type": "tmpfs", "source": "tmpfs", "options": ["nosuid", "mode=755", "size=65536k"]},
                  {"destination": "/sys", "type": "sysfs", "source": "sysfs", "options": ["nosuid", "noexec", "nodev", "ro"]},
                  {"destination": "/sys/fs/cgroup", "type": "cgroup", "source": "cgroup",
                   "options": ["nosuid", "noexec", "nodev", "relatime", "ro"]},
                  {"destination": "/tmp", "type": "tmpfs", "source": "tmpfs", "options": [*tmp, "mode=1777"]}]
        mounts += [{"destination": inside, "type": "bind", "source": str(outside), "options": ["rbind", "rw", "nosuid", "nodev"]}
                   for inside, outside in volumes.items()]
        mounts += [{"destination": inside, "type": "bind", "source": str(file), "options": ["bind", "ro", "nosuid", "nodev", "noexec"]}
                   for inside, file in secrets.items()]
        return {
            "ociVersion": "1.0.2",
            "process": {"user": {"uid": user, "gid": group}, "cwd": "/",
                        "args": (self.image["Entrypoint"] or []) + (self.image.get("Cmd") or []),
                        "env": [f"{name}={value}" for name, value in variables.items() if value is not None],
                        "capabilities": {kind: [] for kind in ("bounding", "effective", "inheritable", "permitted", "ambient")},
                        "noNewPrivileges": True, "rlimits": [{"type": "RLIMIT_NOFILE", "hard": files, "soft": files}]},
            "root": {"path": str(IMAGES / service), "readonly": self.service["read_only"]},
            "hostname": self.name, "mounts": mounts,
            "linux": {"namespaces": [{"type": kind} for kind in ("pid", "mount", "ipc", "uts")]
                      + [{"type": "network", "path": f"/run/netns/{self.name}"}],
                      "resources": {"memory": {"limit": self.memory, "swap": self.memory},
                                    "pids": {"limit": self.service["pids_limit"]}},
                      "cgroupsPath": f"/geosis-test-{os.getpid()}/{self.name}", "maskedPaths": MASKED, "readonlyPaths": READ_ONLY}}

    def __enter__(self):
        inside = ("ip", "-n", self.name)
        run("ip", "netns", "add", self.name)
        run("ip", "link", "add", f"{self.name}-v", "type", "veth", "peer", "name", "eth0", "netns", self.name)
        run("ip", "link", "set", f"{self.name}-v", "master", "servers", "up")
        run(*inside, "addr", "add", f"{self.address}/24", "dev", "eth0")
        for device in ("lo", "eth0"):
            run(*inside, "link", "set", device, "up")
        with open(self.log, "w") as log:
            self.process = subprocess.Popen([*self._runc, "run", "--bundle", self.bundle, self.name], stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=log)
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.kill("KILL")
            self.process.wait(timeout=30)
        run("ip", "link", "delete", f"{self.name}-v")  # at once: the namespace itself goes later
        run("ip", "netns", "delete", self.name)

    def kill(self, signal):
        run(*self._runc, "kill", self.name, signal)

    def stop(self):
        """As `docker stop` does; returns the exit status. Raises when the grace is over."""
        self.kill(self.image["StopSignal"])
        return self.process.wait(timeout=int(self.service["stop_grace_period"].rstrip("s")))

    def execute(self, *command):
        """Exit status and output of a command inside."""
        done = subprocess.run([*self._runc, "exec", "--cap", "", self.name, *command], capture_output=True, text=True, timeout=30,
                              check=False)
        return done.returncode, done.stdout + done.stderr

    def wait_until_healthy(self, seconds=30):
        """By the image's own HEALTHCHECK."""
        kind, *command = self.image["Healthcheck"]["Test"]
        assert kind == "CMD", kind
        deadline = time.monotonic() + seconds
        while True:
            said = self.execute(*command)
            if said[0] == 0:
                return
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"{self.name}: {said}; {self.log.read_text()}")
            time.sleep(0.1)

    def status(self):
        """/proc/PID/status of the first process, by name."""
        pid = json.loads(run(*self._runc, "state", self.name))["pid"]
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
        return {name: value.split() for name, _, value in (line.partition(":") for line in lines)}

    def limit(self, controller, file):
        """What the kernel holds it to: control groups of version 1 or 2."""
        pid = json.loads(run(*self._runc, "state", self.name))["pid"]
        for line in Path(f"/proc/{pid}/cgroup").read_text().splitlines():
            _, controllers, path = line.split(":", 2)
            if controller in controllers.split(","):
                return int((Path("/sys/fs/cgroup") / controller / path.lstrip("/") / file[0]).read_text())
        return int((Path("/sys/fs/cgroup") / path.lstrip("/") / file[1]).read_text())


class Names:
    """Tells a container that `geosis` stands for some addresses, as Docker's 127.0.0.11 does; a context manager."""

    def __init__(self, container, addresses):
        self._command = ["ip", "netns", "exec", container.name, sys.executable, HERE / "names.py", *addresses]

    def __enter__(self):
        self._process = subprocess.Popen(self._command)
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
