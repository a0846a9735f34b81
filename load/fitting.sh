#!/usr/bin/env bash
# How long requests wait while the service fits, and a fit's time while it answers requests.
. "$(dirname "$0")/common.sh"
need wrk hey curl jq
fits=${FITS:-7}

start_service
table=$service/v1/tables/$(table_of "$(submit '{"preset":"draft"}')")
# A file counts as unchanged once it is some seconds old.
sleep 5
get -o /dev/null "$table"

# Prints the time in ms within which 99 of 100 requests are answered.
p99() { by_wrk --latency "$1" | awk '$1 == "99%" { print $2 * ($2 ~ /us$/ ? .001 : $2 ~ /ms$/ ? 1 : 1000) }'; }

# A fit that ended before the requests did is replaced by a larger one.
for ((nodes = 16; ; nodes += 8)); do
  long=$(submit "{\"preset\":\"best\",\"resolution\":{\"alpha\":$nodes,\"ratio\":$nodes,\"theta\":$nodes,\"phi\":$nodes}}")
  until get "$service/v1/jobs/$long" | jq -e '.progress.entries_done > 0' >/dev/null; do sleep 0.1; done
  rm -f jobs.p99 tables.p99
  for _ in $(seq "$rounds"); do
    p99 "$service/v1/jobs/$long" >>jobs.p99
    p99 "$table" >>tables.p99
  done
  left=$(get -X DELETE "$service/v1/jobs/$long" | jq -r 'select(.state == "cancelled") | .progress.seconds_left')
  [ -z "$left" ] || break
done
echo "While the service fits, 64 connections that ask without a pause, median of $rounds rounds of $seconds s, by turns:"
printf '%-60s %9s %9s\n' '' now 'at most'
row 'a job, 99 of 100 answered within' "$(median %.1f <jobs.p99)" 20 ms
row 'a table, 99 of 100 answered within' "$(median %.1f <tables.p99)" 50 ms

# Prints the processor time of a process in seconds, without that of its threads whose names begin with fit or measure.
cpu() {
  cat "/proc/$1/stat" "/proc/$1"/task/*/stat 2>/dev/null | awk -v hz="$(getconf CLK_TCK)" '
    NR == 1 { ticks = $14 + $15 } NR > 1 && $2 ~ /^\((fit|measure)-/ { ticks -= $14 + $15 } END { print ticks / hz }'
}
# Fits one recipe anew and prints a line: the job's seconds, and the service's processor time beside the fit in that time.
fit() {
  local before digest
  before=$(cpu "$server")
  id=$(submit '{"preset":"paper","resolution":{"alpha":12,"ratio":10,"theta":12,"phi":10}}')
  digest=$(table_of "$id")
  get "$service/v1/jobs/$id" | jq -r '[.started_at, .finished_at] | @tsv' | {
    read -r started finished
    echo "$(date -d "$finished" +%s.%N) $(date -d "$started" +%s.%N) $(cpu "$server") $before"
  } | awk '{ print $1 - $2, $3 - $4 }'
  get -X DELETE "$service/v1/tables/$digest"
}
# 200 requests a second, half of them for the job of that recipe and half for another table, until they are stopped.
ask() {
  hey -z 1h -c 4 -q 25 "$service/v1/jobs/$id" >jobs.hey & askers=($!)
  hey -z 1h -c 4 -q 25 "$table" >tables.hey & askers+=($!)
  pids+=("${askers[@]}")
}
stop_asking() {
  for asker in "${askers[@]}"; do cpu "$asker"; done | awk '{ sum += $1 } END { print sum }' >cpu.hey
  kill -INT "${askers[@]}"
  wait "${askers[@]}"
  pids=("$server")
  ! grep -hE 'Error distribution|^ *\[[^2][0-9]+\].*responses' ./*.hey >&2 || return 1
  # Requests a second, the part of all cores that the askers took, and the ms within which 99 of 100 were answered.
  awk -v cores="$(nproc)" '
    FILENAME == "cpu.hey" { cpu = $1 }
    /Total:/ { time = $2 } /Requests\/sec:/ { rate += $2 } / 99% in/ { if ($3 > slowest) slowest = $3 }
    END { print rate, cpu / time / cores * 100, slowest * 1000 }' cpu.hey jobs.hey tables.hey
}

for _ in $(seq "$fits"); do
  fit >>alone
  ask
  fit >>asked
  stop_asking >>askers
done
# Prints the median of a column of a file.
column() { awk -v column="$2" '{ print $column }' "$1" | median "${3:-%.2f}"; }
rate=$(column askers 1 %.0f)
# Of each fit with its neighbour without requests: what else the machine does changes less between them.
slowed=$(paste alone asked | awk '{ print ($3 / $1 - 1) * 100 }' | median %.1f)
answers=$(awk -v a="$(column asked 2)" -v b="$(column alone 2)" -v s="$(column asked 1)" -v cores="$(nproc)" \
  'BEGIN { printf "%.1f", (a - b) / s / cores * 100 }')
row "a fit of $(column alone 1) s takes longer with 200 requests a second by" "$slowed" 5 %
echo "  median of $fits pairs of fits; $rate requests a second were answered, 99 of 100 within $(column askers 3 %.1f) ms;"
echo "  of all cores the answers took $answers %, what sent the requests $(column askers 2 %.1f) %."
# A generator that cannot keep its rate slows nothing down.
[ "$rate" -ge 190 ] || { echo '*** fewer requests than 200 a second' >&2; missed=1; }
exit $missed
