"""The loader's coils as its device has them, by pymodbus: scenarios that use it run /usr/bin/python3."""

from pymodbus.client import ModbusTcpClient

GRIPPER = 7  # its safe value is `hold`: it keeps what the device has
LOADER = 1


class Field:
    """The loader's coils as the device has them."""

    def __init__(self, port):
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=3)
        self.client.connect()

    def coils(self):
        return [int(bit) for bit in self.client.read_coils(0, count=8, slave=LOADER).bits[:8]]

    def set_all(self):
        self.client.write_coils(0, [True] * 8, slave=LOADER)

    def others(self):
        return sum(self.coils()[:GRIPPER])
