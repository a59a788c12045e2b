#!/usr/bin/python3
"""plantsim as a foreign Modbus client sees it: pymodbus, mbpoll, and sockets that say anything at all.

usage: plantsim_test.py PLANTSIM   (needs python3-pymodbus and mbpoll)
"""
import json
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import types
import unittest

from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ModbusException

PLANTSIM = os.path.abspath(sys.argv.pop(1))
READ_COIL = bytes([0, 1, 0, 0, 0, 6, 1, 1, 0, 0, 0, 1])


class Plantsim:
    """One running plantsim on a port of the kernel's choice."""

    def __init__(self, *options):
        self.process = subprocess.Popen([PLANTSIM, "--port", "0", *options], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.fullmatch(r"plantsim: listening on 127\.0\.0\.1:(\d+)\n", line)
        assert found, f"no ready line but {line!r}"
        self.port = int(found.group(1))
        self.clients = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for client in self.clients:
            client.close()
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def client(self):
        client = ModbusTcpClient("127.0.0.1", port=self.port, timeout=3)
        assert client.connect()
        self.clients.append(client)
        return client

    def socket(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=3)

    def stop(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        self.process.wait(timeout=5)
        return self.process.returncode


def until(condition, limit_s=10.0):
    """True as soon as the condition is, False after the limit."""
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return False


def answers(plant):
    """Whether a new client is let in and answered."""
    try:
        return not plant.client().read_coils(0, count=1, slave=1).isError()
    except (AssertionError, OSError, ModbusException):
        return False


def bit(client, unit, address):
    return client.read_discrete_inputs(address, count=1, slave=unit).bits[0]


class Foreign(unittest.TestCase):
    def test_client_reads_and_writes_every_table_of_every_unit(self):
        with Plantsim() as plant:
            client = plant.client()
            for unit in (1, 2, 3, 4):
                self.assertEqual(client.read_discrete_inputs(0, count=20, slave=unit).bits[5], True)
                registers = client.read_input_registers(0, count=7, slave=unit).registers
                self.assertEqual(registers[2:5], [1, 50, 50])
                self.assertFalse(client.write_coils(0, [True] + 8 * [False], slave=unit).isError())
                self.assertFalse(client.write_coil(4, True, slave=unit).isError())
                self.assertEqual(client.read_coils(0, count=9, slave=unit).bits[:9],
                                 [True, False, False, False, True, False, False, False, False])
                self.assertFalse(client.write_register(0, unit, slave=unit).isError())
                self.assertFalse(client.write_registers(0, [unit, 9], slave=unit).isError())
                self.assertEqual(client.read_holding_registers(0, count=2, slave=unit).registers, [unit, 9])

    def test_pallet_driven_by_a_client_reaches_the_position_and_its_code_is_read(self):
        with Plantsim("--codes", "102", "--speed", "5") as plant:
            client = plant.client()
            client.write_coil(0, True, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 0)), "no pallet at the entry")
            client.write_coil(1, True, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 1)), "no pallet in the transfer zone")
            client.write_coil(1, False, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 2)), "no pallet in position")
            client.write_coil(4, True, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 15)), "no code")
            self.assertEqual(client.read_input_registers(0, count=2, slave=1).registers, [0, 102])

    def test_mbpoll_reads_the_levels(self):
        with Plantsim() as plant:
            command = f"mbpoll -m tcp -p {plant.port} -a 2 -t 3 -r 4 -c 4 -1 127.0.0.1"
            out = subprocess.run(command.split(), capture_output=True, text=True, timeout=10)
            self.assertEqual(out.returncode, 0, out.stderr)
            self.assertEqual(re.findall(r"\[\d\]:\s+(\d+)", out.stdout), ["50", "50", "50", "50"])

    def test_unknown_unit_is_refused_as_gateway_target_failed(self):
        with Plantsim() as plant:
            self.assertEqual(plant.client().read_coils(0, count=1, slave=5).exception_code, 0x0B)

    def test_address_beyond_the_table_is_refused(self):
        with Plantsim() as plant:
            client = plant.client()
            self.assertEqual(client.read_coils(9, count=1, slave=1).exception_code, 2)
            self.assertEqual(client.read_discrete_inputs(0, count=21, slave=1).exception_code, 2)
            self.assertEqual(client.write_register(2, 1, slave=1).exception_code, 2)

    def test_unit_without_writes_drops_its_coils(self):
        with Plantsim("--watchdog", "200ms") as plant:
            client = plant.client()
            client.write_coils(0, [True] + 6 * [False] + [True], slave=1)
            self.assertTrue(client.read_coils(0, count=1, slave=1).bits[0])
            self.assertTrue(until(lambda: not client.read_coils(0, count=1, slave=1).bits[0], 2))
            self.assertTrue(client.read_coils(7, count=1, slave=1).bits[0], "the gripper was to hold")

    def test_injected_fault_shows_at_its_time(self):
        with Plantsim("--inject", "sensor:2.pallet_in_position=1@300ms+500ms") as plant:
            client = plant.client()
            self.assertFalse(bit(client, 2, 2))
            self.assertTrue(until(lambda: bit(client, 2, 2), 2))
            self.assertTrue(until(lambda: not bit(client, 2, 2), 2))


class Hostile(unittest.TestCase):
    def test_garbage_closes_its_connection_and_no_other(self):
        with Plantsim() as plant:
            good = plant.client()
            for text in (b"GET / HTTP/1.0\r\n\r\n", b"\xff" * 300, bytes([0, 1, 0, 0, 0, 0]),
                         bytes([0, 1, 0, 0, 255, 255, 1, 1]), bytes([0, 1, 0, 0, 0, 1, 1])):
                with plant.socket() as bad:
                    bad.sendall(text)
                    try:
                        self.assertEqual(bad.recv(100), b"", text)
                    except ConnectionResetError:
                        pass  # closed with our bytes unread: just as good
                self.assertFalse(good.read_coils(0, count=1, slave=1).isError())

    def test_random_bytes_do_not_end_it(self):
        with Plantsim() as plant:
            source = random.Random(1)
            for _ in range(200):
                with plant.socket() as bad:
                    body = source.randbytes(source.randrange(1, 200))
                    bad.sendall(struct.pack(">HHH", 1, 0, source.choice([len(body), 5, 254, 300])) + body)
            # The server notices closed connections in its own time; until then its limit may be reached.
            self.assertTrue(until(lambda: answers(plant), 10), "it does not answer after random bytes")
            self.assertIsNone(plant.process.poll())

    def test_twenty_clients_are_each_answered(self):
        with Plantsim() as plant:
            clients = [plant.client() for _ in range(20)]
            for turn in range(10):
                for number, client in enumerate(clients):
                    unit = number % 4 + 1
                    self.assertFalse(client.write_register(1, turn * 100 + number, slave=unit).isError())
                    self.assertEqual(client.read_holding_registers(1, count=1, slave=unit).registers,
                                     [turn * 100 + number])

    def test_client_beyond_the_limit_is_turned_away_and_let_in_when_one_leaves(self):
        with Plantsim() as plant:
            held = [plant.socket() for _ in range(64)]
            for one in held:
                one.sendall(READ_COIL)
                self.assertEqual(len(one.recv(100)), 10)
            with plant.socket() as extra:
                self.assertEqual(extra.recv(100), b"")
            held[0].close()
            time.sleep(0.1)
            with plant.socket() as extra:
                extra.sendall(READ_COIL)
                self.assertEqual(len(extra.recv(100)), 10)
            for one in held:
                one.close()

    def test_requests_in_one_piece_and_byte_by_byte_are_all_answered_in_order(self):
        with Plantsim() as plant, plant.socket() as raw:
            asked = b"".join(struct.pack(">HHHBBHH", n, 0, 6, 1, 4, 2, 1) for n in range(500))
            raw.sendall(asked)
            got = b""
            while len(got) < 500 * 11:
                got += raw.recv(65536)
            numbers = [struct.unpack_from(">H", got, 11 * n)[0] for n in range(500)]
            self.assertEqual(numbers, list(range(500)))
            for byte in READ_COIL:
                raw.sendall(bytes([byte]))
                time.sleep(0.002)
            self.assertEqual(len(raw.recv(100)), 10)

    def test_client_that_reads_nothing_delays_no_other(self):
        with Plantsim() as plant, plant.socket() as deaf:
            deaf.setblocking(False)
            try:
                for _ in range(100_000):
                    deaf.send(READ_COIL)
            except BlockingIOError:
                pass
            start = time.monotonic()
            self.assertFalse(plant.client().read_coils(0, count=1, slave=1).isError())
            self.assertLess(time.monotonic() - start, 1.0)


class Life(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="plantsim_test.")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def refused(self, *options):
        out = subprocess.run([PLANTSIM, *options], capture_output=True, text=True, timeout=10)
        return out.returncode, out.stderr

    def test_port_in_use_is_said_with_its_own_status(self):
        with Plantsim() as plant:
            status, said = self.refused("--port", str(plant.port))
            self.assertEqual(status, 69)
            where = f"127.0.0.1:{plant.port}"
            self.assertEqual(said, f"plantsim: cannot listen on {where}: Address already in use\n")

    def test_bad_option_is_said_with_what_is_allowed(self):
        for options, words in (("--prot=1", 'unknown option "--prot=1"'), ("--port=x", "0 to 65535"),
                               ("--bind=here", "not an IPv4 address"), ("--step=1s", "100 ms"),
                               ("--inject=sensor:2.foo=1", "pallet_at_entry")):
            status, said = self.refused(options)
            self.assertEqual(status, 64, options)
            self.assertIn(words, said)

    def test_help_names_every_option_and_succeeds(self):
        out = subprocess.run([PLANTSIM, "--help"], capture_output=True, text=True, timeout=10)
        self.assertEqual(out.returncode, 0)
        for option in ("--port", "--bind", "--state", "--inject", "--ledger", "--watchdog"):
            self.assertIn(option, out.stdout)

    def test_damaged_state_is_refused_by_name(self):
        with open(self.path("state"), "w", encoding="utf-8") as file:
            file.write("stationd-plant-state 1\n0 0 0\nend 5\n")
        status, said = self.refused("--port", "0", "--state", self.path("state"))
        self.assertEqual(status, 65)
        self.assertIn(self.path("state"), said)

    def test_ready_file_names_the_port(self):
        with Plantsim("--ready-file", self.path("ready")) as plant:
            self.assertTrue(until(lambda: os.path.exists(self.path("ready"))))
            with open(self.path("ready"), encoding="utf-8") as file:
                self.assertEqual(file.read(), f"127.0.0.1:{plant.port}\n")

    def test_signal_ends_it_with_ledger_and_state_written(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            with Plantsim("--ledger", self.path("ledger"), "--state", self.path("state")) as plant:
                time.sleep(0.5)
                self.assertEqual(plant.stop(number), 0)
            with open(self.path("ledger"), encoding="utf-8") as file:
                ledger = json.load(file)
            self.assertTrue(ledger["final"])
            self.assertEqual(ledger["verdict"]["pallets"], 1)
            self.assertEqual(ledger["pallets"][0]["fate"], "in_cell")
            self.assertTrue(os.path.exists(self.path("state")))

    def test_plant_killed_and_started_again_goes_on_with_its_pallets(self):
        options = ("--state", self.path("state"), "--codes", "103", "--speed", "5")
        with Plantsim(*options) as plant:
            client = plant.client()
            client.write_coil(0, True, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 0)))
            client.write_coil(1, True, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 2)))
            client.write_coils(0, 9 * [False], slave=1)
            time.sleep(0.5)
            self.assertEqual(plant.stop(signal.SIGKILL), -signal.SIGKILL)
        with Plantsim(*options) as plant:
            client = plant.client()
            self.assertTrue(bit(client, 1, 2), "the pallet is gone")
            client.write_coil(4, True, slave=1)
            self.assertTrue(until(lambda: bit(client, 1, 15)))
            self.assertEqual(client.read_input_registers(0, count=2, slave=1).registers, [0, 103])

    def test_ledger_is_whole_json_whenever_it_is_read(self):
        with Plantsim("--ledger", self.path("ledger"), "--speed", "100"):
            self.assertTrue(until(lambda: os.path.exists(self.path("ledger"))))
            for _ in range(200):
                with open(self.path("ledger"), encoding="utf-8") as file:
                    json.load(file)
                time.sleep(0.005)


if __name__ == "__main__":
    unittest.main(verbosity=2)
