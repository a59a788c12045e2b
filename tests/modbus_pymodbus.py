#!/usr/bin/env python3
"""A Modbus/TCP server of pymodbus, unit 1, with a few values; its port is the first line of its output.

Discrete input 19 is on; input registers 0 and 1 hold 1 and 2; coils and holding registers are 0.
"""

import asyncio
import sys
import threading

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server.async_io import ModbusTcpServer


async def serve():
    unit = ModbusSlaveContext(
        di=ModbusSequentialDataBlock(0, [0] * 19 + [1]),
        co=ModbusSequentialDataBlock(0, [0] * 20),
        hr=ModbusSequentialDataBlock(0, [0] * 20),
        ir=ModbusSequentialDataBlock(0, [1, 2]),
        zero_mode=True,
    )
    server = ModbusTcpServer(ModbusServerContext(slaves={1: unit}, single=False), address=("127.0.0.1", 0))
    running = asyncio.ensure_future(server.serve_forever())
    await server.serving
    print(server.server.sockets[0].getsockname()[1], flush=True)
    await running


if __name__ == "__main__":
    threading.Thread(target=lambda: asyncio.run(serve()), daemon=True).start()
    sys.stdin.read()  # until the test that started it is gone
