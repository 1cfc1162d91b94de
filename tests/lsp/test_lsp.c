/* SPDX-License-Identifier: MIT */
/* test_lsp.c: the language server, message by message: positions, edits, what is refused, limits. tests/system/lsp.sh is a real
 * client. One case alone: CK_RUN_CASE=positions ./test_lsp */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lsp/features.h"
#include "lsp/lsp.h"

#define URI "file:///p.rks"
#define DOCUMENT "\"textDocument\":{\"uri\":\"" URI "\"}"

static struct lsp_server server;
static char *sent;
static size_t sent_length;
static FILE *out;
static char answer[1u << 20]; /* the JSON of the last message, without the frame */

static void set_up(void)
{
    static const struct session_options options;
    out = open_memstream(&sent, &sent_length);
    ck_assert_ptr_nonnull(out);
    lsp_begin(&server, &options, out);
}

static void tear_down(void)
{
    lsp_end(&server);
    fclose(out);
    free(sent);
}

/* Hand a message in, of just its size, so that a read behind its end is noticed. Returns the last message sent, "" if none is. */
static const char *send_bytes(const char *text, size_t length)
{
    char *copy = malloc(length + (length == 0));
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, text, length);
    fflush(out);
    const size_t before = sent_length;
    lsp_receive(&server, copy, length);
    lsp_report_changes(&server);
    fflush(out);
    free(copy);
    answer[0] = '\0';
    for (const char *frame = sent + before; frame < sent + sent_length;) {
        char *end;
        ck_assert_int_eq(strncmp(frame, "Content-Length: ", 16), 0);
        const size_t size = strtoul(frame + 16, &end, 10);
        ck_assert_int_eq(strncmp(end, "\r\n\r\n", 4), 0);
        ck_assert_uint_lt(size, sizeof answer);
        memcpy(answer, end + 4, size);
        answer[size] = '\0';
        frame = end + 4 + size;
    }
    return answer;
}

static const char *send(const char *text)
{
    return send_bytes(text, strlen(text));
}

static void initialize(void)
{
    const char *got = send("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"initialize\",\"params\":{}}");
    ck_assert_ptr_nonnull(strstr(got, "\"utf-16\""));
}

/* Open a text, given as the inside of a JSON string. */
static const char *open_text(const char *text)
{
    char message[5000];
    snprintf(message, sizeof message,
             "{\"method\":\"textDocument/didOpen\",\"params\":{\"textDocument\":{\"uri\":\"" URI "\",\"version\":1,"
             "\"text\":\"%s\"}}}",
             text);
    return send(message);
}

/* Replace a range of the text. */
static const char *edit(const char *start, const char *end, const char *text)
{
    char message[4096];
    snprintf(message, sizeof message,
             "{\"method\":\"textDocument/didChange\",\"params\":{\"textDocument\":{\"uri\":\"" URI "\",\"version\":2},"
             "\"contentChanges\":[{\"range\":{\"start\":{%s},\"end\":{%s}},\"text\":\"%s\"}]}}",
             start, end, text);
    return send(message);
}

static const char *ask(const char *method, const char *params)
{
    char message[4096];
    snprintf(message, sizeof message, "{\"id\":7,\"method\":\"textDocument/%s\",\"params\":{" DOCUMENT "%s%s}}", method,
             params[0] != '\0' ? "," : "", params);
    return send(message);
}

#define AT(line, character) "\"line\":" #line ",\"character\":" #character
#define POSITION(line, character) "\"position\":{" AT(line, character) "}"
#define RANGE(line, from, to) "{\"start\":{" AT(line, from) "},\"end\":{" AT(line, to) "}}"

static const char *text_now(void)
{
    static char text[4096];
    const struct document *document = session_find(&server.session, URI);
    ck_assert_ptr_nonnull(document);
    ck_assert_uint_lt(document->length, sizeof text);
    if (document->length > 0)
        memcpy(text, document->text, document->length);
    text[document->length] = '\0';
    return text;
}

static void holds(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "expected %s in %s", part, text);
}

/* ---- Positions and edits ------------------------------------------------------------------------------------------------ */

START_TEST(positions_count_utf16_units)
{
    initialize();
    holds(open_text("{čau 😀} q\\n{’} V0"), RANGE(0, 9, 10));
    holds(answer, RANGE(1, 4, 6));
    edit(AT(0, 9), AT(0, 10), "R");
    ck_assert_str_eq(text_now(), "{čau 😀} R\n{’} V0");
    edit(AT(0, 5), AT(0, 7), "x");
    ck_assert_str_eq(text_now(), "{čau x} R\n{’} V0");
}
END_TEST

START_TEST(positions_inside_and_after_are_clipped)
{
    initialize();
    open_text("{😀}\\nR");
    edit(AT(0, 2), AT(0, 3), "a"); /* from the middle of the pair: from its beginning */
    ck_assert_str_eq(text_now(), "{a}\nR");
    edit(AT(0, 99), AT(0, 99), " R");
    ck_assert_str_eq(text_now(), "{a} R\nR");
    edit(AT(99, 0), AT(99, 5), "\\nH");
    ck_assert_str_eq(text_now(), "{a} R\nR\nH");
}
END_TEST

START_TEST(lines_end_with_any_of_three)
{
    initialize();
    holds(open_text("R\\rR\\r\\nq\\nx"), RANGE(2, 0, 1));
    holds(answer, RANGE(3, 0, 1));
    edit(AT(1, 9), AT(1, 9), "W5");
    ck_assert_str_eq(text_now(), "R\rRW5\r\nq\nx");
    edit(AT(0, 1), AT(2, 0), " ");
    ck_assert_str_eq(text_now(), "R q\nx");
}
END_TEST

START_TEST(diagnostics_far_after_have_the_right_place)
{
    char text[4000] = "", *at = text;
    initialize();
    for (unsigned i = 0; i < 300; i++)
        at += sprintf(at, "{😀}\\n");
    strcpy(at, "{😀} q");
    holds(open_text(text), RANGE(300, 5, 6));
}
END_TEST

START_TEST(half_a_surrogate_pair_is_a_character)
{
    initialize();
    open_text("{\\ud83d} q");
    ck_assert_str_eq(text_now(), "{\xEF\xBF\xBD} q");
    holds(answer, RANGE(0, 4, 5));
    open_text("{\\ude00\\ud83d\\ud83d\\ude00\\\\ud83d} q");
    ck_assert_str_eq(text_now(), "{\xEF\xBF\xBD\xEF\xBF\xBD😀\\ud83d} q");
}
END_TEST

/* Random edits of a text, as an editor would make them in UTF-16, against an array of units. */
START_TEST(random_edits_give_the_text_of_the_editor)
{
    static const char *const pieces[] = {"R", "\\n", "č", "😀", "\\r\\n", "{ }"};
    static const unsigned short units[][3] = {{'R'}, {'\n'}, {0x10D}, {0xD83D, 0xDE00}, {'\r', '\n'}, {'{', ' ', '}'}};
    unsigned short mirror[4096];
    size_t length = 0;
    unsigned state = 1;
    initialize();
    open_text("");
    for (unsigned round = 0; round < 400; round++) {
        state = state * 1664525u + 1013904223u;
        const unsigned piece = (state >> 8) % 6, delete = (state >> 16) % 3;
        size_t from = length == 0 ? 0 : (state >> 12) % (length + 1), line = 0, start = 0;
        const bool splits = from > 0 && from < length &&
                            ((mirror[from - 1] == '\r' && mirror[from] == '\n') || (mirror[from] & 0xFC00) == 0xDC00);
        from -= splits;
        size_t to = from;
        while (to < length && to - from < delete && mirror[to] != '\n' && mirror[to] != '\r')
            to += (mirror[to] & 0xFC00) == 0xD800 ? 2 : 1;
        for (size_t i = 0; i < from; i++)
            if (mirror[i] == '\n' || (mirror[i] == '\r' && (i + 1 == length || mirror[i + 1] != '\n'))) {
                line++;
                start = i + 1;
            }
        char a[64], b[64];
        snprintf(a, sizeof a, "\"line\":%zu,\"character\":%zu", line, from - start);
        snprintf(b, sizeof b, "\"line\":%zu,\"character\":%zu", line, to - start);
        edit(a, b, pieces[piece]);
        size_t added = 0;
        while (added < 3 && units[piece][added] != 0)
            added++;
        memmove(mirror + from + added, mirror + to, (length - to) * sizeof mirror[0]);
        memcpy(mirror + from, units[piece], added * sizeof mirror[0]);
        length += added - (to - from);
    }
    const char *text = text_now();
    for (size_t i = 0; i < length; i++) {
        const unsigned char lead = (unsigned char)*text;
        const size_t bytes = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : 4;
        ck_assert_uint_eq(mirror[i], bytes == 1 ? lead : bytes == 2 ? 0x10D : 0xD83D);
        i += bytes == 4;
        text += bytes;
    }
    ck_assert_int_eq(*text, '\0');
}
END_TEST

/* ---- Answers ------------------------------------------------------------------------------------------------------------- */

START_TEST(labels_are_found_and_renamed)
{
    initialize();
    open_text("@1 F5 R J 01 I03H1\\n\\\\@1 J1 @1");
    holds(ask("definition", POSITION(0, 9)), RANGE(0, 0, 2));
    holds(ask("definition", POSITION(1, 5)), RANGE(1, 7, 9)); /* the last one counts, in its own program */
    holds(ask("rename", POSITION(0, 0) ",\"newName\":\"@12\""), RANGE(0, 10, 12));
    holds(answer, RANGE(0, 17, 18));
    holds(answer, RANGE(0, 1, 2));
    ck_assert_ptr_null(strstr(answer, "\"line\":1"));
    holds(ask("rename", POSITION(0, 0) ",\"newName\":\"81\""), "expected a label 1..80, found `81'");
    holds(ask("rename", POSITION(0, 3) ",\"newName\":\"2\""), "there is no label here");
    ck_assert_str_eq(ask("definition", POSITION(0, 3)), "{\"jsonrpc\":\"2.0\",\"id\":7,\"result\":null}");
}
END_TEST

START_TEST(a_label_is_not_renamed_into_one_that_is_jumped_to)
{
    initialize();
    open_text("@1 J1 J9");
    holds(ask("rename", POSITION(0, 0) ",\"newName\":\"9\""), "label 9 is used already");
    holds(ask("rename", POSITION(0, 0) ",\"newName\":\"1\""), "\"changes\"");
}
END_TEST

START_TEST(a_lens_says_what_a_program_takes)
{
    initialize();
    open_text("V1000 A10000 S100 F18000 R");
    holds(ask("codeLens", ""), "\"title\":\"runs 18.1 s, 18 000 steps\"");
    open_text("O03 W250");
    holds(ask("codeLens", ""), "\"title\":\"runs 253 ms, 0 steps; inputs come at once: 03\"");
    open_text("@1 W100 F10 R J1");
    holds(ask("codeLens", ""), "a round takes ");
    open_text("W10 G+");
    holds(ask("codeLens", ""), "then moves without an end");
    open_text("(01");
    holds(ask("codeLens", ""), "runs 1 ms, 0 steps; then in line 1: move back at start/stop speed until input 01 is 1");
    open_text("(01");
    holds(ask("codeLens", ""), "runs 1 ms, 0 steps; then in line 1: move back at start/stop speed until input 01 is 1");
    open_text("E");
    holds(ask("codeLens", ""), "then stops with a fault");
    open_text("O80");
    holds(ask("codeLens", ""), "; then in line 1: wait until variable 80 is 1");
    open_text("L255 L255 L255 F1 R E E E");
    holds(ask("codeLens", ""), "takes longer than the first 5000 commands");
    open_text("q");
    holds(ask("codeLens", ""), "\"result\":[]");
    open_text("");
    holds(ask("codeLens", ""), "\"result\":[]");
}
END_TEST

START_TEST(hover_tells_command_and_motion)
{
    initialize();
    open_text("S100 V1000 A10000 F1000 L3 R E");
    holds(ask("hover", POSITION(0, 27)), "`R` move: 1000 steps forward; S100 V1000 A10000");
    holds(answer, "1 000 steps in 1.081");
    holds(answer, "3 times");
    holds(answer, "break points: (1;100)");
    holds(ask("hover", POSITION(0, 99)), "end of the loop");
    holds(ask("hover", POSITION(9, 0)), "end of the loop");
    open_text("{R}");
    holds(ask("hover", POSITION(0, 1)), "\"result\":null");
}
END_TEST

START_TEST(completion_knows_the_place)
{
    initialize();
    open_text("@7 @40 T T01V5 I J I03H4 '{nolint un} {R}");
    holds(ask("completion", POSITION(0, 8)), "\"label\":\"01\"");
    holds(answer, "output 01 on");
    holds(ask("completion", POSITION(0, 0)), "set n steps forward (1..16000000)");
    holds(ask("completion", POSITION(0, 14)), "maximum speed n steps/s (1..16000)"); /* behind a number */
    holds(ask("completion", POSITION(0, 16)), "\"label\":\"80\"");
    holds(ask("completion", POSITION(0, 18)), "\"label\":\"40\"");
    holds(ask("completion", POSITION(0, 24)), RANGE(0, 23, 24)); /* the 4 of I03H4 becomes another label */
    ck_assert_ptr_null(strstr(answer, "\"label\":\"80\""));
    holds(ask("completion", POSITION(0, 22)), "\"label\":\"H\"");
    holds(ask("completion", POSITION(0, 26)), "\"label\":\"7\"");
    holds(ask("completion", POSITION(0, 36)), "\"label\":\"unused-label\"");
    holds(answer, RANGE(0, 34, 36));
    holds(ask("completion", POSITION(0, 40)), "\"items\":[]");
}
END_TEST

START_TEST(an_outline_has_labels_and_subroutines_up_to_a_limit)
{
    char text[4000] = "";
    initialize();
    open_text("@1 '2 J1 @2 R . W5");
    holds(ask("documentSymbol", ""), "\"name\":\"@1\",\"detail\":\"label\"");
    holds(answer, "\"name\":\"@2\",\"detail\":\"subroutine\"");
    holds(answer, RANGE(0, 9, 15)); /* through its last . */
    for (size_t at = 0; at + 3 < sizeof text; at += 3)
        memcpy(text + at, "@1 ", 3);
    open_text(text);
    struct session_refusal refusal = {0};
    json_t *params = json_pack("{s:{s:s}}", "textDocument", "uri", URI);
    json_t *list = lsp_list_symbols(&server.session, params, &refusal);
    ck_assert_uint_eq(json_array_size(list), 1000);
    json_decref(list);
    json_decref(params);
}
END_TEST

START_TEST(layout_changes_only_lines_that_change)
{
    initialize();
    open_text("F5 R\\nL2 F5 R E\\nH\\n");
    holds(ask("formatting", ""), "\"newText\":\"L2\\n    F5 R\\nE\\n\"");
    holds(answer, "{\"start\":{" AT(1, 0) "},\"end\":{" AT(2, 0) "}}");
    open_text("F5 R\\n");
    holds(ask("formatting", ""), "\"result\":[]");
    open_text("f5 R\\n");
    holds(ask("formatting", ""), "\"result\":null");
}
END_TEST

/* ---- What is refused ------------------------------------------------------------------------------------------------------ */

START_TEST(requests_have_their_order)
{
    holds(send("{\"id\":\"a\",\"method\":\"shutdown\"}"), "\"id\":\"a\",\"error\":{\"code\":-32002");
    ck_assert_str_eq(open_text("q"), "");
    initialize();
    holds(send("{\"id\":2,\"method\":\"initialize\",\"params\":{}}"), "-32600");
    holds(send("{\"id\":3,\"method\":\"workspace/symbol\"}"),
          "\"code\":-32601,\"message\":\"there is no method `workspace/symbol'\"");
    ck_assert_str_eq(send("{\"method\":\"$/setTrace\",\"params\":{\"value\":\"off\"}}"), "");
    ck_assert_str_eq(send("{\"id\":4,\"result\":null}"), "");
    ck_assert_str_eq(send("{\"id\":5,\"method\":\"shutdown\"}"), "{\"jsonrpc\":\"2.0\",\"id\":5,\"result\":null}");
    holds(ask("hover", POSITION(0, 0)), "-32600");
    ck_assert(!server.has_exited);
    send("{\"method\":\"exit\"}");
    ck_assert(server.has_exited);
}
END_TEST

START_TEST(wrong_parameters_are_named)
{
    initialize();
    holds(send("{\"id\":7,\"method\":\"textDocument/hover\"}"), "-32602,\"message\":\"expected textDocument with a uri\"");
    holds(ask("hover", POSITION(0, 0)), "the document is not open");
    open_text("R");
    holds(ask("hover", ""), "expected a position with line and character");
    holds(ask("hover", POSITION(-1, 0)), "expected a position with line and character");
    holds(ask("rename", POSITION(0, 0)), "there is no label here");
    holds(send("{\"id\":[],\"method\":\"shutdown\"}"), "\"id\":null,\"error\":{\"code\":-32600");
    holds(send("[]"), "-32600");
}
END_TEST

START_TEST(an_edit_that_is_none_makes_the_text_unknown_until_it_is_opened_again)
{
    initialize();
    open_text("q");
    holds(edit(AT(0, 1), AT(0, 0), ""), "not-checked");
    ck_assert_str_eq(edit(AT(0, 0), AT(0, 0), "R"), ""); /* it is still the same */
    holds(ask("hover", POSITION(0, 0)), "\"result\":null");
    holds(open_text("q"), "unknown-command");
    holds(send("{"), "not-checked");
    holds(send("{\"method\":\"textDocument/didChange\",\"params\":{\"textDocument\":{\"uri\":\"" URI "\"},"
               "\"contentChanges\":[{\"text\":\"x\"}]}}"),
          "unknown-command");
}
END_TEST

START_TEST(a_text_that_is_too_long_is_not_checked)
{
    const size_t size = DOCUMENT_LENGTH_MAX + 4096;
    char *message = malloc(size);
    initialize();
    open_text("q");
    int length = sprintf(message, "{\"method\":\"textDocument/didChange\",\"params\":{\"textDocument\":{\"uri\":\"" URI "\"},"
                                  "\"contentChanges\":[{\"text\":\"");
    memset(message + length, ' ', DOCUMENT_LENGTH_MAX + 1);
    strcpy(message + length + DOCUMENT_LENGTH_MAX + 1, "\"}]}}");
    holds(send(message), "longer than 256 KiB");
    strcpy(message + length + DOCUMENT_LENGTH_MAX, "\"}]}}");
    holds(send(message), "\"diagnostics\":[]");
    free(message);
}
END_TEST

START_TEST(a_document_too_many_is_not_checked)
{
    char message[300];
    initialize();
    for (unsigned i = 0; i <= SESSION_DOCUMENTS_MAX; i++) {
        snprintf(message, sizeof message,
                 "{\"method\":\"textDocument/didOpen\",\"params\":{\"textDocument\":{\"uri\":\"%u\",\"text\":\"q\"}}}", i);
        holds(send(message), i < SESSION_DOCUMENTS_MAX ? "unknown-command" : "more than 200 documents are open");
    }
    holds(send("{\"method\":\"textDocument/didClose\",\"params\":{\"textDocument\":{\"uri\":\"5\"}}}"), "\"diagnostics\":[]");
    holds(send(message), "unknown-command");
}
END_TEST

/* ---- Frames --------------------------------------------------------------------------------------------------------------- */

static struct frame_reader frames;

static enum frame_found take(const char *bytes, const char **text, size_t *length)
{
    ck_assert(frame_add(&frames, bytes, strlen(bytes)));
    return frame_next(&frames, text, length);
}

START_TEST(frames_come_in_any_pieces)
{
    static const char stream[] = "Content-Length: 2\r\n\r\n{}"
                                 "content-length:3\r\nContent-Type: x\r\n\r\n[1]Content-Length: 0\r\n\r\n";
    const char *text;
    size_t length, count = 0;
    for (const char *at = stream; *at != '\0'; at++) {
        const char one[] = {*at, '\0'};
        if (take(one, &text, &length) != FRAME_MESSAGE)
            continue;
        ck_assert_uint_eq(length, count == 0 ? 2 : count == 1 ? 3 : 0);
        ck_assert_int_eq(memcmp(text, count == 0 ? "{}" : "[1]", length), 0);
        count++;
    }
    ck_assert_uint_eq(count, 3);
    frame_end(&frames);
}
END_TEST

START_TEST(a_frame_too_long_is_skipped)
{
    const char *text;
    size_t length;
    char part[1001];
    memset(part, 'x', 1000);
    part[1000] = '\0';
    ck_assert_int_eq(take("Content-Length: 40000000\r\n\r\nxxxxx", &text, &length), FRAME_TOO_LONG);
    for (unsigned i = 0; i < 39999; i++)
        ck_assert_int_eq(take(part, &text, &length), FRAME_NONE);
    part[995] = '\0';
    ck_assert_int_eq(take(part, &text, &length), FRAME_NONE);
    ck_assert_int_eq(take("Content-Length: 1\r\n\r\n5", &text, &length), FRAME_MESSAGE);
    frame_end(&frames);
}
END_TEST

START_TEST(what_is_no_frame_ends_the_stream)
{
    static const char *const wrong[] = {"hello\r\n\r\n", "Content-Length: x\r\n\r\n", "Content-Length: -1\r\n\r\n",
                                        "Content-Length: 9999999999999999\r\n\r\n", "\r\n"};
    const char *text;
    size_t length;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        ck_assert_int_eq(take(wrong[i], &text, &length), FRAME_BROKEN);
        frame_end(&frames);
    }
    enum frame_found found = FRAME_NONE;
    for (unsigned i = 0; found == FRAME_NONE && i < 500; i++)
        found = take("X-Nothing: 1\r\n", &text, &length);
    ck_assert_int_eq(found, FRAME_BROKEN);
    frame_end(&frames);
}
END_TEST

/* ---- Texts of a CNC872 -------------------------------------------------------------------------------------------------- */

static const char *put_file(const char *method, const char *uri, const char *text)
{
    char message[2000];
    snprintf(message, sizeof message,
             "{\"method\":\"textDocument/%s\",\"params\":{\"textDocument\":{\"uri\":\"%s\",\"version\":1,\"text\":\"%s\"},"
             "\"contentChanges\":[{\"text\":\"%s\"}]}}",
             method, uri, text, text);
    return send(message);
}

START_TEST(texts_of_a_cnc_have_the_errors_of_check)
{
    initialize();
    holds(put_file("didOpen", "file:///m/a.nc", "G1 X1 F100\\nG1 Q1"), RANGE(1, 3, 5));
    holds(answer, "\"code\":\"nc-error\"");
    holds(put_file("didOpen", "file:///m/a.plc", "MODULE_MAIN\\n TIM 3\\nMODULE_MAIN_END"), "\"code\":\"plc-error\"");
    holds(put_file("didChange", "file:///m/a.plc", "MODULE_MAIN\\nMODULE_MAIN_END"), "\"diagnostics\":[]");
    holds(put_file("didOpen", "file:///m/a.xml", "<ChannelConfig><Axis Name=\\\"Q\\\"/></ChannelConfig>"),
          "\"diagnostics\""); /* of the NC program, which is reported again */
    holds(send("{\"id\":7,\"method\":\"textDocument/hover\",\"params\":{\"textDocument\":{\"uri\":\"file:///m/a.nc\"},"
               "\"position\":{\"line\":0,\"character\":0}}}"),
          "\"result\":null");
}
END_TEST

START_TEST(an_nc_program_has_the_axes_of_the_configuration_beside_it)
{
    initialize();
    holds(put_file("didOpen", "file:///m/a.nc", "G1 A4=1 F100"), "nc-error");
    holds(put_file("didOpen", "file:///other/a.xml", "<ChannelConfig><Axis Name=\\\"4\\\"/></ChannelConfig>"), "a.xml");
    holds(put_file("didOpen", "file:///m/a.xml", "<ChannelConfig><Axis Name=\\\"4\\\"/></ChannelConfig>"), "m/a.nc");
    holds(answer, "\"diagnostics\":[]");
    holds(put_file("didChange", "file:///m/a.xml", "<ChannelConfig><Axis Name=\\\"X\\\"/></ChannelConfig>"), "nc-error");
}
END_TEST

START_TEST(an_error_of_a_cnc_underlines_its_word)
{
    initialize();
    holds(put_file("didOpen", "file:///m/a.nc", "G1 X1A4=5.5Y2 F1"), RANGE(0, 5, 11));
    holds(put_file("didChange", "file:///m/a.nc", "G1 X1 \xC5\x99 F1"), RANGE(0, 6, 7));
    holds(put_file("didOpen", "file:///m/a.plc", "MODULE_MAIN\\n TIMER_3,5 X\\nMODULE_MAIN_END"), RANGE(1, 1, 8));
    holds(put_file("didOpen", "file:///n/b.xml", "<ChannelConfig><Axes/></ChannelConfig>"), RANGE(0, 15, 20));
    holds(put_file("didChange", "file:///n/b.xml", "<ChannelConfig><Axis Name=\\\"Quite\\\"/></ChannelConfig>"),
          RANGE(0, 27, 32));
}
END_TEST

static void add_case(Suite *suite, const char *name, const TTest *const *tests)
{
    TCase *one = tcase_create(name);
    tcase_add_checked_fixture(one, set_up, tear_down);
    tcase_set_timeout(one, 60);
    for (; *tests != NULL; tests++)
        tcase_add_test(one, *tests);
    suite_add_tcase(suite, one);
}

int main(void)
{
    Suite *suite = suite_create("lsp");
    add_case(suite, "positions",
             (const TTest *const[]){positions_count_utf16_units, positions_inside_and_after_are_clipped,
                                    lines_end_with_any_of_three, diagnostics_far_after_have_the_right_place,
                                    half_a_surrogate_pair_is_a_character, random_edits_give_the_text_of_the_editor, NULL});
    add_case(suite, "answers",
             (const TTest *const[]){labels_are_found_and_renamed, a_label_is_not_renamed_into_one_that_is_jumped_to,
                                    a_lens_says_what_a_program_takes, hover_tells_command_and_motion, completion_knows_the_place,
                                    an_outline_has_labels_and_subroutines_up_to_a_limit,
                                    layout_changes_only_lines_that_change, NULL});
    add_case(suite, "refused",
             (const TTest *const[]){requests_have_their_order, wrong_parameters_are_named,
                                    an_edit_that_is_none_makes_the_text_unknown_until_it_is_opened_again,
                                    a_text_that_is_too_long_is_not_checked, a_document_too_many_is_not_checked, NULL});
    add_case(suite, "cnc",
             (const TTest *const[]){texts_of_a_cnc_have_the_errors_of_check,
                                    an_nc_program_has_the_axes_of_the_configuration_beside_it,
                                    an_error_of_a_cnc_underlines_its_word, NULL});
    add_case(suite, "frames",
             (const TTest *const[]){frames_come_in_any_pieces, a_frame_too_long_is_skipped, what_is_no_frame_ends_the_stream,
                                    NULL});
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
