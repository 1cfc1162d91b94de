# SPDX-License-Identifier: MIT
"""pyserial's own tests of URL handlers, from its source package, over `rkm04://` with the echo of a two-wire adapter as their
loop-back, in virtual time."""

import importlib
import os
import subprocess
import sys
import tarfile
import unittest
from pathlib import Path

import pytest
import serial

import rkm04
from rkm04 import protocol_rkm04

MODULES = ["test", "test_advanced", "test_cancel", "test_context", "test_exclusive", "test_high_load", "test_iolib",
           "test_readline", "test_rs485", "test_settings_dict", "test_threaded", "test_timeout_class", "test_url", "test_util"]


def suite_folder():
    """The tests of the pyserial that is installed; they are fetched once into the environment."""
    place = Path(sys.prefix) / "pyserial-tests"
    folder = place / f"pyserial-{serial.VERSION}" / "test"
    if not folder.is_dir():
        place.mkdir(exist_ok=True)
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--no-binary", ":all:", "-d", str(place)]
        done = subprocess.run([*command, f"pyserial=={serial.VERSION}"], env={**os.environ, "LD_PRELOAD": ""},
                              capture_output=True, text=True)
        if done.returncode:
            pytest.skip(f"the source package of pyserial cannot be fetched: {done.stderr.strip()[-300:]}")
        with tarfile.open(next(place.glob("pyserial-*.tar.gz"))) as archive:
            archive.extractall(place)
    return folder


RECONFIGURE = protocol_rkm04.Serial._reconfigure_port


def reconfigure_at_19200(port):
    """The bus carries 19200 baud, so that is how an echo is heard; the tests use other speeds, and only look at settings."""
    RECONFIGURE(port)
    if port._baudrate >= 9600:
        port._line.host.configure(19200, 8, "N", 1)


def test_pyserial_suite(monkeypatch):
    folder = suite_folder()
    monkeypatch.setattr(protocol_rkm04.Serial, "_reconfigure_port", reconfigure_at_19200)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.chdir(folder)
    for name in MODULES:
        monkeypatch.delitem(sys.modules, name, raising=False)
    suite = unittest.TestSuite()
    with rkm04.Bus() as bus:
        bus.faults.inject("echo")
        url = rkm04.publish(bus, "loop")
        for name in MODULES:
            module = importlib.import_module(name)
            module.PORT = url
            suite.addTests(unittest.defaultTestLoader.loadTestsFromModule(module))
        with rkm04.virtual_time(bus):
            result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
        rkm04.unpublish(url)
    for name in MODULES:
        sys.modules.pop(name, None)
    assert result.testsRun >= 57
    assert result.wasSuccessful(), [str(test) for test, _ in result.failures + result.errors]
    assert {str(test).split(" ")[0] for test, _ in result.skipped} == {
        "test_exclusive_false", "test_exclusive_none", "test_exclusive_only_true", "test_exclusive_true", "test_RS485_class"}
