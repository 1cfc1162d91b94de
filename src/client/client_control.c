/* SPDX-License-Identifier: MIT */
#include "client_control.h"

#include <err.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client_find.h"
#include "client_watch.h"
#include "options/options.h"
#include "text/text.h"

#define WRONG_PARAMS (-32602) /* JSON-RPC 2.0 */

/* ---- What the commands share ------------------------------------------------------------------------------------------ */

bool client_job_connect(struct client_job *job)
{
    static struct client_found pair;
    char path[PATH_MAX];
    const char *named = job->path != NULL ? job->path : getenv("RKM04_CONTROL"), *port = getenv("RKM04_PORT");
    const bool is_named = named != NULL && named[0] != '\0';
    if (!job->connected && !is_named && port != NULL && port[0] != '\0' && client_find_pair(port, NULL, &pair))
        job->path = pair.control;
    else if (!job->connected && !is_named && client_rpc_path(NULL, path) && access(path, F_OK) != 0) {
        const struct client_found *found = client_find_one("--control");
        if (found == NULL)
            return false;
        job->path = found->control;
    }
    if (!job->connected)
        job->connected = client_rpc_open(&job->rpc, job->path);
    return job->connected;
}

json_t *client_job_params(const struct client_job *job, json_t *params, bool of_unit)
{
    if (params == NULL)
        params = json_object();
    if (job->line >= 0)
        json_object_set_new(params, "line", json_integer(job->line));
    if (of_unit && job->unit != NULL)
        json_object_set_new(params, "unit", json_string(job->unit));
    return params;
}

enum exit_status client_job_outcome(const struct client_job *job, enum client_rpc_outcome outcome, json_t *json)
{
    const char *message = json_string_value(json_object_get(json, "message"));
    switch (outcome) {
    case CLIENT_RPC_RESULT:
        return STATUS_SUCCESS;
    case CLIENT_RPC_REFUSED:
        warnx("%s", message != NULL ? message : "the emulator refuses the request");
        return json_integer_value(json_object_get(json, "code")) == WRONG_PARAMS ? STATUS_USAGE : STATUS_FAILURE;
    case CLIENT_RPC_NOTHING:
        warnx("no answer from %s in time", job->rpc.path);
        return STATUS_NO_ANSWER;
    default:
        return STATUS_FAILURE;
    }
}

static enum exit_status call_with_timeout(struct client_job *job, const char *method, json_t *params, int timeout_ms,
                                          json_t **result)
{
    *result = NULL;
    if (!client_job_connect(job)) {
        json_decref(params);
        return STATUS_FAILURE;
    }
    json_t *json;
    enum client_rpc_outcome outcome = client_rpc_call(&job->rpc, method, params, timeout_ms, &json);
    enum exit_status status = client_job_outcome(job, outcome, json);
    if (status == STATUS_SUCCESS)
        *result = json;
    else
        json_decref(json);
    return status;
}

enum exit_status client_job_call(struct client_job *job, const char *method, json_t *params, bool of_unit, json_t **result)
{
    int timeout_ms = job->timeout_ms > 0 ? job->timeout_ms : CLIENT_JOB_TIMEOUT_MS;
    return call_with_timeout(job, method, client_job_params(job, params, of_unit), timeout_ms, result);
}

enum exit_status client_job_call_long(struct client_job *job, const char *method, json_t *params, json_t **result)
{
    int timeout_ms = job->timeout_ms > 0 ? job->timeout_ms : CLIENT_RPC_FOREVER;
    return call_with_timeout(job, method, client_job_params(job, params, false), timeout_ms, result);
}

enum exit_status client_job_done(const struct client_job *job, json_t *result)
{
    if (job->json)
        return client_print_json(result);
    json_decref(result);
    return STATUS_SUCCESS;
}

void client_job_print_members(const json_t *object, const char *const *but)
{
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)object, name, value) {
        bool hidden = json_is_null(value);
        for (size_t i = 0; but[i] != NULL; i++)
            hidden = hidden || strcmp(name, but[i]) == 0;
        if (hidden)
            continue;
        printf("  %s=", name);
        if (json_is_string(value))
            fputs(json_string_value(value), stdout);
        else
            json_dumpf(value, stdout, JSON_ENCODE_ANY | JSON_COMPACT);
    }
}

/* A value as it is meant: 5, 0.25, true, false, or text. */
static json_t *read_value(const char *text)
{
    json_t *value = json_loads(text, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL);
    if (value != NULL)
        return value;
    return json_string(text);
}

bool client_job_members(json_t *params, const char *const *words, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const char *equals = strchr(words[i], '=');
        if (equals == NULL || equals == words[i]) {
            client_usage("expected NAME=VALUE, found '%s'", words[i]);
            return false;
        }
        char *name = strndup(words[i], (size_t)(equals - words[i]));
        json_t *value = read_value(equals + 1);
        int failed = name == NULL || json_object_set_new(params, name, value);
        free(name);
        if (failed) {
            client_usage("%s: expected UTF-8", words[i]);
            return false;
        }
    }
    return true;
}

enum exit_status client_job_show(struct client_job *job, const char *method, json_t *params, void (*print)(const json_t *result))
{
    json_t *result;
    if (params == NULL)
        return client_usage("expected UTF-8");
    enum exit_status status = client_job_call(job, method, params, true, &result);
    if (status != STATUS_SUCCESS)
        return status;
    if (!job->json && print != NULL)
        print(result);
    return client_job_done(job, result);
}

/* ---- Commands without much to them ------------------------------------------------------------------------------------ */

/* Call a method without printing its result. */
static enum exit_status call_without_result(struct client_job *job, const char *method, json_t *params, bool of_unit)
{
    json_t *result;
    enum exit_status status = client_job_call(job, method, params, of_unit, &result);
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}

static enum exit_status reset_unit(struct client_job *job)
{
    return call_without_result(job, "reset", NULL, true);
}

/* After its answer to `shutdown`: it has ended when the connection has; then its files are whole, its link and socket gone. */
static bool emulator_has_ended(struct client_job *job)
{
    bool ended = client_rpc_ends(&job->rpc, job->timeout_ms > 0 ? job->timeout_ms : CLIENT_JOB_TIMEOUT_MS);
    if (!ended)
        warnx("the emulator at %s has not ended in time", job->rpc.path);
    return ended;
}

static enum exit_status end_emulator(struct client_job *job)
{
    json_t *result;
    enum exit_status status = client_job_call(job, "shutdown", NULL, false, &result);
    if (status == STATUS_SUCCESS && emulator_has_ended(job))
        return client_job_done(job, result);
    json_decref(result);
    return status == STATUS_SUCCESS ? STATUS_NO_ANSWER : status;
}

static enum exit_status switch_power(struct client_job *job)
{
    bool on = strcmp(job->words[0], "on") == 0;
    if (!on && strcmp(job->words[0], "off") != 0)
        return client_usage("power: expected on or off, found '%s'", job->words[0]);
    return call_without_result(job, "power", json_pack("{s:b}", "on", on), true);
}

static enum exit_status set_switch(struct client_job *job)
{
    uint64_t node;
    bool and_reset = job->count == 2;
    if (!number_read(job->words[0], 1, 16, &node))
        return client_usage("switch: expected an address 1 to 16, found '%s'", job->words[0]);
    if (and_reset && strcmp(job->words[1], "reset") != 0)
        return client_usage("switch: expected reset after the address, found '%s'", job->words[1]);
    json_t *params = json_pack("{s:i}", "node", (int)node);
    if (and_reset)
        json_object_set_new(params, "reset", json_true());
    return call_without_result(job, "switch", params, true);
}

static enum exit_status show_or_set_clock(struct client_job *job)
{
    json_t *result, *params = job->count > 0 ? json_pack("{s:s}", "clock", job->words[0]) : NULL;
    enum exit_status status = client_job_call(job, "clock", params, false, &result);
    if (status == STATUS_SUCCESS && !job->json) {
        const char *name = json_string_value(json_object_get(result, "clock"));
        json_int_t t_us = json_integer_value(json_object_get(result, "t_us"));
        printf("%s, %" PRId64 ".%06d s\n", name != NULL ? name : "-", (int64_t)(t_us / 1000000), (int)(t_us % 1000000));
    }
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}

/* The place of a file that the emulator, in its own folder, is to use. Returns a string to be freed; NULL: none (reported). */
static char *absolute_path(const char *path)
{
    char folder[PATH_MAX], *whole;
    if (process_path_is_absolute(path))
        return strdup(path);
    if (getcwd(folder, sizeof folder) != NULL && asprintf(&whole, "%s/%s", folder, path) >= 0)
        return whole;
    warn("%s", path);
    return NULL;
}

json_t *client_job_file(const char *path)
{
    char *whole = absolute_path(path);
    json_t *params = whole != NULL ? json_pack("{s:s}", "file", whole) : NULL;
    if (whole != NULL && params == NULL)
        client_usage("%s: expected UTF-8", path);
    free(whole);
    return params;
}

json_t *client_job_output(const struct client_job *job, const char *path)
{
    json_t *params = client_job_file(path);
    if (params != NULL && job->force)
        json_object_set_new(params, "force", json_true());
    return params;
}

/* snapshot, restore: a name in memory, or file=PATH. */
static enum exit_status snapshot_or_restore(struct client_job *job, const char *method)
{
    const char *word = job->words[0];
    bool file = strncmp(word, "file=", 5) == 0;
    json_t *params = file ? client_job_output(job, word + 5) : json_pack("{s:s}", "name", word);
    if (params == NULL)
        return file ? STATUS_FAILURE : client_usage("%s: expected UTF-8", word);
    return call_without_result(job, method, params, false);
}

static enum exit_status take_snapshot(struct client_job *job)
{
    return snapshot_or_restore(job, "snapshot");
}

/* A file takes as long as the emulator lets it. */
static enum exit_status restore_snapshot(struct client_job *job)
{
    const char *word = job->words[0];
    if (strncmp(word, "file=", 5) != 0)
        return snapshot_or_restore(job, "restore");
    json_t *result, *params = client_job_file(word + 5);
    enum exit_status status = params != NULL ? client_job_call_long(job, "restore", params, &result) : STATUS_FAILURE;
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}

/* Any method, parameters as JSON or NAME=VALUE. */
static enum exit_status call_method(struct client_job *job)
{
    json_error_t wrong;
    json_t *result, *params = NULL;
    if (job->count == 2 && job->words[1][0] == '{') {
        params = json_loads(job->words[1], JSON_REJECT_DUPLICATES, &wrong);
        if (params == NULL)
            return client_usage("call: parameters: expected JSON: %s", wrong.text);
    } else {
        params = json_object();
        if (!client_job_members(params, job->words + 1, job->count - 1)) {
            json_decref(params);
            return STATUS_USAGE;
        }
    }
    enum exit_status status = client_job_call_long(job, job->words[0], client_job_params(job, params, true), &result);
    if (status == STATUS_SUCCESS && strcmp(job->words[0], "shutdown") == 0 && !emulator_has_ended(job)) {
        json_decref(result);
        status = STATUS_NO_ANSWER;
    }
    return status == STATUS_SUCCESS ? client_print_json(result) : status;
}

/* ---- All of them ------------------------------------------------------------------------------------------------------ */

enum { TAKES_UNIT = 1, TAKES_LIMIT = 2, TAKES_ONCE = 4, TAKES_ADVANCE = 8, TAKES_FORCE = 16 };

static const struct command {
    const char *name;
    size_t least, most; /* words */
    const char *words;  /* expected */
    unsigned options;
    client_job_function *function;
} commands[] = {
    {"state", 0, 0, "nothing", TAKES_UNIT, client_control_state},
    {"di", 0, 8, "up to eight of N=0 or N=1", TAKES_UNIT, client_control_di},
    {"wait", 1, SIZE_MAX, "a condition, as in m1.position>=5000", TAKES_UNIT | TAKES_LIMIT | TAKES_ADVANCE,
     client_control_wait},
    {"advance", 1, SIZE_MAX, "a time, as in 10ms, or a condition", TAKES_UNIT | TAKES_LIMIT, client_control_advance},
    {"watch", 0, 0, "nothing", TAKES_UNIT | TAKES_ONCE, client_watch},
    {"events", 0, SIZE_MAX, "kinds of events", TAKES_UNIT | TAKES_LIMIT, client_control_events},
    {"snapshot", 1, 1, "NAME or file=PATH", TAKES_FORCE, take_snapshot},
    {"restore", 1, 1, "NAME or file=PATH", 0, restore_snapshot},
    {"reset", 0, 0, "nothing", TAKES_UNIT, reset_unit},
    {"power", 1, 1, "on or off", TAKES_UNIT, switch_power},
    {"switch", 1, 2, "an address, and optionally reset", TAKES_UNIT, set_switch},
    {"fault", 0, SIZE_MAX, "inject KIND NAME=VALUE..., clear [ID], or nothing to list them", TAKES_UNIT, client_control_fault},
    {"plant", 0, 4, "set FILE, none, motor=N..., or nothing to show it", TAKES_UNIT, client_control_plant},
    {"cib", 1, SIZE_MAX, "status, command, di, do, pwm or config", TAKES_UNIT, client_control_cib},
    {"cnc", 1, SIZE_MAX, "get, set, cells, start, stop, reset, jog, home, panel or load", TAKES_UNIT, client_control_cnc},
    {"clock", 0, 1, "real, xN, max, stepped, or nothing to show it", 0, show_or_set_clock},
    {"trace", 1, 2, "start FILE or stop [NUMBER]", TAKES_FORCE, client_control_trace},
    {"call", 1, SIZE_MAX, "a METHOD and its parameters, JSON or NAME=VALUE...", TAKES_UNIT, call_method},
    {"shutdown", 0, 0, "nothing", 0, end_emulator},
};

static const struct command *find_command(const char *name)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    }
    return NULL;
}

bool client_control_has(const char *name)
{
    return find_command(name) != NULL;
}

enum exit_status client_control(struct client_job *job, const char *name)
{
    const struct command *command = find_command(name);
    if (job->count < command->least)
        return client_usage("%s: expected %s", name, command->words);
    if (job->count > command->most)
        return client_usage("%s: expected %s, found '%s'", name, command->words, job->words[command->most]);
    if (job->unit != NULL && !(command->options & TAKES_UNIT))
        return client_usage("%s is about the whole bus: use it without --unit", name);
    if (job->limit != NULL && !(command->options & TAKES_LIMIT))
        return client_usage("--limit is for wait, advance and events");
    if (job->once && !(command->options & TAKES_ONCE))
        return client_usage("--once is for watch");
    if (job->advance && !(command->options & TAKES_ADVANCE))
        return client_usage("--advance is for wait");
    if (job->force && !(command->options & TAKES_FORCE))
        return client_usage("--force is for snapshot and trace start");
    enum exit_status status = command->function(job);
    if (job->connected)
        client_rpc_close(&job->rpc);
    return status;
}
