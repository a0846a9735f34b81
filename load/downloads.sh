#!/usr/bin/env bash
# Compares downloads of one table from the service and from nginx, in turns. The service must be half as fast as nginx.
. "$(dirname "$0")/common.sh"
# Debian installs nginx in /usr/sbin.
PATH=$PATH:/usr/sbin
need nginx wrk curl jq

start_service
digest=$(table_of "$(submit '{"preset":"draft"}')")
ours=$service/v1/tables/$digest
mkdir files
get -o files/table "$ours"
bytes=$(stat -c %s files/table)

# nginx cannot choose a free port. Ports below the range for outgoing connections are usually free.
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
# If root starts nginx, its workers run as another user.
chmod -R a+rX "$work"
nginx -c "$work/nginx.conf" 2>nginx.out & pids+=($!)
theirs=http://127.0.0.1:$port/table
curl -s --retry 20 --retry-delay 1 --retry-connrefused -o nginx.table "$theirs" || { cat nginx.log nginx.out >&2; exit 1; }
cmp nginx.table files/table

tag() { curl -sSI "$1" | tr -d '\r' | sed -n 's/^etag: *//Ip'; }
# Prints requests per second.
rate() {
  local fields=()
  case $1 in
    304) fields=(-H "If-None-Match: $(tag "$2")") ;;
    Range) fields=(-H 'Range: bytes=0-1023') ;;
  esac
  by_wrk "${fields[@]}" "$2" | sed -n 's/^Requests\/sec: *//p'
}
echo "A table of $bytes bytes, 64 connections, median of $rounds rounds of $seconds s in turns, requests per second:"
printf '%-6s %9s %9s %7s %6s\n' '' nginx ltcforge ratio least
for kind in GET 304 Range; do
  rm -f nginx.rates ltcforge.rates
  for _ in $(seq "$rounds"); do
    rate "$kind" "$theirs" >>nginx.rates
    rate "$kind" "$ours" >>ltcforge.rates
  done
  awk -v kind="$kind" -v a="$(median %.0f <nginx.rates)" -v b="$(median %.0f <ltcforge.rates)" \
    'BEGIN { printf "%-6s %9d %9d %7.2f %6s\n", kind, a, b, b / a, 0.5; exit !(b / a >= 0.5) }' || missed=1
done
exit $missed
