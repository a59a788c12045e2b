#!/usr/bin/env python3
"""A small Modbus/TCP server that misbehaves on demand: modbus_faults.py [UNIT]

Serves one unit with 200 places in each table on 127.0.0.1, on a port that the kernel picks and that is the
first line of its output. Lines on its input, each answered by one line:

    fault NAME             good, silent, close, reset, wrong-unit, wrong-transaction,
                           wrong-function, wrong-protocol, wrong-count, wrong-echo, short, garbage,
                           exception, drip, twice, late
    set TABLE ADDRESS N... get TABLE ADDRESS COUNT          TABLE: co, di, hr, ir
    requests               "FUNCTION:FIRST:COUNT ..." since the last time it was asked
    connections            how many were accepted so far
"""

import random
import socket
import struct
import sys
import threading
import time

LATE_S = 0.4
DRIP_S = 0.05


class Unit:
    """The four tables and what was asked of them."""

    def __init__(self, number):
        self.number = number
        self.tables = {name: [0] * 200 for name in ("co", "di", "hr", "ir")}
        self.requests = []
        self.connections = 0
        self.fault = "good"
        self.lock = threading.Lock()

    def read(self, function, first, count):
        table = self.tables[{1: "co", 2: "di", 3: "hr", 4: "ir"}[function]]
        if first + count > len(table):
            return bytes([function | 0x80, 2])
        values = table[first : first + count]
        if function > 2:
            data = struct.pack(f">{count}H", *values)
        else:
            data = bytes(
                sum(bit << i for i, bit in enumerate(values[at : at + 8])) for at in range(0, count, 8)
            )
        return bytes([function, len(data)]) + data

    def write(self, pdu):
        function, first, count = struct.unpack(">BHH", pdu[:5])
        if function == 6:
            self.tables["hr"][first] = count
        elif function == 15:
            for i in range(count):
                self.tables["co"][first + i] = pdu[6 + i // 8] >> (i % 8) & 1
        else:
            self.tables["hr"][first : first + count] = struct.unpack(f">{count}H", pdu[6:])
        return pdu[:5]

    def note(self, what):
        with self.lock:
            self.requests.append(what)

    def answer(self, pdu):
        function, first, count = struct.unpack(">BHH", pdu[:5])
        with self.lock:
            self.requests.append(f"{function}:{first}:{count}")
            return self.read(function, first, count) if function <= 4 else self.write(pdu)


def distort(fault, transaction, unit, pdu):
    """The reply's bytes as the fault has them."""
    protocol = 0
    if fault == "wrong-unit":
        unit ^= 1
    elif fault == "wrong-transaction":
        transaction ^= 1
    elif fault == "wrong-protocol":
        protocol = 1
    elif fault == "wrong-function":
        pdu = bytes([pdu[0] % 4 + 1]) + pdu[1:]
    elif fault == "wrong-count" and pdu[0] <= 4:
        pdu = pdu[:1] + bytes([pdu[1] + 2]) + pdu[2:] + b"\0\0"
    elif fault == "wrong-echo" and pdu[0] > 4:
        pdu = pdu[:4] + bytes([pdu[4] ^ 1])
    elif fault == "exception":
        pdu = bytes([pdu[0] | 0x80, 6])
    reply = struct.pack(">HHHB", transaction, protocol, len(pdu) + 1, unit) + pdu
    if fault == "short":
        reply = reply[:-1]
    elif fault == "garbage":
        reply = random.Random(1).randbytes(64)
    elif fault == "twice":
        reply += reply
    return reply


def send(connection, fault, reply):
    if fault == "drip":
        for byte in reply:
            connection.sendall(bytes([byte]))
            time.sleep(DRIP_S)
        return
    if fault == "late":
        time.sleep(LATE_S)
    connection.sendall(reply)


def serve(connection, unit):
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    stream = connection.makefile("rb")
    while header := stream.read(7):
        transaction, _, length, number = struct.unpack(">HHHB", header)
        pdu = stream.read(length - 1)
        fault = unit.fault
        if fault == "silent":
            unit.note("unanswered")
            continue
        if fault == "reset":
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        if fault in ("close", "reset"):
            break
        send(connection, fault, distort(fault, transaction, number, unit.answer(pdu)))
    stream.close()
    connection.close()


def serve_quietly(connection, unit):
    try:
        serve(connection, unit)
    except OSError:
        pass  # the peer is gone


def accept(listener, unit):
    while True:
        connection, _ = listener.accept()
        unit.connections += 1
        threading.Thread(target=serve_quietly, args=(connection, unit), daemon=True).start()


def command(unit, words):
    with unit.lock:
        if words[0] == "fault":
            unit.fault = words[1]
        elif words[0] == "set":
            values = [int(word) for word in words[3:]]
            unit.tables[words[1]][int(words[2]) : int(words[2]) + len(values)] = values
        elif words[0] == "get":
            first, count = int(words[2]), int(words[3])
            return " ".join(str(value) for value in unit.tables[words[1]][first : first + count])
        elif words[0] == "requests":
            seen, unit.requests = unit.requests, []
            return " ".join(seen)
        elif words[0] == "connections":
            return str(unit.connections)
    return "ok"


def main():
    unit = Unit(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    listener = socket.create_server(("127.0.0.1", 0))
    print(listener.getsockname()[1], flush=True)
    threading.Thread(target=accept, args=(listener, unit), daemon=True).start()
    for line in sys.stdin:
        print(command(unit, line.split()), flush=True)


if __name__ == "__main__":
    main()
