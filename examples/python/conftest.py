# SPDX-License-Identifier: MIT
"""The library under test is beside its tests."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
