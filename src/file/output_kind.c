/* SPDX-License-Identifier: MIT */
#include "output_kind.h"

#include <string.h>

const struct output_kind output_recording = {.name = "a recording", .begins = {"{\"rkm04_record\":"}};
const struct output_kind output_junit = {
    .name = "a JUnit report",
    .begins = {"<?xml ", "<testsuite"},
    .holds = "<testsuite",
    .is_report = true,
};
const struct output_kind output_coverage = {
    .name = "a coverage report",
    .begins = {"protocol     covered"},
    .is_report = true,
};
const struct output_kind output_coverage_json = {
    .name = "a coverage report in JSON",
    .begins = {"{\n  \"covered\":", "{\"covered\":"},
    .is_report = true,
};

static bool holds(const char *bytes, size_t length, const char *text)
{
    size_t size = strlen(text);
    for (size_t at = 0; at + size <= length; at++)
        if (memcmp(bytes + at, text, size) == 0)
            return true;
    return false;
}

bool output_kind_is(const struct output_kind *kind, const char *bytes, size_t length)
{
    for (size_t i = 0; i < OUTPUT_BEGINNINGS && kind->begins[i]; i++) {
        size_t size = strlen(kind->begins[i]);
        bool cut = length < size;
        if (memcmp(bytes, kind->begins[i], cut ? length : size) == 0)
            return cut || !kind->holds || holds(bytes, length, kind->holds);
    }
    return false;
}
