/* SPDX-License-Identifier: MIT */
/* Commands about what is around the units: plant, fault. */
#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_job.h"
#include "text/text.h"

/* ---- Plant ------------------------------------------------------------------------------------------------------------ */

/* Parts of the plant, a line each: "motor 1  position=…". `key`: the member that says which. */
static void print_parts(const json_t *parts, const char *key)
{
    const char *const shown[] = {key, NULL};
    size_t i;
    json_t *part;
    json_array_foreach((json_t *)parts, i, part) {
        printf("%s %d", key, (int)json_integer_value(json_object_get(part, key)));
        client_job_print_members(part, shown);
        putchar('\n');
    }
}

static enum exit_status show_plant(struct client_job *job)
{
    json_t *result;
    enum exit_status status = client_job_call(job, "plant.get", NULL, true, &result);
    if (status != STATUS_SUCCESS)
        return status;
    const json_t *plant = json_object_get(result, "plant");
    if (!job->json && !json_is_object(plant))
        printf("no plant\n");
    if (!job->json) {
        print_parts(json_object_get(plant, "motors"), "motor");
        print_parts(json_object_get(plant, "switches"), "input");
    }
    return client_job_done(job, result);
}

/* The file is read here: the emulator may run in another folder, or in a container. */
static json_t *read_plant(const char *path)
{
    struct program_text text;
    const char *wrong = program_text_read(&text, path);
    json_t *params = NULL;
    if (wrong != NULL)
        warnx("cannot read %s: %s", path, wrong);
    else if ((params = json_pack("{s:s%}", "plant", text.text, text.length)) == NULL)
        warnx("%s: expected a text in UTF-8", path);
    program_text_free(&text);
    return params;
}

/* motor=N and what a hand does there: position=, jammed=, missing_lead=. */
static json_t *read_plant_change(const struct client_job *job)
{
    json_t *params = json_object();
    if (client_job_members(params, job->words, job->count))
        return params;
    json_decref(params);
    return NULL;
}

enum exit_status client_control_plant(struct client_job *job)
{
    json_t *result, *params;
    if (job->count == 0)
        return show_plant(job);
    bool set = strcmp(job->words[0], "set") == 0, none = strcmp(job->words[0], "none") == 0;
    if (!set && !none && strchr(job->words[0], '=') == NULL)
        return client_usage("plant: expected set FILE, none, motor=N and position=, jammed= or missing_lead=, or nothing to show "
                            "it, found '%s'", job->words[0]);
    if ((set && job->count != 2) || (none && job->count != 1))
        return client_usage(set ? "plant set: expected one FILE" : "plant none takes no argument");
    if ((set || none) && job->unit != NULL)
        return client_usage("plant %s is about all units: use it without --unit", job->words[0]);
    params = set ? read_plant(job->words[1]) : none ? json_pack("{s:n}", "plant") : read_plant_change(job);
    if (params == NULL)
        return set ? STATUS_FAILURE : STATUS_USAGE;
    enum exit_status status = client_job_call(job, "plant.set", params, true, &result);
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}

/* ---- Faults ----------------------------------------------------------------------------------------------------------- */

/* One fault: its number and kind, then whatever else there is. */
static void print_fault(const json_t *fault)
{
    static const char *const shown[] = {"id", "kind", NULL};
    const char *kind = json_string_value(json_object_get(fault, "kind"));
    printf("%" JSON_INTEGER_FORMAT "  %s", json_integer_value(json_object_get(fault, "id")), kind != NULL ? kind : "-");
    client_job_print_members(fault, shown);
    putchar('\n');
}

static enum exit_status list_faults(struct client_job *job)
{
    json_t *result, *fault;
    size_t i;
    enum exit_status status = client_job_call(job, "fault.list", NULL, false, &result);
    if (status != STATUS_SUCCESS)
        return status;
    json_array_foreach(json_object_get(result, "faults"), i, fault)
        if (!job->json)
            print_fault(fault);
    return client_job_done(job, result);
}

static enum exit_status inject_fault(struct client_job *job)
{
    if (job->count < 2)
        return client_usage("fault inject: expected a KIND, as in `fault inject drop'; docs/FAULTS.md lists them");
    json_t *result, *params = json_pack("{s:s}", "kind", job->words[1]);
    if (params == NULL)
        return client_usage("%s: expected UTF-8", job->words[1]);
    if (!client_job_members(params, job->words + 2, job->count - 2)) {
        json_decref(params);
        return STATUS_USAGE;
    }
    enum exit_status status = client_job_call(job, "fault.inject", params, true, &result);
    if (status != STATUS_SUCCESS)
        return status;
    if (!job->json)
        printf("fault %" JSON_INTEGER_FORMAT "\n", json_integer_value(json_object_get(result, "id")));
    return client_job_done(job, result);
}

static enum exit_status clear_faults(struct client_job *job)
{
    json_t *result, *params = NULL;
    if (job->count > 2)
        return client_usage("fault clear: expected one number, found '%s' after it", job->words[2]);
    if (job->count == 2) {
        uint64_t id;
        if (!number_read(job->words[1], 1, INT32_MAX, &id))
            return client_usage("fault clear: expected the number of a fault, found '%s'", job->words[1]);
        params = json_pack("{s:I}", "id", (json_int_t)id);
    }
    enum exit_status status = client_job_call(job, "fault.clear", params, false, &result);
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}

enum exit_status client_control_fault(struct client_job *job)
{
    static const struct {
        const char *name;
        client_job_function *function;
    } kinds[] = {{"inject", inject_fault}, {"clear", clear_faults}, {"list", list_faults}};
    if (job->count == 0)
        return list_faults(job);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(job->words[0], kinds[i].name) == 0)
            return kinds[i].function(job);
    }
    return client_usage("fault: expected inject, clear or list, found '%s'", job->words[0]);
}
