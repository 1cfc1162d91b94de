# SPDX-License-Identifier: MIT
"""control_robust.py: clients of the control socket that behave badly, and what others see of that.

    RKM04=… RKMCTL=… [CONTROL=tcp:0] control_robust.py [CASE]

CONTROL: over TCP instead of a Unix socket."""
import json
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time

from control_client import Client, entrance, soon

MIB = 1 << 20


class Emulator:
    """A running `rkm04 serve` with a control socket."""

    def __init__(self, *options):
        self.folder = tempfile.TemporaryDirectory()
        self.link = os.path.join(self.folder.name, "bus")
        self.path = self.link + ".control"
        if "--lines" in options:
            self.link += "%l"
            self.path = os.path.join(self.folder.name, "control")
            options += ("--control", self.path) if "CONTROL" not in os.environ else ()
        if "tcp" in os.environ.get("CONTROL", ""):
            options += ("--control", os.environ["CONTROL"], "--control-file", self.path)
        self.start(*options)
        self.clients = []

    def start(self, *options):
        environment = {**os.environ, "ASAN_OPTIONS": "quarantine_size_mb=1"}  # memory given back counts as given back
        self.process = subprocess.Popen([os.environ["RKM04"], "serve", "--link", self.link, *options], cwd=self.folder.name,
                                        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        ready = self.process.stdout.readline()
        assert ready.startswith("READY "), self.process.stderr.read()

    def client(self, **options):
        self.clients.append(Client(self.path, **options))
        return self.clients[-1]

    def program(self, motor, text, accepted=True):
        done = subprocess.run([os.environ["RKMCTL"], "-p", self.link, "-m", str(motor), "set", text], timeout=60, check=False,
                              capture_output=True, text=True)
        assert (done.returncode == 0) == accepted, done.stderr

    def memory(self):
        """Resident bytes."""
        with open(f"/proc/{self.process.pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * resource.getpagesize()

    def work(self):
        """Seconds of processor time."""
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as file:
            return sum(map(int, file.read().rsplit(")")[-1].split()[11:13])) / os.sysconf("SC_CLK_TCK")

    def state(self):
        """Of the process, a letter."""
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as file:
            return file.read().rsplit(")")[-1].split()[0]

    def files(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def end(self):
        for client in self.clients:
            client.close()
        self.process.terminate()
        _, errors = self.process.communicate(timeout=60)
        self.folder.cleanup()
        assert "Sanitizer" not in errors and "runtime error" not in errors, errors


def brisk(emulator, client, limit=0.5):
    """Another client is answered without delay: within so many seconds or, if the machine has other work, so much of the
    emulator's. The best of ten counts: what holds up a client holds up each."""
    for _ in range(10):
        begin, work = time.monotonic(), emulator.work()
        client.call("units")
        took, worked = time.monotonic() - begin, emulator.work() - work
        if took < limit:
            return
        assert worked < limit, f"an answer took {worked:.2f} s of processor time"
    raise AssertionError(f"an answer took {took:.3f} s, and so did those before it")


def test_clients_do_not_see_one_another(emulator):
    one, two = emulator.client(), emulator.client()
    assert one.call("subscribe", kinds=["inputs"]) == {"t_us": 0, "subscription": 1}
    assert two.call("di.set", mask=7)["di"] == 7
    assert one.line()["params"]["value"] == 7
    assert two.silent()
    assert two.refused("unsubscribe", subscription=1).message == "subscription: this connection has no subscription 1"


def test_megabytes_without_a_newline_are_refused_and_forgotten(emulator):
    bad, good = emulator.client(), emulator.client()
    before = emulator.memory()
    for _ in range(40):
        bad.send(b"x" * MIB)
    answer = bad.line()
    assert answer["error"] == {"code": -32600, "message": "too long: expected a request of at most 1048576 bytes"}, answer
    brisk(emulator, good)
    assert emulator.memory() - before < 16 * MIB, emulator.memory() - before
    bad.send(b"\n")
    assert bad.call("units")["units"] == ["1"]


def test_the_longest_line_is_taken_and_one_byte_more_is_not(emulator):
    client = emulator.client()
    request = b'{"jsonrpc":"2.0","id":"%s","method":"units"}'
    longest = request % (b"i" * (MIB - len(request) + 2))
    client.send(longest + b"\n")
    assert client.line()["result"]["units"] == ["1"]
    client.send(longest + b" \n")
    assert client.line()["error"]["code"] == -32600
    assert client.call("units")["units"] == ["1"]


def test_a_flood_of_bytes_on_a_strict_line_does_not_hold_up_others(emulator):
    """At 50 baud a byte is much work; fast ones come to nothing, so that there is always room for more."""
    good = emulator.client()
    flood = subprocess.Popen([sys.executable, "-c", """if True:
        import os, sys, termios
        line = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
        settings = termios.tcgetattr(line)
        while True:
            for speed in (termios.B50, termios.B4000000):
                settings[4] = settings[5] = speed
                termios.tcsetattr(line, termios.TCSANOW, settings)
                os.write(line, b"\\xff" * 4095)""", emulator.link])
    try:
        for _ in range(20):
            brisk(emulator, good, 1)
    finally:
        flood.kill()
        flood.wait()


def test_a_flood_of_requests_does_not_hold_up_others(emulator):
    flood, good = emulator.client(), emulator.client()
    line = b'{"jsonrpc":"2.0","id":1,"method":"state"}\n' * 1000
    flood.socket.settimeout(0.2)
    before, sent = emulator.memory(), 0
    for _ in range(400):  # far more answers than are kept for it: it is not read any more
        try:
            sent += flood.socket.send(line)
        except TimeoutError:
            break
        brisk(emulator, good, 2)
    else:
        raise AssertionError(f"{sent} bytes were taken from somebody who does not read")
    for _ in range(20):
        brisk(emulator, good)
    assert emulator.memory() - before < 64 * MIB, emulator.memory() - before


def test_the_unit_answers_its_master_meanwhile(emulator):
    floods = [emulator.client() for _ in range(4)]
    for flood in floods:
        flood.socket.setblocking(False)
    for _ in range(20):
        for flood in floods:
            try:
                flood.socket.send(b'{"jsonrpc":"2.0","id":1,"method":"state"}\n' * 100)
                flood.socket.recv(MIB)
            except BlockingIOError:
                pass
        emulator.program(1, "F1 R")  # gets the answer that it is accepted, within the time that rkmctl waits


def test_a_client_that_leaves_in_the_middle_does_no_harm(emulator):
    good = emulator.client()
    good.call("units")
    files = emulator.files()
    beginnings = [b"", b"{", b'{"jsonrpc":"2.0","id":1,"method":"shutdown"}', b'{"jsonrpc":"2.0","id":1,"method":"sta',
                  b'{"jsonrpc":"2.0","id":1,"method":"wait","params":{"until":{"position":9,"motor":1}}}\n',
                  b'{"jsonrpc":"2.0","id":1,"method":"subscribe"}\n', b'{"jsonrpc":"2.0","id":1,"method":"state"}\n' * 5000,
                  b'{"jsonrpc":"2.0","id":1,"method":"advance","params":{"ticks":"1000000s"}}\n']
    for beginning in beginnings * 3:
        bad = Client(emulator.path)
        bad.send(beginning)
        bad.close()
    brisk(emulator, good)
    good.call("di.set", mask=1)  # events without a client
    soon("all of them are gone", lambda: emulator.files() == files)
    emulator.program(1, "F9 R")
    good.call("advance", ticks="1s")
    assert good.call("state")["motors"][0]["position"] == 9


def test_what_a_client_sends_before_it_goes_is_done(emulator):
    """However late the emulator reads it."""
    other = emulator.client()
    other.call("units")
    files = emulator.files()
    emulator.program(1, "G+")
    gone = Client(emulator.path)
    gone.call("units")
    emulator.process.send_signal(signal.SIGSTOP)
    soon("it stands", lambda: emulator.state() == "T")
    gone.send(b'{"jsonrpc":"2.0","id":1,"method":"state"}\n' * 50 +
              b'{"jsonrpc":"2.0","method":"di.set","params":{"mask":5}}\n{"jsonrpc":"2.0","id":1,"method":"wait","params":'
              b'{"until":{"position":9,"motor":1}}}\n{"jsonrpc":"2.0","method":"di.set","params":{"mask":7}}\n'
              b'{"jsonrpc":"2.0","id":1,"method":"advance","params":{"ticks":"1000000s"}}\n'
              b'{"jsonrpc":"2.0","method":"di.set","params":{"mask":9}}\n')
    gone.close()
    emulator.process.send_signal(signal.SIGCONT)
    soon("it is gone", lambda: emulator.files() == files)
    assert other.call("state")["di"] == 7


def test_one_that_only_ends_its_sending_gets_its_answers(emulator):
    if "CONTROL" in os.environ:
        return  # to the system it is like one that has gone
    client, other = emulator.client(), emulator.client()
    client.send(b'{"jsonrpc":"2.0","id":1,"method":"wait","params":{"until":{"di":{"1":1}}}}\n'
                b'{"jsonrpc":"2.0","id":2,"method":"units"}\n{"jsonrpc":"2.0","id":3,"method":"units"}')
    client.socket.shutdown(socket.SHUT_WR)
    assert client.line()["id"] == 2
    refused = client.line()
    assert refused["error"] == {"code": -32700, "message": "the last line has no newline: it was ignored"}, refused
    other.call("di.set", mask=1)
    assert client.line() == {"jsonrpc": "2.0", "id": 1, "result": {"t_us": 0, "holds": True}}
    assert client.line() is None  # closed


def test_one_that_ends_its_sending_and_goes_is_noticed(emulator):
    emulator.client().call("units")
    files = emulator.files()
    gone = Client(emulator.path)
    gone.send(b'{"jsonrpc":"2.0","id":1,"method":"wait","params":{"until":{"di":{"1":1}}}}\n')
    gone.socket.shutdown(socket.SHUT_WR)
    soon("it is there", lambda: emulator.files() == files + 1)
    gone.close()
    soon("it is gone", lambda: emulator.files() == files)


def show_token(client, path):
    """The answer is not taken. False: none is needed."""
    token = entrance(path)[2]
    if token:
        client.request("authenticate", token=token)
    return token


def test_one_too_many_is_turned_away(emulator):
    clients = [emulator.client() for _ in range(64)]
    for client in clients:
        client.call("units")
    extra = Client(emulator.path, admit=False)
    show_token(extra, emulator.path)
    assert extra.line()["error"] == {"code": -32000, "message": "too many clients: expected at most 64 at a time"}
    assert extra.line() is None
    clients[0].close()

    def there_is_room():
        new = Client(emulator.path, admit=False)
        if show_token(new, emulator.path) and "error" in new.line():
            new.close()
            return False
        new.send(b'{"jsonrpc":"2.0","id":1,"method":"units"}\n')
        answer = new.line()
        new.close()
        return answer is not None and "result" in answer

    soon("there is room again", there_is_room)


def test_too_many_waits_and_subscriptions_are_refused(emulator):
    client = emulator.client()
    for _ in range(64):
        client.request("wait", until={"di": {"1": 1}})
    assert client.refused("wait", until={"di": {"1": 1}}).code == -32000
    for number in range(1, 17):
        assert client.call("subscribe", kinds=["led"])["subscription"] == number
    assert client.refused("subscribe").message == "too many subscriptions: expected at most 16 per client"
    client.call("unsubscribe", subscription=3)
    assert client.call("subscribe", kinds=["led"])["subscription"] == 17


def test_who_does_not_read_loses_events_and_is_told_how_many(emulator):
    lazy, busy = emulator.client(receive_buffer=4096), emulator.client()
    lazy.call("subscribe", kinds=["step"])
    for motor in range(1, 5):
        emulator.program(motor, "V16000 A60000 G+")
    before = emulator.memory()
    for _ in range(100):
        busy.call("advance", ticks="50ms")
    assert emulator.memory() - before < 64 * MIB, emulator.memory() - before
    assert busy.call("state")["motors"][3]["position"] > 70000
    steps, lost = 0, None
    while lost is None:
        line = lazy.line()
        if line["method"] == "lost":
            lost = line["params"]
        else:
            steps += 1
            last = line["params"]
    assert last["t_us"] <= lost["t_us"], (last, lost)
    positions = sum(motor["position"] for motor in busy.call("state")["motors"])
    assert steps + lost["events"] == positions, (steps, lost, positions)
    busy.call("advance", ticks="10ms")
    assert lazy.line()["method"] == "event"  # it goes on


def test_who_advances_loses_nothing_however_slow_it_reads(emulator):
    client = emulator.client(receive_buffer=4096)
    client.call("subscribe", kinds=["step"])
    for motor in range(1, 5):
        emulator.program(motor, "V16000 A60000 G+")
    client.request("advance", ticks="5s")
    time.sleep(0.3)
    before = emulator.memory()
    steps = 0
    while True:
        line = client.line()
        assert line.get("method") != "lost", line
        if "id" in line:
            break
        steps += 1
    assert emulator.memory() - before < 32 * MIB
    assert steps == sum(motor["position"] for motor in client.call("state")["motors"]) > 280000, steps


def test_advances_of_several_clients_follow_one_another(emulator):
    one, two = emulator.client(), emulator.client()
    one.call("subscribe", kinds=["step"])
    emulator.program(1, "V16000 A60000 G+")
    first = one.request("advance", ticks="5s")
    second = two.request("advance", ticks="1s")
    assert one.answer(first)["t_us"] == 5000000
    assert two.answer(second)["t_us"] == 6000000


def test_a_clock_that_is_being_advanced_cannot_be_changed(emulator):
    slow, other = emulator.client(receive_buffer=4096), emulator.client()
    slow.call("subscribe", kinds=["step"])
    emulator.program(1, "V16000 A60000 G+")
    number = slow.request("advance", ticks="30s")
    error = other.refused("clock", clock="real")
    assert error.code == -32000 and error.message.startswith("a client is advancing the clock"), error
    slow.answer(number)
    assert other.call("clock", clock="max")["clock"] == "max"


def test_what_follows_an_advance_waits_for_it(emulator):
    client = emulator.client()
    emulator.program(1, "S100 F1000 R")
    requests = b""
    for number in range(1, 101):
        requests += b'{"jsonrpc":"2.0","id":%d,"method":"advance","params":{"ticks":1000}}\n' % (2 * number)
        requests += b'{"jsonrpc":"2.0","id":%d,"method":"units"}\n' % (2 * number + 1)
    client.send(requests)
    for number in range(1, 101):
        assert client.line()["result"]["t_us"] == 1000 * number
        assert client.line()["result"]["t_us"] == 1000 * number


def test_an_advance_ends_with_its_client(emulator):
    one, two = emulator.client(), emulator.client()
    emulator.program(1, "G+")
    one.request("advance", ticks="1000000s")
    brisk(emulator, two)
    one.close()
    now = two.call("advance", ticks=1)["t_us"]
    assert now < 1000000000000, now
    time.sleep(0.05)
    assert two.call("units")["t_us"] == now


def test_nonsense_of_all_kinds_is_refused(emulator):
    client = emulator.client()
    lines = [b"\xff\xfe", b"null", b"{}", b"[]" * 10, b"[" * 200000, b'{"a":' * 1000, b'{"jsonrpc":"2.0","id":1,"method":"wait"}',
             b'{"jsonrpc":"2.0","id":1,"method":"advance","params":{"ticks":-1}}',
             b'{"jsonrpc":"2.0","id":1,"method":"advance","params":{"ticks":1,"until":{"idle":true}}}',
             b'{"jsonrpc":"2.0","id":1,"method":"advance","params":{"ticks":99999999999999999999}}',
             b'{"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"kinds":["steps"]}}',
             b'{"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"kinds":[]}}',
             b'{"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"motor":5}}',
             b'{"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"motor":[]}}',
             b'{"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"unit":"9"}}',
             b'{"jsonrpc":"2.0","id":1,"method":"clock","params":{"clock":"x0"}}',
             b'{"jsonrpc":"2.0","id":1,"method":"clock","params":{"clock":1}}',
             b'{"jsonrpc":"2.0","id":1,"method":"trace.stop"}', b'{"jsonrpc":"2.0","id":1,"method":"trace.start"}',
             b'{"jsonrpc":"2.0","id":1,"method":"trace.start","params":{"file":"/nonexistent/a.vcd"}}',
             b'{"jsonrpc":"2.0","id":1,"method":"unsubscribe","params":{"subscription":1}}',
             b'{"jsonrpc":"2.0","id":1,"method":"shutdown","params":{"now":true}}']
    for line in lines:
        client.send(line + b"\r\n")
        answer = client.line()
        assert "error" in answer and answer["error"]["message"], (line[:80], answer)
    client.send(b"\n  \n\r\n")
    assert client.call("units")["t_us"] == 0


def test_a_notification_is_obeyed_and_not_answered(emulator):
    client = emulator.client()
    client.send(b'{"jsonrpc":"2.0","method":"di.set","params":{"mask":5}}\n{"jsonrpc":"2.0","method":"nonsense"}\n')
    assert client.call("state")["di"] == 5


def test_times_that_are_too_long_are_refused_with_the_range(emulator):
    client = emulator.client()
    for time in [10 ** 17, -1, "1000000001s", 1.5]:
        assert "from 0 to 10^15 us (10^9 s)" in client.refused("advance", ticks=time).message, time
        assert "from 0 to 10^15 us (10^9 s)" in client.refused("wait", until={"idle": True}, limit=time).message, time


def test_with_a_clock_that_goes_time_cannot_be_advanced(emulator):
    client = emulator.client()
    client.call("clock", clock="max")
    error = client.refused("advance", ticks=5)
    assert error.code == -32000 and "(max)" in error.message, error
    emulator.program(1, "W100 T05")
    assert client.call("wait", until={"do": {"5": 1}}, limit="5s")["holds"]
    assert client.call("clock", clock="stepped")["clock"] == "stepped"
    now = client.call("units")["t_us"]
    time.sleep(0.02)
    assert client.call("units")["t_us"] == now


def test_files_begun_are_ended_with_the_emulator(emulator):
    client = emulator.client()
    for name in ["a.vcd", "a.csv", "a.jsonl", "a.log", "a.pcapng"]:
        client.call("trace.start", file=name)
    error = client.refused("trace.start", file="a.vcd")
    assert error.message == "cannot write a.vcd: it is being written already: choose another name", error
    assert client.refused("trace.stop").message == "trace: missing: several traces are running"
    emulator.program(1, "S100 F5 R")
    client.call("advance", ticks="1s")
    assert client.call("trace.stop", trace=2)["file"] == "a.csv"
    client.call("shutdown")
    assert client.line() is None
    assert emulator.process.wait(timeout=60) == 0
    with open(os.path.join(emulator.folder.name, "a.jsonl"), encoding="utf-8") as file:
        steps = [event for event in map(json.loads, file) if event.get("kind") == "step"]
    assert len(steps) == 5, steps
    for name in ["a.vcd", "a.csv", "a.log", "a.pcapng"]:
        assert os.path.getsize(os.path.join(emulator.folder.name, name)) > 0, name
    assert not os.path.exists(emulator.path) and not os.path.exists(emulator.path + ".lock")


def test_the_socket_of_a_killed_emulator_is_replaced(emulator):
    emulator.process.kill()
    emulator.process.communicate()
    assert os.path.exists(emulator.path)
    emulator.start()
    assert emulator.client().call("units")["units"] == ["1"]
    assert os.stat(emulator.path).st_mode & 0o7777 == 0o600


def test_messages_and_bytes_are_events(emulator):
    client = emulator.client()
    client.call("subscribe", kinds=["message", "byte"])
    number = client.request("wait", until={"message": {"number": 2, "from": "unit"}})
    emulator.program(2, "V70000", accepted=False)
    assert client.answer(number) == {"t_us": 0, "holds": True}
    messages = [event["params"] for event in client.events if event["params"]["kind"] == "message"]
    data = b"".join(bytes([event["params"]["value"]]) for event in client.events if event["params"]["kind"] == "byte")
    request, answer = [message for message in messages if message["value"] == 2][-2:]
    assert (request["from"], request["dnode"], request["snode"], request["answer"]) == (["master"], 1, 0, False), request
    assert bytes.fromhex(request["message"]) == b"\x022V70000" and bytes.fromhex(request["bytes"]) in data, request
    assert (answer["from"], answer["dnode"], answer["snode"], answer["answer"]) == (["1"], 0, 1, True), answer
    assert bytes.fromhex(answer["message"]) == b"\x022\x01V" and answer["refused"] and not answer["dropped"], answer


def test_units_have_names_and_lines_have_numbers(emulator):
    client = emulator.client()
    assert client.call("units", line=1) == {"t_us": 0, "lines": 2, "units": ["3", "5", "3-2"], "framing": "hdlc",
                                            "readings": {}}
    assert client.refused("units", line=2).message == "line: expected a whole number from 0 to 1"
    assert client.refused("state").message == "unit: missing: expected one of 3, 5, 3-2"
    client.call("subscribe", line=1, unit=["5", "3-2"], kinds=["inputs", "power"])
    client.call("di.set", line=1, unit=3, mask=1)
    client.call("di.set", line=1, unit="3-2", mask=2)
    client.call("di.set", line=0, unit=5, mask=4)
    client.call("power", line=1, unit=5, on=False)
    states = [[client.call("state", line=line, unit=unit)["di"] for unit in ["3", "5", "3-2"]] for line in [0, 1]]
    assert states == [[0, 4, 0], [1, 0, 2]], states
    seen = [(event["params"]["unit"], event["params"]["kind"], event["params"]["value"]) for event in client.events]
    client.call("advance", line=1, ticks=5)
    assert seen == [("3-2", "inputs", 2), ("5", "power", 0)], seen
    assert [client.call("units", line=line)["t_us"] for line in [0, 1]] == [0, 5]
    client.call("clock", clock="x1000", line=0)
    assert [client.call("clock", line=line)["clock"] for line in [0, 1]] == ["x1000", "stepped"]


OPTIONS = {
    "test_a_flood_of_bytes_on_a_strict_line_does_not_hold_up_others": ["--strict-line"],
    "test_the_unit_answers_its_master_meanwhile": [],
    "test_units_have_names_and_lines_have_numbers": ["--clock", "stepped", "--lines", "2", "--node", "3,5,3"],
}


def run(name, function=None):
    options = OPTIONS.get(name, ["--clock", "stepped"])
    emulator = Emulator(*options)
    try:
        (function or globals()[name])(emulator)
        error = None
    except Exception as caught:  # pylint: disable=broad-except
        error = f"{type(caught).__name__}: {caught}"
        line = caught.__traceback__
        while line:
            error += f" (line {line.tb_lineno})"
            line = line.tb_next
    try:
        emulator.end()
    except Exception as caught:  # pylint: disable=broad-except
        error = error or f"at the end: {caught}"
    if error:
        print(f"FAILED {name}: {error}\n  alone: RKM04={os.environ['RKM04']} RKMCTL={os.environ['RKMCTL']} "
              f"{sys.argv[0]} {name}")
    else:
        print(f"ok {name}")
    return error is None


def main():
    names = sys.argv[1:] or re.findall(r"^def (test_\w+)", open(__file__, encoding="utf-8").read(), re.MULTILINE)
    sys.exit(not all([run(name) for name in names]))


if __name__ == "__main__":
    main()
