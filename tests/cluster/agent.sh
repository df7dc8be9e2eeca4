#!/bin/bash
# agent.sh [options] HOST COMMAND...: what ssh does, for the hosts of hosts.py, whose first processes' numbers are in files of
# $HOSTS named after them. A host that is down or cut off does not answer, and ends the attempt after 8 seconds.
while [[ $1 == -* ]]; do shift; done
host=$1
shift
if ! ip -o link show dev "to-$host" up 2>/dev/null | grep -q LOWER_UP; then
  sleep 8
  echo "$host does not answer" >&2
  exit 255
fi
exec nsenter --target "$(<"$HOSTS/$host")" --net --pid --uts --mount -- /bin/sh -c "$*"
