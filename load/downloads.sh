#!/usr/bin/env bash
# Requests for one table of the service and of nginx, by turns, with 64 connections that stay open.
. "$(dirname "$0")/common.sh"
# Debian has nginx where only root looks.
PATH=$PATH:/usr/sbin
need nginx wrk ab curl jq

start_service
digest=$(table_of "$(submit '{"preset":"draft"}')")
ours=$service/v1/tables/$digest
mkdir files
get -o files/table "$ours"
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
get -o /dev/null "$ours"

tag() { curl -sSI "$1" | tr -d '\r' | sed -n 's/^etag: *//Ip'; }
# wrk waits for the body of an answer to HEAD, which has none.
by_ab() {
  local out
  out=$(ab -q -k -i -c64 -t"$seconds" -n 2000000 "$1" 2>&1)
  ! grep -E 'Non-2xx|Failed requests: +[1-9]' <<<"$out" >&2 || return 1
  sed -n 's/^Requests per second: *\([0-9.]*\).*/\1/p' <<<"$out"
}
by_second() { by_wrk "$@" | sed -n 's/^Requests\/sec: *//p'; }
# Prints requests a second.
rate() {
  case $1 in
    GET) by_second "$2" ;;
    HEAD) by_ab "$2" ;;
    304) by_second -H "If-None-Match: $(tag "$2")" "$2" ;;
    Range) by_second -H 'Range: bytes=0-1023' "$2" ;;
  esac
}
echo "A table of $bytes bytes, 64 connections, median of $rounds rounds of $seconds s, by turns; requests a second:"
printf '%-6s %9s %9s %7s %6s\n' '' nginx ltcforge part least
for row in 'GET 0.8' 'HEAD 0.5' '304 0.5' 'Range 0.5'; do
  read -r kind least <<<"$row"
  rm -f nginx.rates ltcforge.rates
  for _ in $(seq "$rounds"); do
    rate "$kind" "$theirs" >>nginx.rates
    rate "$kind" "$ours" >>ltcforge.rates
  done
  nginx=$(median %.0f <nginx.rates) service=$(median %.0f <ltcforge.rates)
  awk -v kind="$kind" -v a="$nginx" -v b="$service" -v least="$least" \
    'BEGIN { printf "%-6s %9d %9d %7.2f %6s\n", kind, a, b, b / a, least; exit !(b / a >= least) }' || missed=1
done
exit $missed
