#!/usr/bin/env bash
# Whether nginx answers, for an image that has no HTTP client.
set -euo pipefail
exec 3<>/dev/tcp/127.0.0.1/8080
printf 'GET /edge/livez HTTP/1.0\r\n\r\n' >&3
read -r -t 4 -u 3 _ status _
[ "$status" = 204 ]
