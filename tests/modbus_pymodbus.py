#!/usr/bin/env python3
"""A Modbus/TCP server of pymodbus, unit 1, with a few values; its port is the first line of its output.

Discrete input 19 is on; input registers 0 and 1 hold 1 and 2; coils and holding registers are 0.
"""

import asyncio
import socket
import sys
import threading
import time

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext

try:
    from pymodbus.server.async_io import ModbusTcpServer  # 3.0, of Debian 12
except ImportError:
    from pymodbus.server import ModbusTcpServer  # 3.8, of Debian 13

FIRST = 1  # pymodbus counts a block's places from 1 where the protocol counts from 0


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


async def serve(port):
    unit = ModbusSlaveContext(
        di=ModbusSequentialDataBlock(FIRST, [0] * 19 + [1]),
        co=ModbusSequentialDataBlock(FIRST, [0] * 20),
        hr=ModbusSequentialDataBlock(FIRST, [0] * 20),
        ir=ModbusSequentialDataBlock(FIRST, [1, 2]),
    )
    context = ModbusServerContext(slaves={1: unit}, single=False)
    await ModbusTcpServer(context, address=("127.0.0.1", port)).serve_forever()


def listens(port):
    with socket.socket() as client:
        return client.connect_ex(("127.0.0.1", port)) == 0


if __name__ == "__main__":
    chosen = free_port()
    threading.Thread(target=lambda: asyncio.run(serve(chosen)), daemon=True).start()
    while not listens(chosen):
        time.sleep(0.02)
    print(chosen, flush=True)
    sys.stdin.read()  # until the test that started it is gone
