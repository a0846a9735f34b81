# Common functions for the parts of `make load`. Each part sources this file and then runs in a temporary folder.
# shellcheck shell=bash disable=SC2034 # The parts use variables that are set here.
set -euo pipefail
shopt -s inherit_errexit

ltcforge=$(realpath "${LTCFORGE:?the path of the ltcforge binary}")
# The length in seconds and the number of measurements.
seconds=${SECONDS_EACH:-2}
rounds=${ROUNDS:-5}
work=$(mktemp -d)
pids=()
trap 'kill -TERM "${pids[@]}" 2>/dev/null || true; wait || true; rm -rf "$work"' EXIT
export no_proxy='*'
cd "$work"
missed=0

# Exits with success if a tool is missing.
need() {
  for tool; do
    command -v "$tool" >/dev/null || { echo "*** SKIPPED: $tool is not installed; nothing was measured" >&2; exit 0; }
  done
}

# Starts a service on the folder `data`. Sets `service` to its URL and `server` to its process id.
start_service() {
  rm -f listening
  mkfifo listening
  "$ltcforge" serve --listen 127.0.0.1:0 --data data >listening 2>>serve.log & server=$!
  pids+=("$server")
  read -r _ _ service <listening || { cat serve.log >&2; exit 1; }
}

get() { curl -sS --fail-with-body "$@"; }
# Submits a recipe and prints the id of the job.
submit() { get -d "$1" "$service/v1/jobs" | jq -r .id; }
# Waits for a job and prints the digest of its table.
table_of() {
  local job state
  while job=$(get "$service/v1/jobs/$1") && state=$(jq -r .state <<<"$job"); do
    case $state in
      done) jq -r .table <<<"$job"; return ;;
      queued | running) sleep 0.5 ;;
      *) echo "$job" >&2; return 1 ;;
    esac
  done
}

# Prints the output of wrk with 64 open connections. A failed request is an error.
by_wrk() {
  local out
  out=$(wrk -t2 -c64 -d"$seconds" "$@")
  ! grep -E 'Non-2xx|Socket errors' <<<"$out" >&2 || return 1
  echo "$out"
}

# Prints the median of the input, one number per line, in a printf format.
median() { sort -g | awk -v format="$1" '{ all[NR] = $1 } END { printf format, all[int((NR + 1) / 2)] }'; }

# Prints a row (name, measured value, limit, unit) and sets `missed` if the value exceeds the limit.
row() {
  printf '%-60s %9s %9s %s\n' "$@"
  awk -v figure="$2" -v most="$3" 'BEGIN { exit !(figure <= most) }' || missed=1
}
