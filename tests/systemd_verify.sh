#!/usr/bin/env bash
# The unit is one that systemd takes without a word, and does not make the whole daemon real-time (SYS-1).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
unit=$root/systemd/stationd@.service
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

fail() {
  echo "systemd_verify: $*"
  exit 1
}

# The unit names an installed daemon: here is one, so that systemd finds what it looks for.
printf '#!/bin/sh\n' >"$scratch/stationd"
chmod +x "$scratch/stationd"
sed "s|/usr/bin/stationd|$scratch/stationd|; s|^Documentation=.*|Documentation=file://$root/README.md|" \
  "$unit" >"$scratch/stationd@.service"
cp "$scratch/stationd@.service" "$scratch/stationd@controller1.service"

# systemd-analyze exits 0 on unknown keys and bad values; what it prints is the verdict.
said=$(systemd-analyze verify --man=no --recursive-errors=no "$scratch/stationd@controller1.service" 2>&1) ||
  fail "systemd-analyze verify failed: $said"
[[ -z $said ]] || fail "systemd-analyze verify says: $said"

# The same check does notice: else its silence means nothing.
sed 's/^WatchdogSec=.*/WatchdogSec=soon\nNoSuchKey=1/' "$scratch/stationd@controller1.service" \
  >"$scratch/stationd@broken.service"
said=$(systemd-analyze verify --man=no --recursive-errors=no "$scratch/stationd@broken.service" 2>&1 || true)
[[ $said == *NoSuchKey* && $said == *soon* ]] || fail "a broken unit goes unnoticed: $said"

! grep -q '^CPUSchedulingPolicy=' "$unit" || fail "the unit sets CPUSchedulingPolicy="
for line in Type=notify WatchdogSec=5s RestartPreventExitStatus=78 User=stationd \
  'ExecStopPost=/usr/bin/stationd --write-safe /etc/stationd/%i.toml'; do
  grep -qxF "$line" "$unit" || fail "the unit lacks: $line"
done

said=$(systemd-sysusers --dry-run "$root/systemd/stationd.conf" 2>&1) || fail "systemd-sysusers: $said"
[[ -z $said || $said == *stationd* ]] || fail "systemd-sysusers says: $said"
echo "the unit is silent under systemd-analyze verify"
