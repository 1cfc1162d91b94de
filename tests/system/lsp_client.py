# SPDX-License-Identifier: MIT
"""lsp_client.py CASE RKM04: an editor made of pygls at `rkm04 lsp`. Exit status 0: it is as it should be."""
import asyncio
import random
import sys

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

URI = "file:///tmp/drill.rks"
DOCUMENT = lsp.TextDocumentIdentifier(uri=URI)
WITHIN = 60  # seconds until a condition counts as never coming true


class Editor(LanguageClient):
    def __init__(self):
        super().__init__("editor", "1")
        self.version = 0
        self.reports = asyncio.Queue()
        self.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(lambda report: self.reports.put_nowait(report))

    async def begin(self, *command):
        await self.start_io(*command)
        result = await self.initialize_async(lsp.InitializeParams(capabilities=lsp.ClientCapabilities()))
        self.initialized(lsp.InitializedParams())
        return result

    def open(self, text):
        self.version += 1
        self.text_document_did_open(lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(URI, "rks", self.version, text)))

    def edit(self, start, end, text):
        self.version += 1
        change = lsp.TextDocumentContentChangePartial(lsp.Range(lsp.Position(*start), lsp.Position(*end)), text)
        self.text_document_did_change(lsp.DidChangeTextDocumentParams(
            lsp.VersionedTextDocumentIdentifier(self.version, URI), [change]))

    async def diagnostics(self):
        """Those of the present version."""
        while True:
            report = await asyncio.wait_for(self.reports.get(), WITHIN)
            if report.version == self.version:
                return [(str(one.code), span(one.range), one.severity) for one in report.diagnostics]

    async def end(self):
        await self.shutdown_async(None)
        self.exit(None)
        await asyncio.wait_for(self._server.wait(), WITHIN)
        return self._server.returncode


def span(where):
    return (where.start.line, where.start.character, where.end.line, where.end.character)


def same(wanted, got):
    if wanted != got:
        sys.exit(f"expected {wanted!r}, got {got!r}")


def at(line, character):
    return {"text_document": DOCUMENT, "position": lsp.Position(line, character)}


async def case_diagnostics_follow_edits(editor):
    editor.open("{čau 😀} q\nF9 R\n")
    same([("unknown-command", (0, 9, 0, 10), lsp.DiagnosticSeverity.Error)],
         [one for one in await editor.diagnostics() if one[2] == lsp.DiagnosticSeverity.Error])
    editor.edit((0, 9), (0, 10), "@1")
    same(["unused-label"], [name for name, _, _ in await editor.diagnostics() if name != "speed-not-reached"])
    editor.edit((1, 4), (1, 4), "\nJ1")
    same([], [name for name, _, _ in await editor.diagnostics() if name != "speed-not-reached"])
    editor.text_document_did_close(lsp.DidCloseTextDocumentParams(DOCUMENT))
    same(0, len((await asyncio.wait_for(editor.reports.get(), WITHIN)).diagnostics))


async def case_labels(editor):
    editor.open("'41 J1 @1 W9 J1\n@41 B100 R .\n")
    found = await editor.text_document_definition_async(lsp.DefinitionParams(**at(0, 1)))
    same((1, 0, 1, 3), span(found.range))
    found = await editor.text_document_references_async(
        lsp.ReferenceParams(context=lsp.ReferenceContext(include_declaration=False), **at(0, 8)))
    same([(0, 4, 0, 6), (0, 13, 0, 15)], [span(one.range) for one in found])
    found = await editor.text_document_rename_async(lsp.RenameParams(new_name="50", **at(1, 1)))
    same([((0, 1, 0, 3), "50"), ((1, 1, 1, 3), "50")], [(span(one.range), one.new_text) for one in found.changes[URI]])
    symbols = await editor.text_document_document_symbol_async(lsp.DocumentSymbolParams(DOCUMENT))
    same([("@1", (0, 7, 0, 15)), ("@41", (1, 0, 1, 12))], [(one.name, span(one.range)) for one in symbols])
    try:
        await editor.text_document_rename_async(lsp.RenameParams(new_name="0", **at(1, 1)))
        sys.exit("renamed to 0")
    except JsonRpcException as error:
        same("expected a label 1..80, found `0'", error.message)


async def case_hover_lens_and_layout(editor):
    editor.open("S100 V1000 A10000\nF18000 R")
    hover = await editor.text_document_hover_async(lsp.HoverParams(**at(1, 7)))
    same(True, hover.contents.value.startswith("`R` move: 18000 steps forward; S100 V1000 A10000"))
    same((1, 7, 1, 8), span(hover.range))
    lenses = await editor.text_document_code_lens_async(lsp.CodeLensParams(DOCUMENT))
    same(["runs 18.1 s, 18 000 steps"], [one.command.title for one in lenses])
    edits = await editor.text_document_formatting_async(
        lsp.DocumentFormattingParams(DOCUMENT, lsp.FormattingOptions(tab_size=4, insert_spaces=True)))
    same([((1, 0, 1, 8), "F18000 R\n")], [(span(one.range), one.new_text) for one in edits])


async def case_completion_has_ranges(editor):
    editor.open("@7 T0")
    found = await editor.text_document_completion_async(lsp.CompletionParams(**at(0, 5)))
    same(("01", (0, 4, 0, 5)), (found.items[0].label, span(found.items[0].text_edit.range)))
    found = await editor.text_document_completion_async(lsp.CompletionParams(**at(0, 0)))
    same("set n steps forward (1..16000000)", next(one.detail for one in found.items if one.label == "F"))
    editor.edit((0, 3), (0, 5), "J")
    found = await editor.text_document_completion_async(lsp.CompletionParams(**at(0, 4)))
    same(["7"], [one.label for one in found.items])


async def case_a_fast_typist(editor):
    """Thousands of edits in a text of 700 commands, none waited for: at the end the server has the text of the editor."""
    chance = random.Random(1)
    units = list("F10 R " * 350)
    editor.open("".join(units))
    for _ in range(3000):
        from_ = chance.randrange(len(units))
        to = min(len(units), from_ + chance.randrange(3))
        added = chance.choice(["R ", "F5 ", "{😀}", "č", "", " "])
        editor.edit((0, sum(len(unit) for unit in units[:from_])), (0, sum(len(unit) for unit in units[:to])), added)
        units[from_:to] = [unit + " " if ord(unit) > 0xFFFF else unit for unit in added]  # as long as in UTF-16
    found = await editor.diagnostics()
    editor.open("".join(unit.strip() if len(unit) > 1 else unit for unit in units))
    same(found, await editor.diagnostics())


async def case_czech(editor):
    editor.open("F100 R")
    hover = await editor.text_document_hover_async(lsp.HoverParams(**at(0, 5)))
    same(True, "proveď pohyb" in hover.contents.value)
    same([], await editor.diagnostics())  # the options switch them off


async def main(name, program):
    editor = Editor()
    options = ["--lang", "cs", "--no-warn", "all"] if name == "czech" else ["--stdio"]
    result = await editor.begin(program, "lsp", *options)
    same("utf-16", result.capabilities.position_encoding)
    await globals()["case_" + name](editor)
    same(0, await editor.end())


asyncio.run(main(*sys.argv[1:3]))
