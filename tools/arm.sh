#!/bin/sh
# A compiler and an emulator for a Cortex-M, on which generated C is run (xtask/tests/cortex.rs): gcc-arm-none-eabi with newlib, and
# qemu-system-arm, from the distribution.
#
# Does only what is missing: a second run takes no time.
set -eu

if ! command -v arm-none-eabi-gcc >/dev/null 2>&1 || ! command -v qemu-system-arm >/dev/null 2>&1 ||
    [ ! -e "$(arm-none-eabi-gcc -mcpu=cortex-m3 -mthumb -print-file-name=rdimon.specs)" ]; then
    if [ "$(id -u)" -eq 0 ]; then run=; else run=sudo; fi
    $run apt-get update -qq
    DEBIAN_FRONTEND=noninteractive $run apt-get install -y -qq --no-install-recommends \
        gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm >/dev/null
fi

echo "a Cortex-M is ready: $(arm-none-eabi-gcc -dumpversion), $(qemu-system-arm --version | head -n 1)"
