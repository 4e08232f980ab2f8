"""A TCP port that nobody listens on at this moment, and that the system gives to nobody who does not ask for it."""
import random
import socket


def free_port():
    while True:
        with socket.socket() as s:
            port = random.randrange(20000, 32768)
            try:
                s.bind(("localhost", port))
            except OSError:
                continue
        return port


if __name__ == "__main__":
    print(free_port())
