"""What docker/compose.yaml, docker/Dockerfile and docker/nginx.conf owe: one line for each rule that is broken."""
import re

SECONDS = {"s": 1, "m": 60}


def seconds_of(text):
    match = re.fullmatch(r"(\d+)([sm])", str(text))
    return int(match.group(1)) * SECONDS[match.group(2)] if match else 0


def bytes_of(text):
    match = re.fullmatch(r"(\d+)([kmg])", text)
    return int(match.group(1)) << {"k": 10, "m": 20, "g": 30}[match.group(2)] if match else 0


def merged(compose, more):
    """compose.yaml with another file over it, as `docker compose --file ... --file ...` reads them: objects are joined, lists
    appended, the rest replaced."""
    if isinstance(compose, dict) and isinstance(more, dict):
        return {name: merged(compose[name], more[name]) if name in compose and name in more else more.get(name, compose.get(name))
                for name in {**compose, **more}}
    return compose + more if isinstance(compose, list) and isinstance(more, list) else more


def of_secrets(compose):
    for name, service in compose["services"].items():
        for secret in service.get("secrets", []):
            file = compose.get("secrets", {}).get(secret, {}).get("file", "")
            if not file.startswith("./"):
                yield f"{name}: nobody says where {secret} is"
            if f"/run/secrets/{secret}" not in " ".join(service.get("environment", {}).values()).split():
                yield f"{name}: does not read {secret}"
        for word in " ".join(service.get("environment", {}).values()).split():
            if word.startswith("/run/secrets/") and word.removeprefix("/run/secrets/") not in service.get("secrets", []):
                yield f"{name}: {word} is not there"


def of_every_service(name, service):
    if service.get("read_only") is not True:
        yield f"{name}: its root can be written"
    if service.get("cap_drop") != ["ALL"] or service.get("cap_add"):
        yield f"{name}: keeps capabilities"
    if "no-new-privileges:true" not in service.get("security_opt", []):
        yield f"{name}: may gain privileges"
    if service.get("privileged") or any(service.get(key) == "host" for key in ("network_mode", "pid", "ipc")):
        yield f"{name}: shares the host's namespaces or devices"
    for limit in ("mem_limit", "memswap_limit", "pids_limit", "ulimits", "logging"):
        if not service.get(limit):
            yield f"{name}: has no {limit}"
    if service.get("mem_limit") != service.get("memswap_limit"):
        yield f"{name}: may swap"
    if not any(mount.startswith("/tmp:") and {"noexec", "nosuid", "nodev"} <= set(mount.split(":")[1].split(","))
               and "size=" in mount for mount in service.get("tmpfs", [])):
        yield f"{name}: no bounded /tmp"
    for mount in service.get("volumes", []):
        if mount.startswith(("/", ".", "~")):
            yield f"{name}: mounts {mount} of the host"
    if not service.get("healthcheck", {}).get("test"):
        yield f"{name}: nobody looks after its health"
    for port in service.get("ports", []):
        if not port.startswith(("127.0.0.1:", "${GEOSIS_PUBLISH:-127.0.0.1}:")):
            yield f"{name}: {port} is published beyond this machine by default"


def of_the_whole(compose):
    services = compose["services"]
    server, edge = services["geosis"], services["edge"]
    environment = server.get("environment", {})
    if server.get("ports"):
        yield "geosis: is reached around the edge"
    if server.get("container_name"):
        yield "geosis: its name allows one replica only"
    if server.get("networks") != ["servers"] or compose["networks"]["servers"].get("internal") is not True:
        yield "geosis: is not on an internal network alone"
    if "store:/data" not in server.get("volumes", []):
        yield "geosis: its store does not outlive it"
    drain = int(environment.get("GEOSIS_DRAIN_DELAY_SECONDS", 0)) + int(environment.get("GEOSIS_DRAIN_SECONDS", 25))
    if seconds_of(server.get("stop_grace_period")) <= drain + 3:
        yield "geosis: is killed before it has drained"
    if edge.get("depends_on", {}).get("geosis", {}).get("condition") != "service_healthy":
        yield "edge: starts before there is a server"
    if environment.get("GEOSIS_AUTH") is None:
        yield "geosis: does not say who may call"


def of_compose_and_edge(compose, nginx):
    environment = compose["services"]["geosis"].get("environment", {})
    sizes = {bytes_of(size) for size in re.findall(r"client_max_body_size (\S+);", nginx)}
    if int(environment.get("GEOSIS_MAX_BODY", 0)) != max(sizes, default=-1):
        yield "edge and geosis take uploads of different sizes"
    connections = int(re.search(r"worker_connections (\d+);", nginx).group(1))
    if int(environment.get("GEOSIS_PEER_CONNECTIONS", 1024)) < connections:
        yield "geosis: takes the edge for a greedy client"
    shutdown = seconds_of(re.search(r"worker_shutdown_timeout (\S+);", nginx).group(1))
    if seconds_of(compose["services"]["edge"].get("stop_grace_period")) <= shutdown:
        yield "edge: is killed before it has drained"
    if "9464" in nginx:
        yield "edge: knows the admin door"


def stages_of(dockerfile):
    """{name: its instructions, continued lines joined}"""
    stages = {}
    for line in re.sub(r"\\\n\s*", "", dockerfile).splitlines():
        if match := re.fullmatch(r"FROM (\S+) AS (\S+)", line):
            stages[match.group(2)] = lines = [line]
        elif line and not line.startswith("#"):
            lines.append(line)
    return stages


def of_images(compose, dockerfile):
    for name, service in compose["services"].items():
        target = service.get("build", {}).get("target")
        lines = stages_of(dockerfile).get(target)
        if lines is None:
            yield f"{name}: is built from no stage of the Dockerfile"
            continue
        said = {line.split()[0]: line for line in lines}
        if not re.fullmatch(r"FROM debian:bookworm-slim AS \S+", said["FROM"]):
            yield f"{target}: {said['FROM']}"
        if not re.fullmatch(r"USER (1000\d):\1", said.get("USER", "")):
            yield f"{target}: runs as {said.get('USER', 'root')}"
        if "STOPSIGNAL" not in said:
            yield f"{target}: no STOPSIGNAL"
        if not said.get("ENTRYPOINT", "").startswith('ENTRYPOINT ["'):
            yield f"{target}: a shell stands between signals and the program"
        words = re.findall(r'"([^"]*)"', said.get("HEALTHCHECK", "").partition(" CMD ")[2])
        if not words or service.get("healthcheck", {}).get("test") != ["CMD", *words]:
            yield f"{target}: image and compose.yaml ask differently after its health"
        if any("GEOSIS_AUTH" in line for line in lines):
            yield f"{target}: the image says who may call"
        if any("-dev" in line for line in lines if line.startswith("RUN")):
            yield f"{target}: holds what only building needs"


def violations(compose, dockerfile, nginx):
    for name, service in compose["services"].items():
        yield from of_every_service(name, service)
    yield from of_the_whole(compose)
    yield from of_secrets(compose)
    yield from of_compose_and_edge(compose, nginx)
    yield from of_images(compose, dockerfile)
