#!/bin/sh
# Lapwing as a node of roslaunch, which adds words of its own (__name:=…, __log:=…): these are left out.
for word in "$@"; do
    shift
    case "$word" in
        *:=*) ;;
        *) set -- "$@" "$word" ;;
    esac
done
exec lapwing monitor "$@"
