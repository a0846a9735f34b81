#!/usr/bin/env bash
# Runs 2,000 small jobs. Measures their time, the size of the data folder, memory, and the next starts of the service.
. "$(dirname "$0")/common.sh"
need curl jq
jobs=2000

start_service
# Uses one connection. If the queue is full, curl waits as long as `Retry-After` states and retries.
for seed in $(seq "$jobs"); do
  [ "$seed" = 1 ] || echo next
  cat <<CURL
url = "$service/v1/jobs"
data = "{\"preset\":\"draft\",\"resolution\":{\"alpha\":2,\"ratio\":2,\"theta\":2,\"phi\":2},\"fit\":{\"seed\":$seed}}"
retry = 1000
output = "answer"
write-out = "%{response_code}\n"
silent
show-error
noproxy = "*"
CURL
done >requests
began=$EPOCHREALTIME
curl -K requests >codes
accepted=$(grep -c 202 codes) || true
[ "$accepted" = "$jobs" ] || { echo "*** only $accepted of $jobs jobs were accepted" >&2; sort codes | uniq -c >&2; exit 1; }
# Prints the number of jobs whose state matches a pattern.
count() { get "$service/metrics" | awk -v states="^ltcforge_jobs{state=\"($1)\"}" '$1 ~ states { sum += $2 } END { print sum }'; }
until [ "$(count 'queued|running')" = 0 ]; do sleep 0.1; done
ended=$EPOCHREALTIME
[ "$(count 'done')" = "$jobs" ] || { echo '*** some jobs failed' >&2; get "$service/metrics" >&2; exit 1; }
memory=$(awk '$1 == "VmHWM:" { print $2 * 1024 / 1e6 }' "/proc/$server/status")

for _ in $(seq 5); do
  kill -TERM "$server"
  wait "$server" || true
  pids=()
  start=$EPOCHREALTIME
  start_service
  until curl -sf -o /dev/null "$service/readyz"; do :; done
  awk -v a="$start" -v b="$EPOCHREALTIME" 'BEGIN { print b - a }' >>starts
done

echo "$jobs jobs of 16 entries at preset draft, one connection, a queue of 64:"
printf '%-60s %9s %9s\n' '' now 'at most'
row 'from the first submission to the end of the last job' \
  "$(awk -v a="$began" -v b="$ended" 'BEGIN { printf "%.1f", b - a }')" 50 s
row 'the data folder' "$(du -s --block-size=1 data | awk '{ printf "%.1f", $1 / 1e6 }')" 51 MB
row 'peak memory of the service' "$(printf %.1f "$memory")" 83 MB
row 'from a start until it is ready, median of 5' "$(median %.2f <starts)" 0.57 s
exit $missed
