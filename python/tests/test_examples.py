# SPDX-License-Identifier: MIT
"""The example in examples/python and what docs/PYTHON.md shows, run as a user runs them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from rkm04 import _system

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples" / "python"


def run_pytest(folder, *arguments, **environment):
    """Run a pytest of its own. Returns (exit status, output)."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--rootdir", str(folder), *arguments]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONIOENCODING": "utf-8", **environment}
    done = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          encoding="utf-8", timeout=240)
    return done.returncode, done.stdout


def test_suite_in_virtual_time():
    status, output = run_pytest(EXAMPLES, "-v")
    assert status == 0, output
    assert "test_axis_async.py::test_a_motion PASSED" in output
    assert "test_exploration.py::test_move_to PASSED" in output


@pytest.mark.parametrize("transport", [
    pytest.param("pty", marks=pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows")),
    "rfc2217", "tcp"])
def test_suite_over_a_running_emulator(transport):
    status, output = run_pytest(EXAMPLES, f"--rkm04-transport={transport}", "test_axis.py")
    assert status == 0, output


def test_exploration_shows_that_a_retry_executes_a_program_twice():
    status, output = run_pytest(EXAMPLES, "explore_move_by.py")
    assert status == 1, output
    assert "  - answer 1 (2 Set Command m1 -> flag 0) is not sent" in output
    shown = re.search(r"It fails\..*?\n\n((?:    [^\n]*\n)+)", (ROOT / "docs" / "PYTHON.md").read_text(encoding="utf-8"), re.S)[1]
    line = re.search(r"RKM04_REPLAY=(?:'(.*)' |(.*)&& )pytest explore_move_by.py::test_move_by", output)
    replay = line[1] or line[2]
    command = "pytest explore_move_by.py::test_move_by"
    shown = shown.replace(f"RKM04_REPLAY='{replay}' {command}", _system.command_with("RKM04_REPLAY", replay, command))
    assert [text for text in shown.splitlines() if text[4:] not in output.splitlines()] == []
    status, output = run_pytest(EXAMPLES, "explore_move_by.py::test_move_by", RKM04_REPLAY=replay)
    assert status == 1 and "assert 600 == 300" in output


def blocks():
    """(name, text) of the Python files that docs/PYTHON.md shows."""
    text = (ROOT / "docs" / "PYTHON.md").read_text(encoding="utf-8")
    return re.findall(r"<!-- test: (\S+) -->\n+```python\n(.*?)```", text, re.S)


def test_every_block_of_the_document_is_run_or_part_of_an_example():
    document = (ROOT / "docs" / "PYTHON.md").read_text(encoding="utf-8")
    run = {text for _, text in blocks()}
    examples = [file.read_text(encoding="utf-8") for file in EXAMPLES.glob("*.py")]
    for text in re.findall(r"```python\n(.*?)```", document, re.S):
        assert text in run or any(text in example for example in examples), text


@pytest.mark.parametrize("name, text", blocks())
def test_what_the_document_shows(tmp_path, name, text):
    (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "axis.yaml").write_text((EXAMPLES / "axis.plant.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    for file in EXAMPLES.glob("rkm_*.py"):
        (tmp_path / file.name).write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    if name.startswith("test_"):
        status, output = run_pytest(tmp_path, name)
        assert status == 0, output
    else:
        subprocess.run([sys.executable, name], cwd=tmp_path, check=True, timeout=120)
