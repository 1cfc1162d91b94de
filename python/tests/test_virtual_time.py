# SPDX-License-Identifier: MIT
"""`virtual_time()`: the time of the program under test is that of the bus."""

import asyncio
import os
import queue
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from time import monotonic as imported_monotonic
from time import sleep as imported_sleep

import pytest
import serial

import rkm04
from helpers import VERSION, VERSION_ANSWER
from rkm04._clock import Clock


def real_seconds():
    """Real time, which virtual_time() leaves alone."""
    return os.times().elapsed


@pytest.fixture
def bus():
    with rkm04.Bus() as bus:
        yield bus


@pytest.fixture
def now(bus):
    with rkm04.virtual_time(bus) as now:
        yield now


@pytest.fixture
def port(bus, now):
    url = rkm04.publish(bus)
    with serial.serial_for_url(url, baudrate=19200, timeout=0.5) as port:
        yield port
    rkm04.unpublish(url)



@pytest.mark.parametrize("name", ["time", "monotonic", "perf_counter", "time_ns", "monotonic_ns", "perf_counter_ns"])
def test_sleep_lets_the_time_of_the_bus_pass(bus, now, name):
    scale = 1e9 if name.endswith("_ns") else 1
    begin = getattr(time, name)()
    time.sleep(300)
    assert (getattr(time, name)() - begin) / scale == pytest.approx(300)
    assert bus.now == 300_000_000
    assert now.now == 300


def test_names_that_were_imported_before_go_by_the_bus_too(now):
    begin = imported_monotonic()
    imported_sleep(2)
    assert imported_monotonic() - begin == pytest.approx(2)


def test_everything_is_put_back():
    with rkm04.Bus() as bus, rkm04.virtual_time(bus):
        pass
    assert time.sleep is not None and type(time.sleep).__name__ == "builtin_function_or_method"
    assert type(time.monotonic).__name__ == type(imported_monotonic).__name__ == "builtin_function_or_method"
    assert threading.Condition.wait.__module__ == "threading"


def test_a_motor_stops_after_minutes_that_take_no_time(bus, now):
    begin = real_seconds()
    bus.unit(1).motor(1).set("S100 V100 F30000 R")
    waited = time.monotonic()
    while bus.unit(1).motor(1).state != "idle":
        time.sleep(0.5)
    assert 299 < time.monotonic() - waited < 302
    assert real_seconds() - begin < 60


@pytest.mark.parametrize("wait", [
    lambda: threading.Event().wait(5),
    lambda: _condition().wait(5),
    lambda: _condition().wait_for(lambda: False, 5),
    lambda: threading.Semaphore(0).acquire(timeout=5),
])
def test_waits_of_threading_with_a_timeout(now, wait):
    assert not wait()
    assert now.now == pytest.approx(5)


def _condition():
    condition = threading.Condition()
    condition.acquire()
    return condition


def test_a_queue_with_a_timeout(now):
    with pytest.raises(queue.Empty):
        queue.Queue().get(timeout=5)
    assert now.now == pytest.approx(5)


def test_wait_on_a_condition_that_is_not_acquired_is_an_error(now):
    with pytest.raises(RuntimeError, match="un-acquired"):
        threading.Condition().wait(1)


def test_one_thread_sleeps_while_the_other_waits(now):
    event = threading.Event()
    order = []

    def work():
        time.sleep(2)
        order.append(("set", now.now))
        event.set()

    thread = threading.Thread(target=work)
    thread.start()
    assert event.wait(10)
    order.append(("woken", now.now))
    thread.join()
    assert order == [("set", 2), ("woken", 2)]


def test_threads_that_sleep_wake_in_the_order_of_time(now):
    woken = []

    def sleep(seconds):
        time.sleep(seconds)
        woken.append((seconds, now.now))

    threads = [threading.Thread(target=sleep, args=(seconds,)) for seconds in (3, 1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert woken == [(1, 1), (2, 2), (3, 3)]


def test_a_thread_reads_while_the_main_thread_sleeps(port):
    heard = []

    def read():
        port.timeout = 10
        heard.append(port.read(24))

    reader = threading.Thread(target=read)
    reader.start()
    time.sleep(1)
    port.write(VERSION)
    time.sleep(1)
    reader.join()
    assert heard == [VERSION_ANSWER]


def test_the_test_lets_time_pass_itself_while_a_thread_reads(bus, port):
    for motor in range(1, 5):
        bus.unit(1).motor(motor).set("S2000 V16000 A20000 F16000000 R")
    heard = []

    def read():
        port.timeout = 3600
        heard.append(port.read(24))

    reader = threading.Thread(target=read)
    reader.start()
    for _ in range(10):
        bus.advance("60s")
    port.write(VERSION)
    reader.join(60)
    assert heard == [VERSION_ANSWER]


def test_a_pool_of_threads_that_is_idle_does_not_hold_time(now):
    with ThreadPoolExecutor(2) as pool:
        assert pool.submit(lambda: (time.sleep(1), 7)[1]).result() == 7
        time.sleep(5)
    assert now.now == pytest.approx(6)


def test_a_wait_that_nobody_ends_is_an_error_and_no_hang(now):
    with pytest.raises(rkm04.NothingToCome, match="a wait of threading without a time limit would never end"):
        threading.Event().wait()


def test_two_threads_that_wait_for_each_other_are_told_so(now):
    errors = []

    def wait():
        try:
            threading.Event().wait()
        except rkm04.NothingToCome as error:
            errors.append(error)

    thread = threading.Thread(target=wait)
    thread.start()
    wait()
    thread.join(60)
    assert len(errors) == 2


def test_a_loop_that_asks_the_time_comes_to_an_end(now):
    end = time.monotonic() + 1
    while time.monotonic() < end:
        pass
    assert now.now == pytest.approx(1, abs=0.01)


def test_sleep_refuses_what_time_sleep_refuses(now):
    with pytest.raises(ValueError):
        time.sleep(-1)
    time.sleep(0)
    assert now.now == 0


def test_one_context_at_a_time(bus, now):
    with pytest.raises(RuntimeError, match="in force already"):
        with rkm04.virtual_time(bus):
            pass


def test_a_second_bus_is_refused(now):
    with rkm04.Bus() as other:
        url = rkm04.publish(other)
        with pytest.raises(serial.SerialException, match="goes by another bus"):
            serial.serial_for_url(url)
        rkm04.unpublish(url)


def test_without_a_bus_time_goes_by_the_first_port():
    with rkm04.virtual_time() as now:
        time.sleep(3)
        with serial.serial_for_url("rkm04://?node=1&seed=77", baudrate=19200, timeout=1) as port:
            assert now.now == 3
            port.write(VERSION)
            assert port.read(24) == VERSION_ANSWER
            time.sleep(1)
            assert now.now == 3 + port.bus.now / 1e6


def test_a_program_that_waits_in_vain_comes_to_an_end(bus):
    with rkm04.virtual_time(bus, limit="100s"):
        with pytest.raises(rkm04.TimeLimitError, match=r"time.sleep\(\) after the limit of virtual time: .* before 100 s"):
            while bus.unit(1).motor(1).position != 1:
                time.sleep(1)
    assert bus.now == 100_000_000


def test_start_sets_the_date():
    with rkm04.Bus() as bus, rkm04.virtual_time(bus, start=0):
        time.sleep(60)
        assert time.time() == 60


def test_processes_are_waited_for_in_real_time(now):
    assert subprocess.run([sys.executable, "-c", "import time; time.sleep(0.2)"], timeout=60).returncode == 0
    assert now.now < 1


# ---- asyncio ----


def test_asyncio_sleeps_in_virtual_time(now):
    async def main():
        begin = asyncio.get_running_loop().time()
        await asyncio.gather(asyncio.sleep(100), asyncio.sleep(300))
        return asyncio.get_running_loop().time() - begin

    assert asyncio.run(main()) == pytest.approx(300)
    assert now.now == pytest.approx(300, abs=0.1)


def test_asyncio_timeouts(now):
    async def main():
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(asyncio.Event().wait(), 20)

    asyncio.run(main())
    assert now.now == pytest.approx(20, abs=0.1)


def test_asyncio_and_a_thread(now):
    async def main():
        loop = asyncio.get_running_loop()
        return await asyncio.wait_for(loop.run_in_executor(None, lambda: (time.sleep(30), 5)[1]), 60)

    assert asyncio.run(main()) == 5
    assert 30 <= now.now < 31


def test_what_the_last_thread_does_before_it_ends_is_seen(monkeypatch):
    done = []

    def end(clock, me):  # between two looks of the one that waits
        done.append(1)
        return []

    monkeypatch.setattr(Clock, "_is_alone", lambda clock: False)
    monkeypatch.setattr(Clock, "_outside", end)
    assert Clock().wait(None, lambda: bool(done), "a wait for a thread")


def test_asyncio_waits_for_nothing(now):
    async def main():
        await asyncio.Event().wait()

    with pytest.raises(rkm04.NothingToCome, match="a wait of the event loop"):
        asyncio.run(main())


def test_pyserial_asyncio(bus, now):
    serial_asyncio = pytest.importorskip("serial_asyncio")
    url = rkm04.publish(bus)

    async def main():
        reader, writer = await serial_asyncio.open_serial_connection(url=url, baudrate=19200)
        answers = []
        for _ in range(3):
            writer.write(VERSION)
            answers.append(await asyncio.wait_for(reader.readexactly(24), 1))
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(reader.read(1), 5)
        writer.close()
        await asyncio.sleep(0.1)
        return answers

    assert asyncio.run(main()) == [VERSION_ANSWER] * 3
    assert now.now == pytest.approx(5.1 + 3 * 0.0167, abs=0.01)
    rkm04.unpublish(url)
