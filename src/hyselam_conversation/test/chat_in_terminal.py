#!/usr/bin/python3
"""Talks with `chat --offline` in a terminal of its own and prints what it shows: chat_in_terminal.py CHAT LINE..."""
import os
import pty
import sys


def read_until(terminal, prompt):
    shown = b""
    while not shown.endswith(prompt):
        shown += os.read(terminal, 1)
    return shown


def main():
    process, terminal = pty.fork()
    if process == 0:
        os.environ["TERM"] = "dumb"
        os.execv(sys.argv[1], [sys.argv[1], "--offline", "--start", "SS04"])
    prompt = b"You:   "
    shown = read_until(terminal, prompt)
    for line in sys.argv[2:]:
        os.write(terminal, line.encode() + b"\n")
        read_until(terminal, b"\n")  # the line itself, which the terminal shows
        shown += b"\n" + read_until(terminal, prompt)
    os.write(terminal, b"\x04")
    _, status = os.waitpid(process, 0)
    sys.stdout.write(shown.decode())
    return os.waitstatus_to_exitcode(status)


if __name__ == "__main__":
    sys.exit(main())
