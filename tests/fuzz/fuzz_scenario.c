/* SPDX-License-Identifier: MIT */
/* fuzz_scenario.c: any text as a scenario: refused with a reason, or it runs to an end. The files that it names are a plant
 * and a program. What a failure says is complete. */
#include <string.h>

#include "fuzz.h"
#include "scenario/scenario.h"

#define LOOKS_MAX 40 /* questions whether to continue: a scenario may wait for a week */

static char *read_file(void *context, const char *path, size_t *length, const char **why)
{
    const char *text = strstr(path, "plant") ? "motors: {1: {offset: 20}}\nswitches: [{input: 1, motor: 1, at_most: 0}]\n"
                                             : "\\ S300 (01 C100 F90 R";
    (void)context;
    if (strstr(path, "nothing")) {
        *why = "it is not there";
        return NULL;
    }
    *length = strlen(text);
    return strdup(text);
}

static bool is_enough(void *context, uint64_t tick)
{
    unsigned *looks = context;
    return ++*looks > LOOKS_MAX || tick > UINT64_C(60000000);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct scenario_files files = {.read = read_file};
    struct scenario_result result = {0};
    char *said = NULL;
    size_t length;
    unsigned looks = 0;
    FILE *errors = open_memstream(&said, &length);
    struct scenario *scenario = scenario_read("file.yaml", (const char *)data, size, &files, errors);
    fflush(errors);
    FUZZ_CHECK((scenario != NULL) == (length == 0), "%s", said);
    if (scenario) {
        enum scenario_end end = scenario_run(scenario, NULL, is_enough, &looks, &result);
        FUZZ_CHECK(end != SCENARIO_FAILED || (result.expected && result.seen && result.line > 0), "a failure without a reason");
        FUZZ_CHECK(end != SCENARIO_NO_MEMORY, "no memory");
        scenario_result_free(&result);
        scenario_free(scenario);
    }
    fclose(errors);
    free(said);
    return 0;
}
