#!/bin/bash
# agent.sh [options] HOST COMMAND...: replaces ssh for the hosts of hosts.py. The file $HOSTS/HOST has the PID of a
# host's first process. If the host is down or cut off, the attempt fails after 8 seconds.
while [[ $1 == -* ]]; do shift; done
host=$1
shift
if ! ip -o link show dev "to-$host" up 2>/dev/null | grep -q LOWER_UP; then
  sleep 8
  echo "$host does not answer" >&2
  exit 255
fi
exec nsenter --target "$(<"$HOSTS/$host")" --net --pid --uts --mount -- /bin/sh -c "$*"
