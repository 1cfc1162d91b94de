# SPDX-License-Identifier: MIT
"""Devices that are unlike the RKM04, through the Python package: one without a bus, and one whose messages end with a silence."""

import pytest

import rkm04

SILENCE = 2000
"""us that end a message with `end` = sums."""


@pytest.fixture
def alone():
    with rkm04.Bus(device="alone") as bus:
        yield bus


@pytest.fixture
def silent():
    with rkm04.Bus("1,2", device="fake", settings={"end": "sums"}) as bus:
        yield bus


# ---- Without a bus ----


def test_a_device_without_a_bus_moves_and_is_waited_for(alone):
    motor = alone.unit(1).motor(1)
    assert alone.call("alone.obey", text="MOVE 5")["answer"] == "OK"
    assert motor.wait(position=3, limit="1s") == 30001
    motor.wait(state="idle", limit="1s")
    assert motor.position == 5
    assert alone.now == 50001


def test_inputs_and_outputs_of_a_device_without_a_bus(alone):
    unit = alone.unit(1)
    unit.di["lmt+"] = 1
    assert unit.di[1] == unit.di["lmt+"] == 1 and len(unit.di) == 3
    assert repr(unit.di) == "<di on: lmt+>"
    assert unit.di.set({"lmt+": 0, "near": 1, 3: 1}) == []
    assert int(unit.di) == 6
    alone.call("alone.obey", text="OUT 1")
    alone.advance("1ms")
    assert list(unit.do) == [1, 0, 0, 0, 0] and unit.do["lamp"] == 1
    with pytest.raises(IndexError, match=r"expected di 1 to 3 or lmt\+, near, DI3, found 'far'"):
        unit.di["far"] = 1
    with pytest.raises(IndexError, match="expected do 1 to 5 or lamp, a1, b1, a2, b2, found 6"):
        unit.do[6]
    with pytest.raises(IndexError, match="expected var none, found 1"):
        unit.var[1]


def test_messages_of_a_device_without_a_bus_are_refused(alone):
    with pytest.raises(ValueError, match="the device alone has no bus"):
        alone.send(1, b"POS?")
    with pytest.raises(ValueError, match="the device alone has no bus"):
        alone.exchange(1, b"POS?")
    assert alone.now == 0


def test_a_device_without_a_bus_has_no_host(alone):
    with pytest.raises(ValueError, match="has no bus"):
        alone.host
    assert list(alone.dialogue) == []


def test_events_traces_recordings_and_snapshots_of_a_device_without_a_bus(alone, tmp_path):
    events = alone.events("step")
    alone.call("trace.start", file=str(tmp_path / "alone.csv"))
    alone.call("record.start", file=str(tmp_path / "alone.record"))
    snapshot = alone.snapshot()
    alone.call("alone.obey", text="MOVE 2")
    alone.advance("1s")
    assert [event["t_us"] for event in events] == [10000, 20000]
    alone.restore(snapshot)
    assert alone.unit(1).motor(1).position == 0
    alone.call("trace.stop")
    assert ",m1,step,2" in (tmp_path / "alone.csv").read_text()
    assert '"device":"alone"' in (tmp_path / "alone.record").read_text().splitlines()[0]


# ---- Messages that end with a silence ----


@pytest.mark.parametrize("timed", [True, False])
def test_an_answer_that_ends_with_a_silence_is_received(timed):
    with rkm04.Bus("1,2", device="fake", settings={"end": "sums"}, timed=timed) as bus:
        assert bytes(bus.exchange(2, b"MOVE 3")) == b"OK"
        bus.unit(2).motor(1).wait(state="idle", limit="1s")
        assert bytes(bus.exchange(2, b"POS?")) == b"3"
        assert bytes(bus.exchange(1, b"POS?")) == b"0"


def test_time_passes_until_the_silence_is_over_and_no_longer(silent):
    silent.exchange(1, b"POS?")
    end = silent.now
    silent.exchange(1, b"POS?")
    request, answer, byte = 6, 2, 10e6 / 19200
    assert silent.now - end == pytest.approx(request * byte + SILENCE + answer * byte + SILENCE, abs=3)


def test_messages_with_a_wrong_check_value_are_no_answers(silent):
    silent.faults.inject("flip", mask=1, direction="to_master", count=1)
    with pytest.raises(rkm04.NoAnswerError):
        silent.exchange(1, b"POS?", limit="100ms")
    assert bytes(silent.exchange(1, b"POS?")) == b"0"
    assert [exchange.dropped for exchange in silent.dialogue] == ["wrong FCS", None]


def test_dialogue_of_messages_that_end_with_a_silence(silent):
    silent.exchange(1, b"POS?")
    silent.advance("10ms")
    (exchange,) = silent.dialogue
    assert bytes(exchange.request) == b"POS?"
    assert bytes(exchange.answer) == b"0"
    assert exchange.node == 1
    assert exchange.words == "request POS? | 0"
    assert exchange.request.text == "POS?" and exchange.request.number is None and exchange.answer.motor is None


def test_a_message_is_as_long_as_the_device_takes(silent):
    assert bytes(silent.exchange(1, b"POS?".ljust(16))) == b"E1"
    with pytest.raises(ValueError, match="at most 16 bytes"):
        silent.send(1, b"POS?".ljust(17))
