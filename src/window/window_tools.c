/* SPDX-License-Identifier: MIT */
#include "window_tools.h"

#include <stdlib.h>
#include <string.h>
#include <uv.h>

#include "program_tools/program_tools.h"
#include "window_page.h"

struct tools_job {
    struct pages *pages;
    uint64_t page;
    json_t *request, *result;
    uv_work_t work;
};

/* ---- In the thread ---------------------------------------------------------------------------------------------------- */

static json_t *check_part(const struct program_source *source)
{
    const struct check_options options = {0};
    struct diagnostics found;
    json_t *list = json_array();
    check_programs(source, 1, &options, &found);
    for (size_t i = 0; i < found.count; i++)
        json_array_append_new(list, check_json(&found.list[i], source));
    diagnostics_free(&found);
    return list;
}

static json_t *explain_part(const struct program_source *source, const char *language)
{
    struct explanations all = {0};
    enum explain_language named = explain_language_named(language);
    json_t *list = json_array();
    explain_programs(source, 1, named < EXPLAIN_LANGUAGES ? named : EXPLAIN_ENGLISH, &all);
    for (size_t i = 0; i < all.count; i++)
        json_array_append_new(list, json_pack("[I, I, s]", (json_int_t)all.list[i].offset, (json_int_t)all.list[i].length,
                                              all.list[i].text));
    explain_free(&all);
    return list;
}

static json_t *estimate_part(const struct program_source *source)
{
    const struct estimate_options options = {.pass_inputs = true};
    struct estimate estimate;
    char text[160];
    json_t *result = NULL;
    if (estimate_programs(source, 1, &options, &estimate) == ESTIMATE_OK)
        result = json_pack("{s:s, s:s, s:I, s:I, s:I, s:i}", "text", estimate_summary(&estimate, text), "end",
                           estimate_end_name(estimate.end), "duration_us", (json_int_t)estimate.duration, "round_us",
                           (json_int_t)estimate.round, "peak", (json_int_t)estimate.peak, "assumed", (int)estimate.assumed);
    estimate_free(&estimate);
    return result != NULL ? result : json_null();
}

json_t *tools_check(const char *text, size_t length, unsigned motor, const char *language)
{
    const struct program_source source = {.name = "program", .text = text, .length = length, .motor = motor};
    return json_pack("{s:o, s:o, s:o}", "diagnostics", check_part(&source), "commands", explain_part(&source, language),
                     "estimate", estimate_part(&source));
}

json_t *tools_format(const char *text, size_t length)
{
    const struct program_source source = {.name = "program", .text = text, .length = length, .motor = 1};
    char *out = NULL;
    size_t size = 0;
    if (format_program(&source, &out, &size) != FORMAT_DONE)
        return json_pack("{s:n}", "text");
    json_t *string = json_stringn(out, size);
    free(out);
    return json_pack("{s:o}", "text", string != NULL ? string : json_null());
}

static void on_work(uv_work_t *work)
{
    struct tools_job *job = work->data;
    const char *text = json_string_value(json_object_get(job->request, "text"));
    const char *language = json_string_value(json_object_get(job->request, "language"));
    json_int_t motor = json_integer_value(json_object_get(job->request, "motor"));
    size_t length = strlen(text);
    if (strcmp(json_string_value(json_object_get(job->request, "do")), "format") == 0)
        job->result = tools_format(text, length);
    else
        job->result = tools_check(text, length, motor >= 0 && motor <= 4 ? (unsigned)motor : 1,
                                  language != NULL ? language : "en");
}

/* ---- In the loop ------------------------------------------------------------------------------------------------------ */

void tools_drop(struct tools_job *job)
{
    if (job == NULL)
        return;
    json_decref(job->request);
    json_decref(job->result);
    free(job);
}

static void start(struct page *page, struct tools_job *job);

static void on_done(uv_work_t *work, int status)
{
    struct tools_job *job = work->data;
    struct page *page = page_find(job->pages, job->page);
    (void)status;
    if (page != NULL) {
        struct tools_job *later = page->later;
        page->busy = false;
        page->later = NULL;
        page_answer(page, job->request, json_incref(job->result));
        if (later != NULL)
            start(page, later);
    }
    tools_drop(job);
}

static void start(struct page *page, struct tools_job *job)
{
    page->busy = true;
    job->work.data = job;
    uv_queue_work(page->pages->loop, &job->work, on_work, on_done);
}

void tools_do(struct page *page, json_t *request)
{
    struct tools_job *job = json_is_string(json_object_get(request, "text")) ? calloc(1, sizeof *job) : NULL;
    if (job == NULL) {
        page_refuse(page, request, "text: expected a string");
        return;
    }
    *job = (struct tools_job){.pages = page->pages, .page = page->number, .request = json_incref(request)};
    if (!page->busy) {
        start(page, job);
        return;
    }
    if (page->later != NULL)
        page_answer(page, page->later->request, json_pack("{s:b}", "newer", 1));
    tools_drop(page->later);
    page->later = job;
}
