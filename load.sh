#!/usr/bin/env bash
# Requests for one table of the service and of nginx, by turns, with 64 connections that stay open.
set -euo pipefail
shopt -s inherit_errexit

for tool in nginx wrk ab curl jq; do
  # Debian has nginx where only root looks.
  PATH=$PATH:/usr/sbin command -v "$tool" >/dev/null || { echo "*** SKIPPED: no $tool, and nothing was measured" >&2; exit 0; }
done
PATH=$PATH:/usr/sbin
ltcforge=$(realpath "${LTCFORGE:?the path of the ltcforge binary}")
seconds=${SECONDS_EACH:-4}
rounds=${ROUNDS:-3}
work=$(mktemp -d)
pids=()
trap 'kill -TERM "${pids[@]}" 2>/dev/null || true; wait || true; rm -rf "$work"' EXIT
export no_proxy='*'

# In a folder without a configuration file.
cd "$work"
coproc SERVER { exec "$ltcforge" serve --listen 127.0.0.1:0 --data data 2>serve.log; }
pids+=("$SERVER_PID")
read -r _ _ service <&"${SERVER[0]}" || { cat serve.log >&2; exit 1; }
id=$(curl -sS --fail-with-body -d '{"preset":"draft"}' "$service/v1/jobs" | jq -r .id)
until digest=$(curl -sS --fail-with-body "$service/v1/jobs/$id" | jq -er .table); do sleep 0.2; done
ours=$service/v1/tables/$digest
mkdir files
curl -sS --fail-with-body -o files/table "$ours"
bytes=$(stat -c %s files/table)

# Port 0 is not for nginx; a port below those that systems give to clients is most likely free.
port=$((20000 + RANDOM % 10000))
cat >nginx.conf <<CONF
daemon off;
worker_processes auto;
pid $work/nginx.pid;
error_log $work/nginx.log;
events { worker_connections 1024; }
http {
  access_log off;
  sendfile on;
  tcp_nopush on;
  keepalive_requests 1000000000;
  client_body_temp_path $work/body;
  proxy_temp_path $work/proxy;
  fastcgi_temp_path $work/fastcgi;
  uwsgi_temp_path $work/uwsgi;
  scgi_temp_path $work/scgi;
  server { listen 127.0.0.1:$port; root $work/files; }
}
CONF
# Its workers run as another user when root starts it.
chmod -R a+rX "$work"
nginx -c "$work/nginx.conf" 2>nginx.out & pids+=($!)
theirs=http://127.0.0.1:$port/table
curl -s --retry 20 --retry-delay 1 --retry-connrefused -o nginx.table "$theirs" || { cat nginx.log nginx.out >&2; exit 1; }
cmp nginx.table files/table
# A file counts as unchanged once it is some seconds old.
sleep 5
curl -sS --fail-with-body -o /dev/null "$ours"

tag() { curl -sSI "$1" | tr -d '\r' | sed -n 's/^etag: *//Ip'; }
# Prints requests a second: URL and, for wrk, fields.
by_wrk() {
  local out
  out=$(wrk -t2 -c64 -d"$seconds" "${@:2}" "$1")
  ! grep -E 'Non-2xx|Socket errors' <<<"$out" >&2 || return 1
  sed -n 's/^Requests\/sec: *//p' <<<"$out"
}
# wrk waits for the body of an answer to HEAD, which has none.
by_ab() {
  local out
  out=$(ab -q -k -i -c64 -t"$seconds" -n 2000000 "$1" 2>&1)
  ! grep -E 'Non-2xx|Failed requests: +[1-9]' <<<"$out" >&2 || return 1
  sed -n 's/^Requests per second: *\([0-9.]*\).*/\1/p' <<<"$out"
}
rate() {
  case $1 in
    GET) by_wrk "$2" ;;
    HEAD) by_ab "$2" ;;
    304) by_wrk "$2" -H "If-None-Match: $(tag "$2")" ;;
    Range) by_wrk "$2" -H 'Range: bytes=0-1023' ;;
  esac
}
median() { sort -g | awk '{ all[NR] = $1 } END { printf "%.0f", all[int((NR + 1) / 2)] }'; }

echo "A table of $bytes bytes, 64 connections, median of $rounds rounds of $seconds s, by turns; requests a second:"
printf '%-6s %9s %9s %7s %6s\n' '' nginx ltcforge part least
missed=0
for row in 'GET 0.8' 'HEAD 0.5' '304 0.5' 'Range 0.5'; do
  read -r kind least <<<"$row"
  rm -f nginx.rates ltcforge.rates
  for _ in $(seq "$rounds"); do
    rate "$kind" "$theirs" >>nginx.rates
    rate "$kind" "$ours" >>ltcforge.rates
  done
  nginx=$(median <nginx.rates) service=$(median <ltcforge.rates)
  awk -v kind="$kind" -v a="$nginx" -v b="$service" -v least="$least" \
    'BEGIN { printf "%-6s %9d %9d %7.2f %6s\n", kind, a, b, b / a, least; exit !(b / a >= least) }' || missed=1
done
exit $missed
