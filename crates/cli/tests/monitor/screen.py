"""A terminal for `lapwing monitor`, by a pseudo-terminal that answers no questions: screen.py COLUMNS LINES COMMAND...

Prints what was written on it, without escapes, until the command ends; a line of its own input is typed as it is. Ends with the command, and the command with its input.
"""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import sys
import termios

columns, lines, *command = sys.argv[1:]
pid, terminal = pty.fork()
if pid == 0:
    # Whoever starts here waits until the terminal has its size.
    sys.stdin.readline()
    os.environ["TERM"] = "xterm-256color"
    os.execvp(command[0], command)
fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", int(lines), int(columns), 0, 0))
os.write(terminal, b"\n")
while True:
    ready, _, _ = select.select([terminal, sys.stdin], [], [])
    if sys.stdin in ready:
        typed = os.read(0, 100)
        if not typed:
            os.kill(pid, signal.SIGKILL)
            break
        os.write(terminal, typed.rstrip(b"\n"))
    if terminal in ready:
        try:
            written = os.read(terminal, 1 << 16)
        except OSError:
            written = b""
        if not written:
            break
        print(re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", " ", written.decode(errors="replace")), flush=True)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
