/* SPDX-License-Identifier: MIT */
/* fuzz_pmc_text.c: any bytes as a program and as parameters of a PMC, for one axis and for two. What is taken is legal, and its
 * canonical text says the same; what is not has an error in a line that there is. */
#include <string.h>

#include "fuzz.h"
#include "pmc/pmc.h"

struct reading {
    unsigned lines, errors;
};

static void report(void *context, const struct pmc_text_error *error)
{
    struct reading *reading = context;
    FUZZ_CHECK(error->line >= 1 && error->line <= reading->lines, "line %u of %u", error->line, reading->lines);
    FUZZ_CHECK(error->column >= 1 && error->text != NULL, "column %u", error->column);
    reading->errors += !error->is_warning;
}

static unsigned count_lines(const char *text, size_t length)
{
    unsigned lines = 1;
    for (size_t i = 0; i < length; i++)
        lines += text[i] == '\n';
    return lines;
}

static void check_program(const char *text, size_t length, unsigned axes)
{
    struct pmc_command first[PMC_AXES][PMC_REGISTERS], second[PMC_AXES][PMC_REGISTERS];
    const struct pmc_command *const one[PMC_AXES] = {first[0], first[1]}, *const two[PMC_AXES] = {second[0], second[1]};
    struct reading reading = {.lines = count_lines(text, length)};
    char written[PMC_PROGRAM_TEXT_MAX], again[PMC_PROGRAM_TEXT_MAX];
    bool is_right = pmc_program_read(text, length, axes, first, report, &reading);
    FUZZ_CHECK(is_right == (reading.errors == 0), "%u errors", reading.errors);
    if (!is_right)
        return;
    for (unsigned i = 0; i < PMC_AXES * PMC_REGISTERS; i++)
        FUZZ_CHECK(pmc_command_valid(&first[i / PMC_REGISTERS][i % PMC_REGISTERS]), "register %u", i);
    size_t size = pmc_program_write(one, axes, written, sizeof written);
    FUZZ_CHECK(size <= sizeof written, "%zu bytes", size);
    FUZZ_CHECK(pmc_program_read(written, size, axes, second, NULL, NULL), "its own text");
    FUZZ_CHECK(pmc_program_write(two, axes, again, sizeof again) == size && memcmp(written, again, size) == 0, "another text");
}

static void check_parameters(const char *text, size_t length, unsigned axes)
{
    struct pmc_parameters first[PMC_AXES], second[PMC_AXES];
    const struct pmc_parameters *const one[PMC_AXES] = {&first[0], &first[1]};
    struct reading reading = {.lines = count_lines(text, length)};
    char written[PMC_PARAMETER_TEXT_MAX];
    bool is_right = pmc_parameters_read(text, length, axes, first, report, &reading);
    FUZZ_CHECK(is_right == (reading.errors == 0), "%u errors", reading.errors);
    if (!is_right)
        return;
    size_t size = pmc_parameters_write(one, axes, written, sizeof written);
    FUZZ_CHECK(size <= sizeof written, "%zu bytes", size);
    FUZZ_CHECK(pmc_parameters_read(written, size, axes, second, NULL, NULL), "its own text");
    for (unsigned axis = 0; axis < axes; axis++)
        for (unsigned which = 0; which < PMC_PARAMETERS; which++)
            FUZZ_CHECK(pmc_parameter(&first[axis], which) == pmc_parameter(&second[axis], which), "parameter %u", which);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    for (unsigned axes = 1; axes <= PMC_AXES; axes++) {
        check_program((const char *)data, size, axes);
        check_parameters((const char *)data, size, axes);
    }
    return 0;
}
