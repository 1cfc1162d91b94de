/* SPDX-License-Identifier: MIT */
/* fuzz_lsp.c: any bytes for the language server. First byte odd: a stream of frames, in two pieces; even: a message in each line.
 * Every request is answered once, every message sent is JSON in a frame, and ranges are in order. */
#include <string.h>

#include "fuzz.h"
#include "lsp/lsp.h"

static char *sent;
static size_t sent_length;
static size_t answers, requests;

static void check_range(const json_t *range)
{
    struct document_position start, end;
    FUZZ_CHECK(session_read_position(json_object_get(range, "start"), &start) &&
                   session_read_position(json_object_get(range, "end"), &end),
               "no range");
    FUZZ_CHECK(start.line < end.line || (start.line == end.line && start.character <= end.character), "%zu:%zu-%zu:%zu",
               start.line, start.character, end.line, end.character);
}

/* Check all ranges in a message, wherever they are. */
static void check_ranges(const json_t *json)
{
    const char *key;
    json_t *value;
    size_t i;
    json_object_foreach((json_t *)json, key, value) {
        if (strcmp(key, "range") == 0)
            check_range(value);
        check_ranges(value);
    }
    json_array_foreach(json, i, value)
        check_ranges(value);
}

static void check_sent(void)
{
    for (const char *frame = sent; frame < sent + sent_length;) {
        char *end;
        FUZZ_CHECK(strncmp(frame, "Content-Length: ", 16) == 0, "%.40s", frame);
        const size_t length = strtoul(frame + 16, &end, 10);
        FUZZ_CHECK(strncmp(end, "\r\n\r\n", 4) == 0 && length <= (size_t)(sent + sent_length - end - 4), "%.40s", frame);
        json_t *json = json_loadb(end + 4, length, JSON_ALLOW_NUL, NULL);
        FUZZ_CHECK(json_is_object(json), "%.*s", (int)length, end + 4);
        const bool has_result = json_object_get(json, "result") != NULL, has_error = json_object_get(json, "error") != NULL;
        if (json_object_get(json, "id") != NULL && !json_is_null(json_object_get(json, "id")))
            answers++;
        FUZZ_CHECK((json_object_get(json, "method") != NULL) + has_result + has_error == 1, "%.*s", (int)length, end + 4);
        check_ranges(json);
        json_decref(json);
        frame = end + 4 + length;
    }
}

static void receive(struct lsp_server *server, const char *text, size_t length)
{
    char *copy = malloc(length + (length == 0));
    FUZZ_CHECK(copy != NULL, "memory");
    memcpy(copy, text, length);
    json_t *json = json_loadb(copy, length, JSON_ALLOW_NUL, NULL);
    const json_t *id = json_object_get(json, "id");
    if (json_is_string(json_object_get(json, "method")) && (json_is_integer(id) || json_is_string(id)))
        requests++;
    json_decref(json);
    lsp_receive(server, copy, length);
    free(copy);
}

static void receive_frames(struct lsp_server *server, const char *bytes, size_t length)
{
    struct frame_reader frames = {0};
    const char *text;
    size_t size;
    enum frame_found found = FRAME_NONE;
    for (unsigned piece = 0; piece < 2 && found != FRAME_BROKEN; piece++) {
        const size_t begin = piece == 0 ? 0 : length / 2, end = piece == 0 ? length / 2 : length;
        FUZZ_CHECK(frame_add(&frames, bytes + begin, end - begin), "memory");
        while ((found = frame_next(&frames, &text, &size)) == FRAME_MESSAGE || found == FRAME_TOO_LONG) {
            if (found == FRAME_MESSAGE)
                receive(server, text, size);
            else
                lsp_receive_too_long(server);
        }
    }
    frame_end(&frames);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct lsp_server server;
    struct fuzz fuzz = {data, size};
    const uint8_t mode = fuzz_byte(&fuzz);
    const struct session_options options = {.language = mode & 2 ? EXPLAIN_CZECH : EXPLAIN_ENGLISH};
    FILE *out = open_memstream(&sent, &sent_length);
    FUZZ_CHECK(out != NULL, "memory");
    answers = requests = 0;
    lsp_begin(&server, &options, out);
    if (mode & 1) {
        receive_frames(&server, (const char *)fuzz.at, fuzz.left);
    } else {
        while (fuzz.left > 0) {
            size_t length;
            const uint8_t *line = fuzz_until(&fuzz, '\n', &length);
            receive(&server, (const char *)line, length);
            if (mode & 4)
                lsp_report_changes(&server);
        }
    }
    lsp_report_changes(&server);
    lsp_end(&server);
    fclose(out);
    check_sent();
    free(sent);
    /* Halves of surrogate pairs are no JSON here, but the server mends them. */
    FUZZ_CHECK(answers >= requests, "%zu requests, %zu answers", requests, answers);
    return 0;
}
