# SPDX-License-Identifier: MIT
"""report.py: what came of the cases, as text for people and as JUnit for machines."""
import collections
import os
import time
from xml.sax.saxutils import escape, quoteattr

PASSED, FAILED, SKIPPED = "ok", "FAILED", "skipped"


class Result:
    def __init__(self, case, status, seconds=0.0, reason="", run=None, transcript=()):
        self.case, self.status, self.seconds, self.reason = case, status, seconds, reason
        self.mismatches = run.mismatches if run else []
        self.unseen = run.unseen if run else 0
        self.transcript = list(transcript)


def tell(result, verbose):
    """One result, as soon as it is there."""
    clauses = " ".join(result.case.clauses)
    behind = f": {result.reason}" if result.reason else ""
    print(f"{result.status:8}{clauses:16} {result.case.name}{behind}", flush=True)
    for mismatch in result.mismatches:
        print(f"          {mismatch.what}\n            expected: {mismatch.expected}\n            observed: {mismatch.observed}")
    if verbose or result.status == FAILED:
        for line in result.transcript if verbose else result.transcript[-12:]:
            print(f"          {line if verbose or len(line) <= 110 else line[:107] + '...'}")


def summary(results):
    counts = collections.Counter(result.status for result in results)
    why = collections.Counter(result.reason for result in results if result.status == SKIPPED)
    print(f"\n{counts[PASSED]} passed, {counts[FAILED]} failed, {counts[SKIPPED]} skipped")
    for reason, number in sorted(why.items()):
        print(f"  skipped, {reason}: {number}")
    unseen = sum(result.unseen for result in results)
    if unseen:
        print(f"  {unseen} finer expectations (ticks of motions, outputs) not looked at: they need a control socket")


def clean(text):
    """XML knows no control characters."""
    return "".join(c if c in "\n\t" or " " <= c else "." for c in text)


def why_not_junit(path, inputs, force):
    """Why the report must not go there; None: it may. Never over a file that is read; over one of another kind if forced."""
    if not os.path.exists(path):
        folder = os.path.dirname(path) or "."
        return None if os.path.isdir(folder) else f"{path}: there is no folder {folder}"
    for read in inputs:
        if read and os.path.exists(read) and os.path.samefile(path, read):
            return f"{path} is also read: expected a file of its own"
    if os.path.isdir(path):
        return f"{path} is a folder"
    if force or not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        begin = file.read(1000)
    if not begin or (begin.startswith((b"<?xml ", b"<testsuite")) and b"<testsuite" in begin):
        return None
    return f"{path} exists and is no JUnit report: --force replaces it"


def junit(path, results, about):
    counts = collections.Counter(result.status for result in results)
    with open(path, "w", encoding="utf-8") as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        file.write(f'<testsuite name="rkm04-conformance" tests="{len(results)}" failures="{counts[FAILED]}" '
                   f'skipped="{counts[SKIPPED]}" timestamp="{time.strftime("%Y-%m-%dT%H:%M:%S")}">\n  <properties>\n')
        for key, value in about.items():
            file.write(f"    <property name={quoteattr(key)} value={quoteattr(clean(str(value)))}/>\n")
        file.write("  </properties>\n")
        for result in results:
            file.write(f"  <testcase classname={quoteattr(' '.join(result.case.clauses))} name={quoteattr(result.case.name)} "
                       f'time="{result.seconds:.3f}">\n')
            if result.status == SKIPPED:
                file.write(f"    <skipped message={quoteattr(result.reason)}/>\n")
            for mismatch in result.mismatches:
                text = f"{mismatch.what}\nexpected: {mismatch.expected}\nobserved: {mismatch.observed}"
                file.write(f"    <failure message={quoteattr(clean(str(mismatch)))}>{escape(clean(text))}</failure>\n")
            if result.transcript and result.status == FAILED:
                file.write(f"    <system-out>{escape(clean(chr(10).join(result.transcript)))}</system-out>\n")
            file.write("  </testcase>\n")
        file.write("</testsuite>\n")
