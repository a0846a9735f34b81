#!/usr/bin/env bash
# Runs the service on an empty store, submits a recipe with preset `paper`, and downloads the table by its digest.
set -euo pipefail
shopt -s inherit_errexit

ltcforge=$(realpath "${LTCFORGE:?the path of the ltcforge binary}")
mkdir -p demo
cd demo
rm -rf data
started=$(date +%s%N)

# Port 0 selects a free port. The first line on stdout contains the URL.
coproc SERVER { exec "$ltcforge" serve --listen 127.0.0.1:0 --data data 2>serve.log; }
server_pid=$SERVER_PID
trap 'kill -TERM "$server_pid" 2>/dev/null || true' EXIT
read -r _ _ url <&"${SERVER[0]}" || { echo 'the service did not start:' >&2; cat serve.log >&2; exit 1; }
echo "The service runs on $url."
# A proxy cannot reach the service.
export no_proxy='*'

job=$(curl -sS --fail-with-body -d '{"preset":"paper"}' "$url/v1/jobs")
id=$(jq -r .id <<<"$job")
echo "Job $id fits $(jq -r .progress.entries_total <<<"$job") lobes."
# Server-Sent Events: each `data:` line is the current job. The stream ends with the job.
curl -sSN "$url/v1/jobs/$id/events" | sed -un 's/^data: *//p' |
  jq -r --unbuffered '"  \(.state): " + (.progress | "\(.entries_done) of \(.entries_total)" +
    if .seconds_left then ", \(.seconds_left | ceil) s left" else "" end)' |
  uniq
digest=$(curl -sS --fail-with-body "$url/v1/jobs/$id" | jq -er .table)
echo "Done after $((($(date +%s%N) - started) / 1000000)) ms: $digest"

hex=${digest#sha256:}
curl -sS --fail-with-body -o "$hex.safetensors" "$url/v1/tables/$hex"
curl -sS --fail-with-body -o "$hex.manifest.json" "$url/v1/tables/$hex/manifest"
echo "$hex  $hex.safetensors" | sha256sum --check

kill -TERM "$server_pid"
trap - EXIT
wait "$server_pid"

"$ltcforge" preview "$hex.safetensors" -o strip.png --scene figure14 --mode strip

echo "The picture:  demo/strip.png"
echo "The table:    demo/$hex.safetensors ($(stat -c %s "$hex.safetensors") bytes)"
echo "Its manifest: demo/$hex.manifest.json"
jq -r '.report | "Its error:    between nodes, \(.between.width.mean * 1e3 | round / 10) % of the width of the lobe on average, \(.between.width.max * 1e3 | round / 10) % at most.\nIts worst node: \(.nodes.worst[0] | "alpha_x \(.alpha_x), alpha_y \(.alpha_y), theta \(.theta), phi \(.phi)")"' "$hex.manifest.json"
