/* SPDX-License-Identifier: MIT */
#include "file_guess.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define LOOKED_AT 4096u /* bytes */

/* A file is the first of these that fits. */
static const struct {
    const char *begins, *line; /* what it begins with; what one of its lines begins with; NULL: anything */
    const char *what;
} guesses[] = {
    {"{\"rkm04_record\":", NULL, "a recording, for `rkm04 replay'"},
    {"{\"t_us\":", NULL, "a trace as JSON Lines"},
    {"t_us,source,event,value", NULL, "a trace as CSV, for `rkm04 plot'"},
    {"$version", NULL, "a VCD trace"},
    {"$date", NULL, "a VCD trace"},
    {"# rkm04 wire log ", NULL, "a log of the wires"},
    {"\n\r\r\n", NULL, "a pcapng capture of the wires, for Wireshark"},
    {"\x89PNG", NULL, "a picture"},
    {"<svg", NULL, "a picture"},
    {NULL, "<testsuite", "a JUnit report"},
    {NULL, "<ChannelConfig", "a configuration of a CNC872"},
    {NULL, "<MFunctions", "a configuration of a CNC872"},
    {NULL, "MODULE_MAIN", "a PLC program of a CNC872"},
    {NULL, "steps:", "a scenario, for `rkm04 test'"},
    {"tcp:127.0.0.1:", NULL, "a control file, for --control"},
};

static bool begins_with(const char *bytes, size_t length, const char *text)
{
    const size_t size = strlen(text);
    return length >= size && memcmp(bytes, text, size) == 0;
}

static bool has_line(const char *bytes, size_t length, const char *text)
{
    const char *end = bytes + length;
    for (const char *at = bytes; at != NULL && at < end; at = memchr(at, '\n', (size_t)(end - at))) {
        while (at < end && (*at == '\n' || *at == ' ' || *at == '\t'))
            at++;
        if (begins_with(at, (size_t)(end - at), text))
            return true;
    }
    return false;
}

const char *file_guess(const char *bytes, size_t length)
{
    length = length < LOOKED_AT ? length : LOOKED_AT;
    if (length == 0)
        return NULL;
    for (size_t i = 0; i < sizeof guesses / sizeof guesses[0]; i++)
        if ((guesses[i].begins == NULL || begins_with(bytes, length, guesses[i].begins)) &&
            (guesses[i].line == NULL || has_line(bytes, length, guesses[i].line)))
            return guesses[i].what;
    return memchr(bytes, 0, length) != NULL ? "no text" : NULL;
}

void file_guess_note(const char *program, const char *name, const char *expected, const char *bytes, size_t length)
{
    const char *guess = file_guess(bytes, length);
    if (guess != NULL && (expected == NULL || strncmp(guess, expected, strlen(expected)) != 0))
        fprintf(stderr, "%s: note: %s seems to be %s\n", program, name, guess);
}

void file_guess_note_path(const char *program, const char *path)
{
    char bytes[LOOKED_AT];
    struct stat status;
    FILE *file = stat(path, &status) == 0 && S_ISREG(status.st_mode) ? fopen(path, "rb") : NULL;
    if (file == NULL)
        return;
    file_guess_note(program, path, NULL, bytes, fread(bytes, 1, sizeof bytes, file));
    fclose(file);
}
