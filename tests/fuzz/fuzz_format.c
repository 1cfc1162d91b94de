/* SPDX-License-Identifier: MIT */
/* fuzz_format.c: any bytes as a program text to be laid out. It is laid out unless the unit would refuse it; the commands stay
 * the same, and laying it out again changes nothing. */
#include <string.h>

#include "fuzz.h"
#include "program_tools/program_tools.h"
#include "text/text.h"

/* The same commands are in both texts. */
static void check_same(const char *before, size_t before_length, const char *after, size_t after_length)
{
    struct rkm04_reader left, right;
    enum rkm04_read found;
    rkm04_read_begin(&left, before, before_length);
    rkm04_read_begin(&right, after, after_length);
    do {
        struct rkm04_command a = {0}, b = {0};
        found = rkm04_read(&left, &a);
        FUZZ_CHECK(rkm04_read(&right, &b) == found, "command at %zu", left.start);
        FUZZ_CHECK(a.op == b.op && a.argument == b.argument, "command at %zu", left.start);
    } while (found == RKM04_READ_COMMAND);
    FUZZ_CHECK(found == RKM04_READ_END, "an error at %zu", left.start);
}

static bool is_refused(const char *text, size_t length)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    enum rkm04_read found;
    rkm04_read_begin(&reader, text, length);
    while ((found = rkm04_read(&reader, &command)) == RKM04_READ_COMMAND)
        continue;
    return found != RKM04_READ_END;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct program_source source = {"a.rks", (const char *)data, size, 1};
    char *mapped = malloc(size + 1), *text, *again;
    size_t length, again_length;
    FUZZ_CHECK(mapped != NULL, "memory");
    memcpy(mapped, data, size);
    const size_t mapped_length = program_text_map(mapped, size);
    const bool refused = is_refused(mapped, mapped_length);
    FUZZ_CHECK(format_program(&source, &text, &length) == (refused ? FORMAT_ERRORS : FORMAT_DONE), "%zu bytes", size);
    if (!refused) {
        const struct program_source laid_out = {"b.rks", text, length, 1};
        check_same(mapped, mapped_length, text, length);
        FUZZ_CHECK(format_program(&laid_out, &again, &again_length) == FORMAT_DONE, "again");
        FUZZ_CHECK(again_length == length && memcmp(again, text, length) == 0, "not the same again: %s", text);
        free(again);
    }
    free(text);
    free(mapped);
    return 0;
}
