# Shared by the scripts in this folder (sourced, not run): progress lines, DDS domains, clearing up.
# shellcheck shell=bash disable=SC2034 # what is set here is used by those that source it

STATIOND_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# say TEXT...: one progress line with the seconds since the script started.
say() { printf '[%4ds] %s: %s\n' "$SECONDS" "$(basename "$0")" "$*"; }

# die STATUS TEXT...: one line on stderr, then exit.
die() {
  local status=$1
  shift
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit "$status"
}

# step TEXT COMMAND...: runs COMMAND between two progress lines; returns its status.
step() {
  local text=$1 began=$SECONDS status=0
  shift
  say "$text"
  "$@" || status=$?
  if ((status == 0)); then
    say "$text: done in $((SECONDS - began)) s"
  else
    say "$text: FAILED (status $status) after $((SECONDS - began)) s"
  fi
  return "$status"
}

# claim_domain: sets STATIOND_CLAIMED to a DDS domain, 1 to 99, that no other run on this machine has claimed.
# The claim is a lock on a file and lasts until release_domain or the end of the process. The file is in /tmp
# whatever TMPDIR says: domains are the machine's.
claim_domain() {
  local try domain file
  for ((try = 0; try < 99; try++)); do
    domain=$((($$ + try * 7) % 99 + 1))
    file=/tmp/stationd-domain-$domain.lock
    { exec {STATIOND_CLAIM_FD}<>"$file"; } 2>/dev/null || continue
    # Whoever held it may have removed the file between our open and our lock: then this is nobody's lock.
    if flock -n "$STATIOND_CLAIM_FD" && [[ $file -ef /proc/self/fd/$STATIOND_CLAIM_FD ]]; then
      STATIOND_CLAIMED=$domain
      STATIOND_CLAIM_FILE=$file
      return 0
    fi
    exec {STATIOND_CLAIM_FD}>&-
  done
  die 1 "all DDS domains from 1 to 99 are claimed (/tmp/stationd-domain-*.lock)"
}

release_domain() {
  [[ -n ${STATIOND_CLAIM_FILE:-} ]] || return 0
  rm -f "$STATIOND_CLAIM_FILE"
  exec {STATIOND_CLAIM_FD}>&-
  STATIOND_CLAIM_FILE=
}

# run_members: the processes that carry this run's STATIOND_RUN_ID, but for this shell and its ancestors.
run_members() {
  local skip=" $$ $BASHPID " pid=$$ env
  while ((pid > 1)); do
    pid=$(awk '/^PPid:/ {print $2}' "/proc/$pid/status" 2>/dev/null || echo 0)
    skip+="$pid "
  done
  for env in /proc/[0-9]*/environ; do
    pid=${env#/proc/}
    pid=${pid%/environ}
    [[ $skip == *" $pid "* ]] && continue
    grep -qz "^STATIOND_RUN_ID=$STATIOND_RUN_ID\$" "$env" 2>/dev/null && echo "$pid"
  done
  return 0
}

# end_members: ends what this run has started and nothing else: asked first, killed after two seconds.
end_members() {
  local pids try
  pids=$(run_members)
  [[ -n $pids ]] || return 0
  # shellcheck disable=SC2086 # one word per process
  kill -TERM $pids 2>/dev/null
  for ((try = 0; try < 20; try++)); do
    sleep 0.1
    pids=$(run_members)
    [[ -n $pids ]] || return 0
  done
  # shellcheck disable=SC2086
  kill -KILL $pids 2>/dev/null
  return 0
}
