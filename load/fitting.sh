#!/usr/bin/env bash
# Measures the latency of requests during a fit, and how much requests slow down a fit.
. "$(dirname "$0")/common.sh"
need wrk hey curl jq
fits=${FITS:-7}

start_service
table=$service/v1/tables/$(table_of "$(submit '{"preset":"draft"}')")

# Prints the 99th percentile of the response time in ms.
p99() { by_wrk --latency "$1" | awk '$1 == "99%" { print $2 * ($2 ~ /us$/ ? .001 : $2 ~ /ms$/ ? 1 : 1000) }'; }

# The fit must take longer than all requests. If it ends early, try again with a larger recipe.
for ((nodes = 16; ; nodes += 8)); do
  long=$(submit "{\"preset\":\"best\",\"resolution\":{\"alpha\":$nodes,\"ratio\":$nodes,\"theta\":$nodes,\"phi\":$nodes}}")
  until get "$service/v1/jobs/$long" | jq -e '.progress.entries_done > 0' >/dev/null; do sleep 0.1; done
  rm -f jobs.p99 tables.p99
  for _ in $(seq "$rounds"); do
    p99 "$service/v1/jobs/$long" >>jobs.p99
    p99 "$table" >>tables.p99
  done
  [ "$(get -X DELETE "$service/v1/jobs/$long" | jq -r .state)" != cancelled ] || break
done
echo "During a fit, 64 connections without a pause, median of $rounds rounds of $seconds s in turns:"
printf '%-60s %9s %9s\n' '' now 'at most'
row 'a job, 99 of 100 answered within' "$(median %.1f <jobs.p99)" 20 ms
row 'a table, 99 of 100 answered within' "$(median %.1f <tables.p99)" 50 ms

# Fits one recipe, deletes its table, and prints the seconds of the job.
fit() {
  local id digest
  id=$(submit '{"preset":"paper","resolution":{"alpha":12,"ratio":10,"theta":12,"phi":10}}')
  digest=$(table_of "$id")
  get "$service/v1/jobs/$id" | jq -r '[.started_at, .finished_at] | @tsv' | {
    read -r started finished
    echo "$(date -d "$finished" +%s.%N) $(date -d "$started" +%s.%N)"
  } | awk '{ print $1 - $2 }'
  get -X DELETE "$service/v1/tables/$digest"
}
for _ in $(seq "$fits"); do
  fit >>alone
  # Sends 200 requests per second until it is stopped.
  hey -z 1h -c 8 -q 25 "$table" >asked.hey & asker=$!
  pids+=("$asker")
  fit >>asked
  kill -INT "$asker"
  wait "$asker"
  pids=("$server")
  ! grep -hE 'Error distribution|^ *\[[^2][0-9]+\].*responses' asked.hey >&2 || exit 1
  awk '/Requests\/sec:/ { print $2 }' asked.hey >>rates
done
slowed=$(paste alone asked | awk '{ print ($2 / $1 - 1) * 100 }' | median %.1f)
row "a fit of $(median %.2f <alone) s, slowdown by 200 requests per second" "$slowed" 5 %
# If hey does not reach its rate, the measurement is invalid.
[ "$(median %.0f <rates)" -ge 190 ] || { echo '*** hey sent fewer than 190 requests per second' >&2; missed=1; }
exit $missed
