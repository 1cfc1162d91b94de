# SPDX-License-Identifier: MIT
"""A bus in this process."""

import signal
import threading
from datetime import timedelta

import pytest

import rkm04


@pytest.fixture
def bus():
    with rkm04.Bus() as bus:
        yield bus


def test_program_runs_in_virtual_time(bus):
    motor = bus.unit(1).motor(1)
    motor.set("S100 V1000 A2000 F1000 R")
    assert motor.state == "moving"
    tick = motor.wait(state="idle", limit="10s")
    assert motor.position == 1000
    assert motor.program == "S100 V1000 A2000 F1000 R"
    assert 1_000_000 < tick < 2_000_000


def test_same_calls_give_the_same_ticks():
    def story():
        with rkm04.Bus(units="1,2", seed=7) as bus:
            bus.faults.inject("drop", direction="to_units", probability=0.02)
            for _ in range(50):
                try:
                    bus.exchange(2, rkm04.request("Version"), "100ms")
                except rkm04.NoAnswerError:
                    pass
            return bus.now, [exchange.words for exchange in bus.dialogue]

    first = story()
    assert first == story()
    assert any("no answer" in words or "dropped" in words for words in first[1])


@pytest.mark.parametrize("time", [250_000, "250ms", timedelta(milliseconds=250)])
def test_advance_takes_times_as_people_give_them(bus, time):
    assert bus.advance(time) == 250_000
    assert bus.now == 250_000


@pytest.mark.parametrize("time", [-1, "soon", 1.5, None])
def test_advance_refuses_what_is_no_time(bus, time):
    with pytest.raises((ValueError, TypeError), match="expected"):
        bus.advance(time)
    assert bus.now == 0


@pytest.mark.parametrize("time", [10 ** 17, 10 ** 30, -1, timedelta(days=99999)])
def test_times_that_are_too_long_are_refused_with_the_range(bus, time):
    for refused in [lambda: bus.advance(time), lambda: bus.wait({"idle": True}, limit=time)]:
        with pytest.raises(ValueError, match=r"from 0 to 10\^15 us \(10\^9 s\)"):
            refused()
    assert bus.now == 0


def test_inputs_and_outputs(bus):
    bus.di[3] = 1
    bus.di[8] = True
    assert bus.di[3] == 1 and bus.di.mask == 0b10000100
    bus.unit(1).motor(1).set("T03")
    bus.advance("10ms")
    assert bus.do[3] == 1 and int(bus.do) == 4
    with pytest.raises(IndexError, match="expected di 1 to 8, found 9"):
        bus.di[9] = 1


def test_variables(bus):
    motor = bus.unit(1).motor(1)
    motor.set("T80 T95")
    motor.wait(state="idle")
    var = bus.unit(1).var
    assert var[80] == 1 and var[94] == 0 and var[95] == 1 and len(var) == 16
    with pytest.raises(IndexError, match="expected var 80 to 95, found 96"):
        var[96]


def test_several_units_have_no_inputs_in_common():
    with rkm04.Bus(units="1,2") as bus, pytest.raises(ValueError, match=r"expected a unit, as in bus\.unit\(1\): there are 1, 2"):
        bus.di[1] = 1


def test_wait_says_what_there_was_instead(bus):
    with pytest.raises(rkm04.WaitError, match=r'"position": 5.* within 1\.000000 s.*motor 1 position == 5 \(is 0\)'):
        bus.wait(motor=1, position=5, limit="1s")
    assert bus.now == 1_000_000


def test_wait_for_a_function(bus):
    motor = bus.unit(1).motor(1)
    motor.set("F10 R")
    bus.wait(lambda: motor.position == 10, limit="5s")
    with pytest.raises(rkm04.WaitError, match="within 0.010000 s"):
        bus.wait(lambda: False, limit="10ms")


def test_a_refused_program_says_why(bus):
    with pytest.raises(rkm04.ProgramError, match="unknown command 'Q' in 'Q'"):
        bus.unit(1).motor(1).set("Q")


def test_no_answer_says_what_was_expected(bus):
    with pytest.raises(rkm04.NoAnswerError, match="expected an answer of node 2 to 1 Version"):
        bus.exchange(2, rkm04.request("Version"))


def test_refusals_have_the_text_and_the_code_of_the_control_socket(bus):
    with pytest.raises(rkm04.RefusedError, match="there is no method `di.sett'") as error:
        bus.call("di.sett")
    assert error.value.code == -32601


@pytest.mark.parametrize("options", [
    {"units": 0}, {"units": "1-99"}, {"device": "rkm05"}, {"framing": "token-ring"}, {"seed": -1}, {"turnaround": "2s"},
    {"seed": 2**70}, {"readings": {"no-such": 1}}, {"plant": {"motors": 5}},
])
def test_wrong_options_are_refused(options):
    with pytest.raises(rkm04.RefusedError, match="expected|unknown"):
        rkm04.Bus(**options)


def test_dialogue(bus):
    bus.unit(1).motor(1).set("F1000 R")
    middle = bus.advance("1s")
    bus.exchange(1, rkm04.request("Version"))
    assert bus.dialogue.sent("Set Command", motor=1, text="F1000 R")
    assert not bus.dialogue.sent("Set Command", motor=2)
    assert bus.dialogue.count("version") == 1
    assert [exchange.request.name for exchange in bus.dialogue.between(middle, "3600s")] == ["Version"]
    assert bus.dialogue[0].answer.flag == 0 and bus.dialogue[0].node == 1
    with pytest.raises(ValueError, match="unknown message 'Set'"):
        bus.dialogue.sent("Set")


def test_dialogue_says_what_was_dropped(bus):
    bus.faults.inject("flip", mask=1, direction="to_units", skip=4, count=1)
    with pytest.raises(rkm04.NoAnswerError):
        bus.unit(1).motor(1).set("F1000 R")
    exchange, = bus.dialogue.dropped()
    assert exchange.request is None and exchange.dropped == "wrong FCS"


def test_faults_say_how_often_they_have_acted(bus):
    fault = bus.faults.inject("no_answer", count=1)
    assert fault.acted == 0
    with pytest.raises(rkm04.NoAnswerError):
        bus.exchange(1, rkm04.request("Version"), "100ms")
    assert fault.acted == 1
    assert bus.faults.clear() == 1 and len(bus.faults) == 0


def test_power_and_reset(bus):
    bus.unit(1).motor(1).set("F10")
    bus.power.off()
    assert not bus.power
    with pytest.raises(rkm04.RefusedError, match="has no power"):
        bus.unit(1).reset()
    bus.power.on()
    assert bus.power and bus.unit(1).motor(1).program == ""


def test_snapshot_and_restore(bus):
    motor = bus.unit(1).motor(1)
    motor.set("F100 R")
    bus.advance("50ms")
    bus.snapshot()
    before = motor.position
    bus.wait(motor=1, state="idle")
    assert motor.position == 100 != before
    bus.restore()
    assert motor.position == before


def test_plant():
    plant = {"motors": {"1": {"stops": {"low": -50, "high": 800}}}, "switches": [{"input": "01", "motor": 1, "at_most": 0}]}
    with rkm04.Bus(plant=plant) as bus:
        assert bus.di[1] == 1
        bus.plant.turn(1, 30)
        assert bus.di[1] == 0 and bus.unit(1).motor(1).true_position == 30
        bus.plant.set(None)
        assert bus.plant.state() is None


def test_events(bus):
    with bus.events("step", motor=1) as steps:
        bus.unit(1).motor(1).set("F3 R")
        bus.advance("1s")
    assert [event["value"] for event in steps] == [1, 2, 3]


def test_traces_and_recordings(bus, tmp_path):
    with bus.record(tmp_path / "x.record"), bus.trace(tmp_path / "x.vcd"), bus.trace(tmp_path / "x.log"):
        bus.unit(1).motor(1).set("F3 R")
        bus.advance("1s")
    assert "$timescale 1 us" in (tmp_path / "x.vcd").read_text(encoding="utf-8")
    assert "Set Command" in (tmp_path / "x.log").read_text(encoding="utf-8")
    assert (tmp_path / "x.record").read_text(encoding="utf-8").startswith('{"rkm04_record":1')
    with pytest.raises(rkm04.RefusedError, match="begins at tick 0"):
        bus.record(tmp_path / "y.record")


def test_a_bus_of_two_threads_is_an_error_and_no_crash(bus):
    bus.unit(1).motor(1).set("V16000 A60000 F1000000 R")
    errors = []
    started = threading.Event()

    def other():
        started.wait()
        while not errors and bus.now is not None:
            pass

    def guarded():
        try:
            other()
        except rkm04.BusyError as error:
            errors.append(str(error))

    thread = threading.Thread(target=guarded)
    thread.start()
    started.set()
    while not errors:
        try:
            bus.advance("100s")
        except rkm04.BusyError as error:
            errors.append(str(error))
    thread.join()
    assert "in use by another thread" in errors[0]
    assert bus.now > 0


@pytest.mark.parametrize("call", [
    lambda bus: bus.advance(10**14),
    lambda bus: bus.wait(motor=2, position=1, limit=10**14),
    lambda bus: bus.host.wait_byte(10**14),
])
def test_a_signal_ends_a_call_that_lasts(bus, call):
    bus.unit(1).motor(1).set("S100 V16000 A20000 G+")
    before = bus.now
    timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    with bus.events("step"), pytest.raises(KeyboardInterrupt):
        timer.start()
        call(bus)
    timer.join()
    assert before < bus.now < 10**14  # and the bus goes on
    assert bus.advance("1ms") > before


def test_a_closed_bus_says_so():
    bus = rkm04.Bus()
    bus.close()
    bus.close()
    with pytest.raises(rkm04.ClosedError, match="closed"):
        bus.advance(1)


def test_what_belongs_to_a_closed_bus_can_be_shown():
    with rkm04.Bus() as bus:
        unit = bus.unit(1)
        parts = [bus, unit, unit.motor(1), unit.di, unit.do, unit.var, unit.power, bus.faults, bus.dialogue]
    assert [repr(part) for part in parts if "closed" not in repr(part)] == ["<unit 1>"]


def test_errors_are_shown_with_the_name_that_programs_use():
    errors = [value for value in vars(rkm04).values() if isinstance(value, type) and issubclass(value, rkm04.Error)]
    assert len(errors) >= 8
    assert {error.__module__ for error in errors} == {"rkm04"}


def test_host_port(bus):
    data = bytes.fromhex("7e01000159 7e".replace(" ", ""))
    frame = bus._transport.sim.frame(1, b"\x01")
    assert data[:4] == frame[:4]
    bus.host.write(frame)
    assert bus.now == -(-len(frame) * 3125 // 6)
    assert bus.host.in_waiting == 0
    assert bus.host.wait_byte("1s")
    first = bus.now
    bus.advance("50ms")
    ticks = bus.host.read_ticks(2)
    assert ticks[0] == (first, 0x7E) and ticks[1][0] - ticks[0][0] in (520, 521)
    assert bus.host.read().endswith(b"\x7e")
    assert not bus.host.wait_byte("1ms") and bus.host.read() == b""


def test_host_of_another_speed_is_not_understood(bus):
    frame = bus._transport.sim.frame(1, b"\x01")
    bus.host.write(frame, baudrate=9600)
    assert bus.now == pytest.approx(len(frame) * 10 / 9600 * 1e6, abs=2)
    assert not bus.host.wait_byte("1s")
    bus.host.write(frame, baudrate=19200)
    assert bus.host.wait_byte("1s")


def test_host_receives_another_speed_as_other_bytes(bus):
    frame = bus._transport.sim.frame(1, b"\x01")
    bus.host.write(frame)
    bus.host.configure(baudrate=38400)
    bus.advance("50ms")
    heard = bus.host.read()
    assert heard and b"01.02" not in heard
