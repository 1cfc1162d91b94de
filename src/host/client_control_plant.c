/* Commands about what is around the units: plant, fault. */
#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_job.h"
#include "program_text.h"

/* ---- Plant ------------------------------------------------------------------------------------------------------------ */

static enum exit_status show_plant(struct client_job *job)
{
    json_t *result;
    enum exit_status status = client_job_call(job, "plant.get", NULL, true, &result);
    if (status != STATUS_WELL || job->json)
        return status == STATUS_WELL ? client_print_json(result) : status;
    json_dumpf(result, stdout, JSON_INDENT(2) | JSON_ENCODE_ANY);
    putchar('\n');
    json_decref(result);
    return STATUS_WELL;
}

/* The file is read here: the emulator may run in another folder, or in a container. */
static json_t *read_plant(const char *path)
{
    struct program_text text;
    const char *wrong = program_text_read(&text, path);
    json_t *params = NULL;
    if (wrong != NULL)
        warnx("cannot read %s: %s", path, wrong);
    else if ((params = json_pack("{s:s, s:s%}", "name", path, "text", text.text, text.length)) == NULL)
        warnx("%s: expected a text in UTF-8", path);
    program_text_free(&text);
    return params;
}

enum exit_status client_control_plant(struct client_job *job)
{
    json_t *result, *params;
    if (job->count == 0)
        return show_plant(job);
    bool none = strcmp(job->words[0], "none") == 0;
    if (!none && strcmp(job->words[0], "set") != 0)
        return client_usage("plant: expected set FILE, none, or nothing to show it, found '%s'", job->words[0]);
    if (none ? job->count > 1 : job->count < 2)
        return client_usage(none ? "plant none takes no argument" : "plant set: expected a FILE");
    params = none ? json_pack("{s:n}", "text") : read_plant(job->words[1]);
    if (params == NULL)
        return STATUS_FAILURE;
    enum exit_status status = client_job_call(job, "plant.set", params, true, &result);
    return status == STATUS_WELL ? client_job_done(job, result) : status;
}

/* ---- Faults ----------------------------------------------------------------------------------------------------------- */

/* One fault: its number and kind, then whatever else there is. */
static void print_fault(const json_t *fault)
{
    const char *name;
    json_t *value;
    printf("%" JSON_INTEGER_FORMAT "  %s", json_integer_value(json_object_get(fault, "id")),
           json_string_value(json_object_get(fault, "kind")));
    json_object_foreach((json_t *)fault, name, value) {
        if (strcmp(name, "id") == 0 || strcmp(name, "kind") == 0 || json_is_null(value))
            continue;
        printf("  %s=", name);
        if (json_is_string(value))
            fputs(json_string_value(value), stdout);
        else
            json_dumpf(value, stdout, JSON_ENCODE_ANY | JSON_COMPACT);
    }
    putchar('\n');
}

static enum exit_status list_faults(struct client_job *job)
{
    json_t *result, *fault;
    size_t i;
    enum exit_status status = client_job_call(job, "fault.list", NULL, false, &result);
    if (status != STATUS_WELL)
        return status;
    json_array_foreach(json_object_get(result, "faults"), i, fault)
        if (!job->json)
            print_fault(fault);
    return client_job_done(job, result);
}

static enum exit_status inject(struct client_job *job)
{
    if (job->count < 2)
        return client_usage("fault inject: expected a KIND: drop, flip, duplicate, insert, delay, no_answer, wrong_fcs, cut, "
                                "echo, break, unplugged, cable, flash, power or input");
    json_t *result, *params = json_pack("{s:s}", "kind", job->words[1]);
    if (params == NULL)
        return client_usage("%s: expected UTF-8", job->words[1]);
    if (!client_job_members(params, job->words + 2, job->count - 2)) {
        json_decref(params);
        return STATUS_USAGE;
    }
    enum exit_status status = client_job_call(job, "fault.inject", params, true, &result);
    if (status != STATUS_WELL)
        return status;
    if (!job->json)
        printf("fault %" JSON_INTEGER_FORMAT "\n", json_integer_value(json_object_get(result, "id")));
    return client_job_done(job, result);
}

static enum exit_status clear(struct client_job *job)
{
    json_t *result, *params = NULL;
    if (job->count > 2)
        return client_usage("fault clear: expected one number, found '%s' behind it", job->words[2]);
    if (job->count == 2) {
        char *end;
        long id = strtol(job->words[1], &end, 10);
        if (*end != '\0' || end == job->words[1] || id < 1)
            return client_usage("fault clear: expected the number of a fault, found '%s'", job->words[1]);
        params = json_pack("{s:I}", "id", (json_int_t)id);
    }
    enum exit_status status = client_job_call(job, "fault.clear", params, false, &result);
    return status == STATUS_WELL ? client_job_done(job, result) : status;
}

enum exit_status client_control_fault(struct client_job *job)
{
    static const struct {
        const char *name;
        client_job_function *function;
    } kinds[] = {{"inject", inject}, {"clear", clear}, {"list", list_faults}};
    if (job->count == 0)
        return list_faults(job);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(job->words[0], kinds[i].name) == 0)
            return kinds[i].function(job);
    }
    return client_usage("fault: expected inject, clear or list, found '%s'", job->words[0]);
}
