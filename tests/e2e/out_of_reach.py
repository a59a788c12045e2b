"""Devices that nobody gets an answer from."""

import socket


class Silent:
    """Takes connections (the kernel does) and never answers."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        self.port = self.listener.getsockname()[1]


class BlackHole:
    """Does not even take a connection: its queue is full, and the kernel drops what asks for more."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0), backlog=0)
        self.port = self.listener.getsockname()[1]
        self.waiting = []
        while not self.full():
            pass

    def full(self):
        client = socket.socket()
        client.settimeout(0.3)
        self.waiting.append(client)
        try:
            client.connect(("127.0.0.1", self.port))
        except TimeoutError:
            return True
        return False
