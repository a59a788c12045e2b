#!/usr/bin/env bash
# The units are such that systemd takes them without a word; the daemon's does not make all of it real-time,
# and the supervisor's has no rights (SYS-1).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

fail() {
  echo "systemd_verify: $*"
  exit 1
}

verify() { systemd-analyze verify --man=no --recursive-errors=no "$1" 2>&1; }

# silent UNIT INSTANCE PROGRAM: systemd has nothing to say of that unit, and does of a broken one: else its
# silence means nothing. systemd-analyze exits 0 on unknown keys and bad values: what it prints counts.
silent() {
  local unit=$root/systemd/$1 instance=$scratch/$2 said
  # The unit names an installed program: here is one, so that systemd finds what it looks for.
  printf '#!/bin/sh\n' >"$scratch/$3"
  chmod +x "$scratch/$3"
  sed "s|/usr/bin/$3 |$scratch/$3 |" "$unit" >"$scratch/$1"
  [[ $1 == "$2" ]] || cp "$scratch/$1" "$instance"
  said=$(verify "$instance") || fail "systemd-analyze verify of $1 failed: $said"
  [[ -z $said ]] || fail "systemd-analyze verify of $1 says: $said"
  sed 's/^RestartSec=.*/RestartSec=soon\nNoSuchKey=1/' "$instance" >"$scratch/broken.service"
  said=$(verify "$scratch/broken.service" || true)
  [[ $said == *NoSuchKey* && $said == *soon* ]] || fail "a broken $1 goes unnoticed: $said"
}

# has UNIT LINE...
has() {
  local unit=$root/systemd/$1 line
  shift
  for line in "$@"; do
    grep -qxF "$line" "$unit" || fail "$(basename "$unit") lacks: $line"
  done
}

silent stationd@.service stationd@controller1.service stationd
silent stationd-supervisor.service stationd-supervisor.service stationd-supervisor

! grep -q '^CPUSchedulingPolicy=' "$root"/systemd/*.service || fail "a unit sets CPUSchedulingPolicy="
has stationd@.service Type=notify WatchdogSec=5s RestartPreventExitStatus=78 User=stationd \
  'ExecStopPost=/usr/bin/stationd --write-safe /etc/stationd/%i.toml'
has stationd-supervisor.service Type=exec Restart=on-failure 'RestartPreventExitStatus=64 78' \
  User=stationd-supervisor StateDirectory=stationd-supervisor CapabilityBoundingSet= AmbientCapabilities=

said=$(systemd-sysusers --dry-run "$root/systemd/stationd.conf" 2>&1) || fail "systemd-sysusers: $said"
[[ -z $said || $said == *stationd* ]] || fail "systemd-sysusers says: $said"
for user in $(sed -n 's/^User=//p' "$root"/systemd/*.service); do
  grep -q "^u $user " "$root/systemd/stationd.conf" || fail "stationd.conf makes no user $user"
done
echo "the units are silent under systemd-analyze verify"
