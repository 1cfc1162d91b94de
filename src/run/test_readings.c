/* SPDX-License-Identifier: MIT */
#include "test_readings.h"

#include <stdlib.h>
#include <string.h>

#define CHOICES_MAX (DEVICE_READINGS_MAX * DEVICE_TRIED_MAX)

/* The runs of one scenario. */
struct trial {
    struct test_case *test;
    struct test_progress *progress;
    const struct device_readings *readings; /* of the device */
    struct device_config base;
    struct test_choice choice[CHOICES_MAX];
    bool changes[CHOICES_MAX]; /* alone it changes the result */
    unsigned choices;
};

/* ---- Runs ----------------------------------------------------------------------------------------------------------- */

/* Every other value of each reading that neither the command line nor the scenario has chosen. */
static void list_choices(struct trial *trial)
{
    const struct device_config *own = scenario_config(trial->test->scenario);
    for (unsigned at = 0; at < trial->readings->count; at++) {
        unsigned values[DEVICE_TRIED_MAX], count = trial->readings->tried(at, values);
        if (trial->readings->is_chosen(own, at) || trial->readings->is_chosen(&trial->base, at))
            continue;
        for (unsigned i = 0; i < count; i++)
            trial->choice[trial->choices++] = (struct test_choice){at, values[i]};
    }
}

static bool add_variant(struct test_readings *under, const struct test_variant *variant)
{
    struct test_variant *grown = realloc(under->variant, (under->variants + 1) * sizeof *grown);
    if (grown == NULL)
        return false;
    under->variant = grown;
    grown[under->variants++] = *variant;
    return true;
}

/* One run. Returns whether it ends otherwise than the first one. */
static bool run_under(struct trial *trial, struct test_choice first, struct test_choice second)
{
    struct test_readings *under = trial->test->under;
    struct test_variant variant = {.choice = {first, second}};
    struct device_config readings = trial->base;
    if (test_case_interrupted())
        return false;
    trial->readings->put(&readings, first.at, first.value);
    if (second.at != TEST_NO_READING)
        trial->readings->put(&readings, second.at, second.value);
    scenario_set_readings(trial->test->scenario, &readings);
    variant.outcome = test_case_try(trial->test, &variant.result, trial->progress);
    bool counts = variant.outcome == TEST_PASSED || variant.outcome == TEST_FAILED;
    under->runs += counts;
    under->passed += variant.outcome == TEST_PASSED;
    bool differs = counts && variant.outcome != trial->test->outcome;
    bool kept = differs && add_variant(under, &variant);
    if (variant.outcome == TEST_BROKEN || differs != kept)
        under->broken = true;
    if (!kept)
        scenario_result_free(&variant.result);
    return differs;
}

static void run_singles(struct trial *trial)
{
    static const struct test_choice none = {TEST_NO_READING, 0};
    for (unsigned i = 0; i < trial->choices; i++)
        trial->changes[i] = run_under(trial, trial->choice[i], none);
}

/* A value that changes the result alone is not checked again: what it does with another one says nothing about that. */
static void run_pairs(struct trial *trial)
{
    for (unsigned i = 0; i < trial->choices; i++)
        for (unsigned j = i + 1; j < trial->choices; j++)
            if (trial->choice[i].at != trial->choice[j].at && !trial->changes[i] && !trial->changes[j]) {
                trial->test->under->planned++;
                run_under(trial, trial->choice[i], trial->choice[j]);
            }
}

void test_readings_run(struct test_case *test, const struct device_config *base, enum test_readings_mode mode,
                       struct test_progress *progress)
{
    struct trial trial = {
        .test = test, .progress = progress, .readings = scenario_device(test->scenario)->readings, .base = *base};
    test->under = calloc(1, sizeof *test->under);
    if (test->under == NULL)
        return;
    test->under->readings = trial.readings;
    if (trial.readings != NULL)
        list_choices(&trial);
    test->under->planned = 1 + trial.choices;
    test->under->runs = 1;
    test->under->passed = test->outcome == TEST_PASSED;
    run_singles(&trial);
    if (mode == TEST_READINGS_PAIRS && !test_case_interrupted())
        run_pairs(&trial);
    scenario_set_readings(test->scenario, base);
}

/* ---- Words ---------------------------------------------------------------------------------------------------------- */

bool test_readings_depends(const struct test_case *test)
{
    return test->under != NULL && test->under->variants > 0;
}

/* Has this dependence been named already, by another value? */
static bool named_before(const struct test_readings *under, size_t i)
{
    const struct test_choice *choice = under->variant[i].choice;
    for (size_t before = 0; before < i; before++) {
        const struct test_choice *other = under->variant[before].choice;
        if (other[0].at == choice[0].at && other[1].at == choice[1].at)
            return true;
    }
    return false;
}

const char *test_readings_text(const struct test_readings *under, char text[TEST_READINGS_TEXT_SIZE])
{
    int end = snprintf(text, TEST_READINGS_TEXT_SIZE, "passes under %zu of %zu", under->passed, under->runs);
    const char *before = "; depends on ";
    for (size_t i = 0; i < under->variants && end < TEST_READINGS_TEXT_SIZE - 64; i++) {
        const struct test_choice *choice = under->variant[i].choice;
        if (named_before(under, i))
            continue;
        end += snprintf(text + end, TEST_READINGS_TEXT_SIZE - (size_t)end, "%s%s", before, under->readings->name(choice[0].at));
        if (choice[1].at != TEST_NO_READING)
            end += snprintf(text + end, TEST_READINGS_TEXT_SIZE - (size_t)end, " with %s", under->readings->name(choice[1].at));
        before = ", ";
    }
    if (under->runs < under->planned)
        snprintf(text + end, TEST_READINGS_TEXT_SIZE - (size_t)end, "; %zu not run", under->planned - under->runs);
    return text;
}

const char *test_variant_text(const struct test_readings *under, const struct test_variant *variant, char text[DEVICE_TEXT_SIZE])
{
    struct device_config config = {.node = 1};
    for (unsigned i = 0; i < 2 && variant->choice[i].at != TEST_NO_READING; i++)
        under->readings->put(&config, variant->choice[i].at, variant->choice[i].value);
    under->readings->text(&config, text);
    return text;
}
