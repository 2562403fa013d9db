#!/bin/sh
# A browser and what drives it, for the tests of the report page (crates/page/tests/browser).
#
# Installs Chromium from the distribution, and playwright into .venv beside this folder's parent.
# Does only what is missing: a second run takes no time.
set -eu

cd "$(dirname "$0")/.."

if [ ! -x .venv/bin/python ]; then
    python3 -m venv .venv
fi
if ! .venv/bin/python -c 'import playwright.sync_api' 2>/dev/null; then
    .venv/bin/pip install --quiet 'playwright>=1.50,<2'
fi

if ! command -v chromium >/dev/null 2>&1; then
    if [ "$(id -u)" -eq 0 ]; then run=; else run=sudo; fi
    $run apt-get update -qq
    DEBIAN_FRONTEND=noninteractive $run apt-get install -y -qq --no-install-recommends chromium fonts-dejavu-core >/dev/null
fi

echo "a browser is ready: $(command -v chromium), driven from .venv"
