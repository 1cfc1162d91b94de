# SPDX-License-Identifier: MIT
"""`rkm04://`: a port of pyserial onto a bus in this process."""

import gc
import threading
import time
import weakref

import pytest
import serial
from serial.rs485 import RS485Settings

import rkm04
from helpers import BYTE_US, VERSION, VERSION_ANSWER


@pytest.fixture
def bus():
    with rkm04.Bus() as bus:
        yield bus


@pytest.fixture
def url(bus):
    url = rkm04.publish(bus)
    yield url
    rkm04.unpublish(url)


@pytest.fixture
def port(url):
    with serial.serial_for_url(url, baudrate=19200, timeout=0.5) as port:
        yield port


def test_a_request_is_answered_and_takes_the_time_of_its_bytes(bus, port):
    assert port.write(VERSION) == 7
    assert 7 * BYTE_US - 7 <= bus.now <= 7 * BYTE_US
    assert port.read(24) == VERSION_ANSWER
    assert bus.now == pytest.approx((7 + 1 + 24) * BYTE_US, abs=40)


def test_read_waits_in_virtual_time_and_returns_at_once_in_real_time(bus, port):
    port.timeout = 3600
    begin = time.monotonic()
    assert port.read(1) == b""
    assert bus.now == 3_600_000_000
    assert time.monotonic() - begin < 60


def test_read_returns_what_has_come_when_the_timeout_is_over(bus, port):
    port.write(VERSION)
    assert port.read(100) == VERSION_ANSWER
    assert bus.now == pytest.approx(7 * BYTE_US + 500_000, abs=10)


def test_timeout_zero_does_not_wait(bus, port):
    port.timeout = 0
    port.write(VERSION)
    now = bus.now
    assert port.read(24) == b""
    assert bus.now == now
    bus.advance("20ms")
    assert port.in_waiting == 24
    assert port.read(100) == VERSION_ANSWER


def test_without_a_timeout_nothing_to_come_is_an_error(port):
    port.timeout = None
    port.write(VERSION)
    assert port.read(24) == VERSION_ANSWER
    with pytest.raises(rkm04.NothingToCome, match=r"read\(\) with timeout=None .* no byte is under way"):
        port.read(1)


def test_without_a_timeout_a_late_answer_is_waited_for(bus, port):
    bus.faults.inject("delay", delay="1000s", count=1)
    port.timeout = None
    port.write(VERSION)
    assert port.read(24) == VERSION_ANSWER
    assert bus.now > 1_000_000_000


def test_inter_byte_timeout_ends_a_read_at_a_gap(bus, port):
    port.inter_byte_timeout = 0.005
    port.write(VERSION)
    before = bus.now
    assert port.read(100) == VERSION_ANSWER
    assert bus.now - before == pytest.approx((1 + 24) * BYTE_US + 5000, abs=30)


def test_read_until_and_its_timeout(bus, port):
    port.write(VERSION)
    assert port.read_until(b"\x10") == VERSION_ANSWER[:5]
    assert port.read_until(b"no such text", size=3) == VERSION_ANSWER[5:8]
    before = bus.now
    assert port.read_until(b"no such text") == VERSION_ANSWER[8:]
    assert bus.now - before == 500_000


def test_input_is_discarded_by_reset_input_buffer(bus, port):
    port.write(VERSION)
    bus.advance("20ms")
    port.reset_input_buffer()
    assert port.in_waiting == 0
    assert port.read(1) == b""


@pytest.mark.parametrize("baudrate", [9600, 38400, 115200])
def test_another_speed_is_garbage_for_the_unit(bus, port, baudrate):
    port.baudrate = baudrate
    port.write(VERSION)
    assert port.read(24) == b""
    port.baudrate = 19200
    port.write(b"\x7e" + VERSION)
    assert port.read(24) == VERSION_ANSWER


def test_answers_at_another_speed_are_garbage_for_the_port(bus, port):
    port.write_timeout = 0
    port.write(VERSION)
    bus.advance(7 * BYTE_US)
    port.baudrate = 9600
    heard = port.read(100)
    assert heard and VERSION_ANSWER not in heard


def test_parity_is_received_as_it_would_be(bus, port):
    port.parity = serial.PARITY_EVEN
    port.write(VERSION)
    assert port.read(24) == b""


def test_write_timeout(bus, port):
    port.write_timeout = 0.01
    with pytest.raises(serial.SerialTimeoutException):
        port.write(bytes(100))
    assert bus.now == 10_000
    port.write_timeout = None
    bus.advance("20ms")
    port.write(VERSION)
    assert port.read(24) == VERSION_ANSWER


def test_write_timeout_zero_returns_at_once_and_the_bytes_go_out(bus, port):
    port.write_timeout = 0
    assert port.write(VERSION) == 7
    assert bus.now == 0
    assert port.out_waiting == 7
    port.flush()
    assert port.out_waiting == 0
    assert port.read(24) == VERSION_ANSWER


def test_what_has_not_set_out_can_be_dropped(bus, port):
    port.write_timeout = 0
    port.write(VERSION)
    port.reset_output_buffer()
    assert port.read(24) == b""


def test_a_break_is_received_by_the_units(bus, port):
    framing_errors = bus.unit(1).state["line"]["framing_errors"]
    port.send_break(0.01)
    assert bus.now == 10_000
    assert bus.unit(1).state["line"]["framing_errors"] > framing_errors
    port.break_condition = True
    assert port.break_condition
    port.write(VERSION)
    assert port.read(24) == b""
    port.break_condition = False
    bus.advance("5ms")
    port.write(VERSION)
    assert port.read(24) == VERSION_ANSWER


def test_rs485_settings_are_accepted_and_their_delays_take_time(bus, port):
    port.rs485_mode = RS485Settings(delay_before_tx=0.002, delay_before_rx=0.001)
    port.write(VERSION)
    assert bus.now == pytest.approx(7 * BYTE_US + 3000, abs=7)
    assert port.read(24) == VERSION_ANSWER


def test_modem_lines_follow_each_other(port):
    port.rts = port.dtr = False
    assert (port.cts, port.dsr, port.ri, port.cd) == (False, False, False, True)
    port.rts = port.dtr = True
    assert (port.cts, port.dsr) == (True, True)


def test_close_and_open_again(bus, url):
    port = serial.serial_for_url(url, baudrate=19200, timeout=0.5)
    port.write(VERSION)
    port.close()
    with pytest.raises(serial.PortNotOpenError):
        port.read(1)
    with pytest.raises(serial.PortNotOpenError):
        port.write(VERSION)
    port.open()
    bus.advance("20ms")
    port.reset_input_buffer()
    port.write(VERSION)
    assert port.read(24) == VERSION_ANSWER
    port.close()
    with serial.serial_for_url(url, baudrate=19200, timeout=0.5) as other:
        other.write(VERSION)
        assert other.read(24) == VERSION_ANSWER


def test_a_bus_has_one_open_port(url, port):
    with pytest.raises(serial.SerialException, match="it is open already"):
        serial.serial_for_url(url)


def test_a_port_that_is_forgotten_is_closed(url):
    serial.serial_for_url(url)
    serial.serial_for_url(url).close()


def test_buses_with_ports_are_freed():
    buses = []
    for _ in range(20):
        bus = rkm04.Bus()
        with rkm04.virtual_time(bus), serial.serial_for_url(rkm04.publish(bus, "freed"), baudrate=19200, timeout=1) as port:
            port.write(VERSION)
            assert port.read(24) == VERSION_ANSWER
        rkm04.unpublish("freed")
        buses.append(weakref.ref(bus))
        del bus, port
    gc.collect()
    assert [bus() for bus in buses] == [None] * 20


def test_not_opened_at_once(url):
    port = serial.serial_for_url(url, do_not_open=True)
    assert not port.is_open
    port.baudrate = 19200
    with port:
        assert port.is_open


def test_a_url_with_parameters_makes_a_bus_and_finds_it_again(tmp_path):
    plant = tmp_path / "axis.yaml"
    plant.write_text("motors:\n  1:\n    stops: {low: -50, high: 800}\n", encoding="utf-8")
    url = f"rkm04://?node=5&plant={plant}&framing=plain&seed=3"
    port = serial.serial_for_url(url, baudrate=19200, timeout=0.1)
    bus = port.bus
    assert [unit.name for unit in bus.units] == ["5"]
    assert bus.unit(5).motor(1).true_position == 0
    port.write(bytes.fromhex("05000101"))
    assert port.read(100)[:4] == bytes.fromhex("05001201")
    port.close()
    assert serial.serial_for_url(url).bus is bus


def test_echo_of_a_two_wire_adapter():
    with serial.serial_for_url("rkm04://?node=1&echo=1", baudrate=19200, timeout=0.1) as port:
        port.write(VERSION)
        assert port.read(100) == VERSION + VERSION_ANSWER


@pytest.mark.parametrize("url, message", [
    ("rkm04://nowhere", "there is no bus 'nowhere'; names are"),
    ("rkm04://?nod=1", "unknown parameter 'nod': expected one of node, units, plant"),
    ("rkm04://?seed=x", "seed=x"),
    ("rkm04://?echo=2", "echo=2: expected 0 or 1"),
    ("rkm04://name?node=1", "a name and parameters"),
    ("rkm04://name/more", "expected rkm04://NAME"),
    ("rkm04://?plant=/no/such/file", "No such file or directory: '/no/such/file'"),
    ("rkm04://?node=1&node=2", "node=2: expected once"),
    ("rkm04://?node=1&units=2", "units=2: expected once"),
    ("rkm04://?node=17", "17"),
])
def test_a_wrong_url_is_an_error_of_pyserial(url, message):
    with pytest.raises(serial.SerialException, match=message):
        serial.serial_for_url(url)


def test_a_name_belongs_to_one_bus(bus, url):
    with rkm04.Bus() as other:
        with pytest.raises(ValueError, match="another bus has it"):
            rkm04.publish(other, url[len("rkm04://"):])
        with pytest.raises(ValueError, match="expected a name without"):
            rkm04.publish(other, "a/b")
    assert rkm04.publish(bus, "axis") == "rkm04://axis"
    rkm04.unpublish("axis")
    with pytest.raises(serial.SerialException):
        serial.serial_for_url("rkm04://axis")


def test_the_name_of_a_closed_bus_is_free():
    for _ in range(2):
        with rkm04.Bus() as bus:
            url = rkm04.publish(bus, "cabinet")
            assert serial.serial_for_url(url).bus is bus
    with pytest.raises(serial.SerialException, match="there is no bus 'cabinet'"):
        serial.serial_for_url(url)


@pytest.mark.parametrize("on", [False, True])
def test_a_port_can_be_closed_after_its_bus(on):
    with rkm04.Bus() as bus:
        port = serial.serial_for_url(rkm04.publish(bus), write_timeout=0)
        port.write(b"under way")
        port.break_condition = on
    with pytest.raises(rkm04.ClosedError):
        port.read(1)
    port.close()
    assert not port.is_open


def test_a_url_whose_bus_was_closed_makes_a_new_one():
    first = serial.serial_for_url("rkm04://?node=7").bus
    first.close()
    second = serial.serial_for_url("rkm04://?node=7").bus
    assert second is not first and second.now == 0


def test_two_threads_read_and_write(bus, port):
    heard = []
    port.timeout = None
    reader = threading.Thread(target=lambda: heard.append(port.read(24)))
    reader.start()
    port.write(VERSION)
    reader.join(60)
    assert heard == [VERSION_ANSWER]


def test_a_read_is_cancelled_from_another_thread(port):
    port.timeout = 3600
    with rkm04.virtual_time(port.bus):
        timer = threading.Timer(5, port.cancel_read)
        timer.start()
        assert port.read(1) == b""
        timer.join()
    assert port.bus.now == 5_000_000


def test_two_readers_without_anything_to_come_are_told_so(port):
    port.timeout = None
    errors = []

    def read():
        try:
            port.read(1)
        except rkm04.NothingToCome as error:
            errors.append(error)

    threads = [threading.Thread(target=read) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert len(errors) == 2


def test_a_loop_that_asks_without_waiting_comes_to_an_end(bus, port):
    port.write(VERSION)
    while port.in_waiting < 24:
        pass
    assert port.read(24) == VERSION_ANSWER
    assert bus.now < 1_000_000
