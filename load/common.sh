# What the parts of `make load` share; they source it and run in a folder of their own.
# shellcheck shell=bash disable=SC2034 # The parts use variables that are set here.
set -euo pipefail
shopt -s inherit_errexit

ltcforge=$(realpath "${LTCFORGE:?the path of the ltcforge binary}")
# Of what is measured for a time: how long, and how often.
seconds=${SECONDS_EACH:-2}
rounds=${ROUNDS:-5}
work=$(mktemp -d)
pids=()
trap 'kill -TERM "${pids[@]}" 2>/dev/null || true; wait || true; rm -rf "$work"' EXIT
export no_proxy='*'
# In a folder without a configuration file.
cd "$work"
missed=0

# Ends the part well if a tool is missing.
need() {
  for tool; do
    command -v "$tool" >/dev/null || { echo "*** SKIPPED: no $tool, and nothing was measured" >&2; exit 0; }
  done
}

# Starts a service on the folder `data`: its address in `service`, its process in `server`.
start_service() {
  rm -f listening
  mkfifo listening
  "$ltcforge" serve --listen 127.0.0.1:0 --data data >listening 2>>serve.log & server=$!
  pids+=("$server")
  read -r _ _ service <listening || { cat serve.log >&2; exit 1; }
}

get() { curl -sS --fail-with-body "$@"; }
# Submits a recipe and prints the job's id.
submit() { get -d "$1" "$service/v1/jobs" | jq -r .id; }
# Prints the table of a job once it is done.
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

# The output of wrk with 64 connections that stay open; all requests must have gone well.
by_wrk() {
  local out
  out=$(wrk -t2 -c64 -d"$seconds" "$@")
  ! grep -E 'Non-2xx|Socket errors' <<<"$out" >&2 || return 1
  echo "$out"
}

# Prints the median of a number a line, in a format of printf.
median() { sort -g | awk -v format="$1" '{ all[NR] = $1 } END { printf format, all[int((NR + 1) / 2)] }'; }

# Prints a row: what, its figure, the greatest that is allowed, the unit.
row() {
  printf '%-60s %9s %9s %s\n' "$@"
  awk -v figure="$2" -v most="$3" 'BEGIN { exit !(figure <= most) }' || missed=1
}
