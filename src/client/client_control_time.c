/* SPDX-License-Identifier: MIT */
/* Commands about time and what happens in it: wait, advance, events, trace. */
#include <err.h>
#include <errno.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_condition.h"
#include "client_job.h"
#include "text/text.h"

#define MOTORS_MAX 16

/* ---- Waiting ---------------------------------------------------------------------------------------------------------- */

/* A time as the emulator takes it: a number of us, or a text with its unit. */
static json_t *read_time(const char *text)
{
    uint64_t number;
    return number_read(text, 0, INT64_MAX, &number) ? json_integer((json_int_t)number) : json_string(text);
}

/* All words as one text, blanks between them; to be freed. */
static char *join_words(const char *const *words, size_t count)
{
    size_t length = 1;
    for (size_t i = 0; i < count; i++)
        length += strlen(words[i]) + 1;
    char *text = calloc(1, length);
    for (size_t i = 0; text != NULL && i < count; i++) {
        if (i > 0)
            strcat(text, " ");
        strcat(text, words[i]);
    }
    return text;
}

/* {"until": the condition of all words, "limit": …}. Returns NULL if the condition is wrong (reported). */
static json_t *read_until(const struct client_job *job)
{
    char wrong[CLIENT_CONDITION_WRONG_SIZE];
    char *text = join_words(job->words, job->count);
    json_t *condition = text != NULL ? client_condition(text, job->unit, wrong) : NULL;
    if (text == NULL)
        warnx("%s", strerror(ENOMEM));
    else if (condition == NULL)
        client_usage("%s", wrong);
    free(text);
    json_t *params = condition != NULL ? json_pack("{s:o}", "until", condition) : NULL;
    if (params != NULL && job->limit != NULL)
        json_object_set_new(params, "limit", read_time(job->limit));
    return params;
}

static void print_time(json_int_t t_us)
{
    printf("%" PRId64 ".%06d s", (int64_t)(t_us / 1000000), (int)(t_us % 1000000));
}

/* Show the result of `wait` or `advance`. Takes the reference. */
static enum exit_status show_waited(const struct client_job *job, json_t *result)
{
    bool holds = !json_is_false(json_object_get(result, "holds"));
    const char *text = json_string_value(json_object_get(result, "text"));
    json_int_t t_us = json_integer_value(json_object_get(result, "t_us"));
    enum exit_status status = holds ? STATUS_SUCCESS : STATUS_NO_ANSWER;
    if (!holds)
        warnx("not until %" PRId64 ".%06d s: %s", (int64_t)(t_us / 1000000), (int)(t_us % 1000000), text != NULL ? text : "");
    if (job->json) {
        enum exit_status printed = client_print_json(result);
        return printed != STATUS_SUCCESS ? printed : status;
    }
    if (holds) {
        print_time(t_us);
        putchar('\n');
    }
    json_decref(result);
    return status;
}

static enum exit_status call_wait(struct client_job *job, const char *method, json_t *params)
{
    json_t *result;
    if (params == NULL)
        return STATUS_USAGE;
    enum exit_status status = client_job_call_long(job, method, params, &result);
    return status == STATUS_SUCCESS ? show_waited(job, result) : status;
}

/* Is the clock stopped until a client advances it? Returns the exit status. */
static enum exit_status check_stopped(struct client_job *job, bool *stopped)
{
    json_t *result;
    enum exit_status status = client_job_call(job, "clock", NULL, false, &result);
    const char *clock = json_string_value(json_object_get(result, "clock"));
    *stopped = clock != NULL && strcmp(clock, "stepped") == 0;
    json_decref(result);
    return status;
}

static void note_stopped(void)
{
    warnx("note: time is stopped (clock stepped) until a client advances it, for example with rkmctl advance or wait --advance");
}

/* Does the condition hold already? Otherwise say that time is stopped. Returns the exit status. */
static enum exit_status wait_stopped(struct client_job *job, json_t *params)
{
    json_t *result, *now = json_pack("{s:O, s:i}", "until", json_object_get(params, "until"), "limit", 0);
    enum exit_status status = client_job_call(job, "wait", now, false, &result);
    if (status == STATUS_SUCCESS && json_is_true(json_object_get(result, "holds"))) {
        json_decref(params);
        return show_waited(job, result);
    }
    json_decref(result);
    if (status != STATUS_SUCCESS) {
        json_decref(params);
        return status;
    }
    note_stopped();
    return call_wait(job, "wait", params);
}

enum exit_status client_control_wait(struct client_job *job)
{
    bool stopped;
    json_t *params = read_until(job);
    enum exit_status status = params != NULL ? check_stopped(job, &stopped) : STATUS_USAGE;
    if (status != STATUS_SUCCESS) {
        json_decref(params);
        return status;
    }
    return stopped && !job->advance ? wait_stopped(job, params) : call_wait(job, stopped ? "advance" : "wait", params);
}

enum exit_status client_control_advance(struct client_job *job)
{
    if (job->words[0][0] < '0' || job->words[0][0] > '9')
        return call_wait(job, "advance", read_until(job));
    if (job->count > 1)
        return client_usage("advance: expected one time, as in 10ms, found '%s' after it", job->words[1]);
    if (job->limit != NULL || job->unit != NULL)
        return client_usage("advance: --limit and --unit need a condition, found the time %s", job->words[0]);
    return call_wait(job, "advance", json_pack("{s:o}", "ticks", read_time(job->words[0])));
}

/* ---- Events ----------------------------------------------------------------------------------------------------------- */

struct listening {
    const struct client_job *job;
    uint64_t count; /* asked for; UINT64_MAX: all */
    uint64_t left;  /* events to show; 0: done */
};

static void print_event(const json_t *event)
{
    static const char *const shown[] = {"t_us", "unit", "motor", "kind", "cell", "value", "subscription", NULL};
    const char *unit = json_string_value(json_object_get(event, "unit"));
    const char *kind = json_string_value(json_object_get(event, "kind"));
    const char *cell = json_string_value(json_object_get(event, "cell"));
    const json_t *motor = json_object_get(event, "motor"), *value = json_object_get(event, "value");
    print_time(json_integer_value(json_object_get(event, "t_us")));
    if (unit != NULL)
        printf("  unit %s", unit);
    if (json_is_integer(motor))
        printf("  motor %d", (int)json_integer_value(motor));
    printf("  %s", kind != NULL ? kind : "-");
    if (cell != NULL)
        printf(" %s", cell);
    if (json_is_string(value))
        printf(" %s", json_string_value(value));
    else if (json_is_integer(value))
        printf(" %" JSON_INTEGER_FORMAT, json_integer_value(value));
    client_job_print_members(event, shown);
    putchar('\n');
}

static void on_event(void *context, const char *method, const json_t *params)
{
    struct listening *l = context;
    bool lost = strcmp(method, "lost") == 0;
    if (l->left == 0)
        return;
    if (lost)
        warnx("%" JSON_INTEGER_FORMAT " events were dropped here: they came faster than they were read",
              json_integer_value(json_object_get(params, "events")));
    else
        l->left--;
    if (l->job->json) {
        json_dumpf(params, stdout, JSON_COMPACT);
        putchar('\n');
    } else if (!lost) {
        print_event(params);
    }
}

/* Words: kinds, motor=N, cell=NAME, count=N. Returns the parameters of `subscribe`, NULL: wrong (reported). */
static json_t *read_subscription(const struct client_job *job, uint64_t *count)
{
    json_t *params = json_object(), *kinds = json_array(), *cells = json_array();
    for (size_t i = 0; i < job->count; i++) {
        const char *word = job->words[i], *equals = strchr(word, '=');
        uint64_t number = 0;
        bool whole = equals != NULL && number_read(equals + 1, 1, INT64_MAX, &number);
        if (equals == NULL) {
            json_array_append_new(kinds, json_string(word));
        } else if (whole && strncmp(word, "motor=", 6) == 0 && number <= MOTORS_MAX) {
            json_object_set_new(params, "motor", json_integer((json_int_t)number));
        } else if (whole && strncmp(word, "count=", 6) == 0) {
            *count = number;
        } else if (strncmp(word, "cell=", 5) == 0) {
            json_array_append_new(cells, json_string(equals + 1));
        } else {
            client_usage("events: expected kinds, motor=1 to motor=%d, cell=NAME, or count=N, found '%s'", MOTORS_MAX, word);
            json_decref(params);
            json_decref(kinds);
            json_decref(cells);
            return NULL;
        }
    }
    if (json_array_size(kinds) > 0)
        json_object_set(params, "kinds", kinds);
    if (json_array_size(cells) > 0)
        json_object_set(params, "cells", cells);
    json_decref(kinds);
    json_decref(cells);
    return params;
}

/* Have an answer when --limit is over: a wait for what never is. */
static bool set_limit(struct client_job *job)
{
    json_t *never = json_pack("{s:{s:{s:i}}, s:o}", "until", "t", "<", 0, "limit", read_time(job->limit));
    return client_rpc_send(&job->rpc, "wait", client_job_params(job, never, false));
}

enum exit_status client_control_events(struct client_job *job)
{
    struct listening listening = {.job = job, .count = UINT64_MAX};
    bool stopped = false;
    json_t *result, *params = read_subscription(job, &listening.count);
    if (params == NULL)
        return STATUS_USAGE;
    listening.left = listening.count;
    enum exit_status status = check_stopped(job, &stopped);
    if (status != STATUS_SUCCESS) {
        json_decref(params);
        return status;
    }
    job->rpc.notified = on_event;
    job->rpc.context = &listening;
    setvbuf(stdout, NULL, _IOLBF, 0);
    status = client_job_call(job, "subscribe", params, true, &result);
    json_int_t t_us = json_integer_value(json_object_get(result, "t_us"));
    json_decref(result);
    if (status != STATUS_SUCCESS)
        return status;
    fprintf(stderr, "listening from %" PRId64 ".%06d s\n", (int64_t)(t_us / 1000000), (int)(t_us % 1000000)); /* for scripts */
    if (stopped)
        note_stopped();
    if (job->limit != NULL && !set_limit(job))
        return STATUS_FAILURE;
    enum client_rpc_outcome outcome = CLIENT_RPC_NOTHING;
    json_t *answer = NULL;
    while (listening.left > 0 && !ferror(stdout) && answer == NULL && outcome != CLIENT_RPC_LOST)
        outcome = client_rpc_listen(&job->rpc, CLIENT_RPC_FOREVER, &answer);
    status = client_job_outcome(job, outcome, answer);
    json_decref(answer);
    if (status != STATUS_SUCCESS || listening.left == 0 || listening.count == UINT64_MAX || ferror(stdout))
        return status;
    warnx("%" PRIu64 " of %" PRIu64 " events came within %s", listening.count - listening.left, listening.count, job->limit);
    return STATUS_NO_ANSWER;
}

/* ---- Traces ----------------------------------------------------------------------------------------------------------- */

static enum exit_status start_trace(struct client_job *job, json_t *params)
{
    json_t *result;
    if (params == NULL)
        return STATUS_FAILURE;
    enum exit_status status = client_job_call(job, "trace.start", params, false, &result);
    if (status != STATUS_SUCCESS)
        return status;
    if (!job->json)
        printf("trace %" JSON_INTEGER_FORMAT "\n", json_integer_value(json_object_get(result, "trace")));
    return client_job_done(job, result);
}

enum exit_status client_control_trace(struct client_job *job)
{
    json_t *result, *params = NULL;
    if (strcmp(job->words[0], "start") == 0) {
        if (job->count < 2)
            return client_usage("trace start: expected " TRACE_OR_WIRE_EXPECTED);
        return start_trace(job, client_job_output(job, job->words[1]));
    }
    if (strcmp(job->words[0], "stop") != 0)
        return client_usage("trace: expected start FILE or stop [NUMBER], found '%s'", job->words[0]);
    if (job->count == 2) {
        uint64_t number;
        if (!number_read(job->words[1], 1, INT32_MAX, &number))
            return client_usage("trace stop: expected the number that start has printed, found '%s'", job->words[1]);
        params = json_pack("{s:I}", "trace", (json_int_t)number);
    }
    enum exit_status status = client_job_call(job, "trace.stop", params, false, &result);
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}
