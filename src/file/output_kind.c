/* SPDX-License-Identifier: MIT */
#include "output_kind.h"

#include <string.h>

#define BEGINNINGS_MAX 4u

/* A file is of a kind if it begins with one of `begins` and, where `holds` is there, has that text among its first bytes. VCD and
 * JUnit are written by other programs, too, which begin otherwise. */
static const struct {
    const char *name;
    const char *begins[BEGINNINGS_MAX];
    const char *holds;
} kinds[OUTPUT_KINDS] = {
    [OUTPUT_CSV] = {"a CSV trace", {"t_us,source,event,value"}, NULL},
    [OUTPUT_VCD] = {"a VCD trace", {"$version", "$date", "$comment", "$timescale"}, NULL},
    [OUTPUT_JSONL] = {"a JSON Lines trace", {"{\"t_us\":"}, NULL},
    [OUTPUT_WIRE_LOG] = {"a log of the wires", {"# rkm04 wire log "}, NULL},
    [OUTPUT_PCAPNG] = {"a pcapng file", {"\n\r\r\n"}, NULL},
    [OUTPUT_RECORDING] = {"a recording", {"{\"rkm04_record\":"}, NULL},
    [OUTPUT_JUNIT] = {"a JUnit report", {"<?xml ", "<testsuite"}, "<testsuite"},
    [OUTPUT_COVERAGE] = {"a coverage report", {"protocol     covered"}, NULL},
    [OUTPUT_COVERAGE_JSON] = {"a coverage report in JSON", {"{\n  \"covered\":", "{\"covered\":"}, NULL},
};

const char *output_kind_name(enum output_kind kind)
{
    return kinds[kind].name;
}

static bool holds(const char *bytes, size_t length, const char *text)
{
    size_t size = strlen(text);
    for (size_t at = 0; at + size <= length; at++)
        if (memcmp(bytes + at, text, size) == 0)
            return true;
    return false;
}

bool output_kind_is(enum output_kind kind, const char *bytes, size_t length)
{
    for (size_t i = 0; i < BEGINNINGS_MAX && kinds[kind].begins[i]; i++) {
        size_t size = strlen(kinds[kind].begins[i]);
        bool cut = length < size;
        if (memcmp(bytes, kinds[kind].begins[i], cut ? length : size) == 0)
            return cut || !kinds[kind].holds || holds(bytes, length, kinds[kind].holds);
    }
    return false;
}
