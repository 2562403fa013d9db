#!/bin/sh
# The libraries with which Foxglove opens recordings, for the test that opens ours with them (crates/sim/tests/others/foxglove.mjs).
#
# Installs them into .foxglove beside this folder's parent, and Node from the distribution where there is none.
# Does only what is missing: a second run takes no time.
set -eu

cd "$(dirname "$0")/.."

packages='@mcap/core@2.2.2 @mcap/nodejs@1.0.2 @mcap/support@1.1.0 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0'

if ! command -v npm >/dev/null 2>&1; then
    if [ "$(id -u)" -eq 0 ]; then run=; else run=sudo; fi
    $run apt-get update -qq
    DEBIAN_FRONTEND=noninteractive $run apt-get install -y -qq --no-install-recommends nodejs npm >/dev/null
fi

if [ "$(cat .foxglove/installed 2>/dev/null)" != "$packages" ]; then
    mkdir -p .foxglove
    # shellcheck disable=SC2086  # one word per package is meant
    npm install --prefix .foxglove --no-save --no-package-lock --no-audit --no-fund --ignore-scripts --loglevel error $packages >/dev/null
    echo "$packages" >.foxglove/installed
fi

echo "Foxglove's libraries are ready: .foxglove, for $(node --version)"
