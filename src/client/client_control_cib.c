/* SPDX-License-Identifier: MIT */
/* cib: what the module C-OS-0808M has of its own, over the control socket. */
#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_job.h"
#include "text/text.h"

#define OUTPUTS 8

static json_int_t integer_of(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

/* ---- Drives ------------------------------------------------------------------------------------------------------------- */

static void print_drive(const json_t *drive)
{
    static const char *const bits[] = {"move", "dir", "invel", "trg", "err", "ramp"};
    printf("drive %s  position %" JSON_INTEGER_FORMAT "  speed %" JSON_INTEGER_FORMAT "  row %" JSON_INTEGER_FORMAT "  mcstat",
           json_string_value(json_object_get(drive, "drive")), integer_of(drive, "position"), integer_of(drive, "speed"),
           integer_of(drive, "row"));
    for (size_t i = 0; i < sizeof bits / sizeof *bits; i++)
        if (json_is_true(json_object_get(drive, bits[i])))
            printf(" %s", bits[i]);
    if (integer_of(drive, "mcerr") != 0)
        printf("  mcerr %" JSON_INTEGER_FORMAT " (%s)", integer_of(drive, "mcerr"),
               json_string_value(json_object_get(drive, "error")));
    putchar('\n');
}

static void print_status(const json_t *result)
{
    size_t i;
    json_t *drive, *drives = json_object_get(result, "drives");
    json_array_foreach(drives, i, drive)
        print_drive(drive);
    if (drives == NULL)
        print_drive(result);
}

static enum exit_status show_status(struct client_job *job)
{
    if (job->count > 2)
        return client_usage("cib status: expected A or B, or nothing for both");
    return client_job_show(job, "cib.status", job->count == 2 ? json_pack("{s:s}", "drive", job->words[1]) : json_object(),
                           print_status);
}

static enum exit_status give_command(struct client_job *job)
{
    static const char *const names[] = {"command", "p1", "p2"};
    if (job->count < 3 || job->count > 5)
        return client_usage("cib command: expected A or B, a number, and its parameters P1 and P2, as in `cib command A 102 3000 "
                            "500'");
    json_t *params = json_pack("{s:s}", "drive", job->words[1]);
    for (size_t i = 2; params != NULL && i < job->count; i++) {
        int64_t value;
        if (!number_read_signed(job->words[i], INT32_MIN, INT32_MAX, &value)) {
            json_decref(params);
            return client_usage("cib command: expected a number, found '%s'", job->words[i]);
        }
        json_object_set_new(params, names[i - 2], json_integer(value));
    }
    return client_job_show(job, "cib.command", params, print_status);
}

/* ---- Inputs and outputs ------------------------------------------------------------------------------------------------- */

static void print_mask(const char *name, json_int_t mask)
{
    printf("%s", name);
    for (int i = 0; i < OUTPUTS; i++)
        printf(" %d=%d", i + 1, (int)(mask >> i & 1));
    putchar('\n');
}

static void print_inputs(const json_t *result)
{
    print_mask("di", integer_of(result, "di_shown"));
    print_mask("buttons", integer_of(result, "buttons"));
}

static void print_outputs(const json_t *result)
{
    print_mask("do", integer_of(result, "do"));
    print_mask("on", integer_of(result, "on"));
    if (integer_of(result, "minus") != 0)
        print_mask("minus", integer_of(result, "minus"));
    printf("pwm");
    for (size_t i = 0; i < OUTPUTS; i++)
        printf(" %zu=%" JSON_INTEGER_FORMAT, i + 1, json_integer_value(json_array_get(json_object_get(result, "pwm"), i)));
    putchar('\n');
}

static enum exit_status show_inputs(struct client_job *job)
{
    if (job->count > 1)
        return client_usage("cib di: expected nothing; `di' sets inputs, as in `di di3=1 button1=0'");
    return client_job_show(job, "state", json_object(), print_inputs);
}

static enum exit_status set_outputs(struct client_job *job)
{
    json_t *outputs = json_object();
    for (size_t i = 1; outputs != NULL && i < job->count; i++) {
        const char *word = job->words[i];
        char name[2] = {word[0], '\0'};
        if (word[0] < '1' || word[0] > '8' || word[1] != '=' || (word[2] != '0' && word[2] != '1') || word[3] != '\0') {
            json_decref(outputs);
            return client_usage("cib do: expected N=0 or N=1 with N from 1 to 8, found '%s'", word);
        }
        json_object_set_new(outputs, name, json_integer(word[2] - '0'));
    }
    return client_job_show(job, "cib.do", json_pack("{s:o}", "outputs", outputs), print_outputs);
}

static enum exit_status set_duty(struct client_job *job)
{
    uint64_t output, duty;
    if (job->count == 1)
        return client_job_show(job, "cib.do", json_object(), print_outputs);
    if (job->count != 3 || !number_read(job->words[1], 1, OUTPUTS, &output) || !number_read(job->words[2], 0, 10000, &duty))
        return client_usage("cib pwm: expected an output from 1 to 8 and a duty from 0 to 10000 (0.01 %%), as in `cib pwm 1 "
                            "2500'");
    return client_job_show(job, "cib.pwm", json_pack("{s:I, s:I}", "output", (json_int_t)output, "duty", (json_int_t)duty),
                           print_outputs);
}

/* ---- Configuration ------------------------------------------------------------------------------------------------------ */

/* As a file has it, so that what `get' prints can be edited and put. */
static void print_setup(const json_t *setup)
{
    const char *group, *name;
    json_t *part, *value;
    json_object_foreach((json_t *)setup, group, part) {
        printf("%s:\n", group);
        json_object_foreach(part, name, value) {
            if (json_is_string(value))
                printf("  %s: %s\n", name, json_string_value(value));
            else if (json_is_boolean(value))
                printf("  %s: %s\n", name, json_is_true(value) ? "true" : "false");
            else
                printf("  %s: %" JSON_INTEGER_FORMAT "\n", name, json_integer_value(value));
        }
    }
}

static void print_proposal(const json_t *result)
{
    print_setup(json_object_get(result, "proposal"));
}

static json_t *read_setup(const char *path)
{
    struct program_text text;
    const char *wrong = program_text_read(&text, path);
    json_t *params = NULL;
    if (wrong != NULL)
        warnx("cannot read %s: %s", path, wrong);
    struct config_tree *tree = wrong == NULL ? config_read(path, text.text, text.length, stderr) : NULL;
    if (tree != NULL)
        params = json_pack("{s:o}", "setup", config_json(config_root(tree)));
    if (tree != NULL)
        config_free(tree);
    program_text_free(&text);
    return params;
}

static enum exit_status put_setup(struct client_job *job)
{
    if (job->count != 3)
        return client_usage("cib config put: expected one FILE");
    json_t *params = read_setup(job->words[2]);
    return params != NULL ? client_job_show(job, "cib.config.put", params, NULL) : STATUS_FAILURE;
}

/* APPLY: an error if the module refuses what is proposed. */
static enum exit_status apply(struct client_job *job)
{
    json_t *result;
    enum exit_status status = client_job_call(job, "cib.apply", NULL, true, &result);
    if (status != STATUS_SUCCESS)
        return status;
    json_int_t wrong = integer_of(result, "result");
    if (wrong != 0)
        warnx("the module refuses the configuration: %s (register %llXH)", json_string_value(json_object_get(result, "wrong")),
              (unsigned long long)wrong);
    status = client_job_done(job, result);
    return wrong != 0 ? STATUS_FAILURE : status;
}

static enum exit_status configure(struct client_job *job)
{
    const char *word = job->count >= 2 ? job->words[1] : "get";
    if (strcmp(word, "put") == 0)
        return put_setup(job);
    if (job->count > 2 || (strcmp(word, "get") != 0 && strcmp(word, "apply") != 0))
        return client_usage("cib config: expected get, put FILE or apply, found '%s'", job->words[job->count > 2 ? 2 : 1]);
    return strcmp(word, "get") == 0 ? client_job_show(job, "cib.config", json_object(), print_proposal) : apply(job);
}

enum exit_status client_control_cib(struct client_job *job)
{
    static const struct {
        const char *name;
        client_job_function *function;
    } parts[] = {{"status", show_status}, {"command", give_command}, {"di", show_inputs},
                 {"do", set_outputs},     {"pwm", set_duty},         {"config", configure}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (strcmp(job->words[0], parts[i].name) == 0)
            return parts[i].function(job);
    return client_usage("cib: expected status, command, di, do, pwm or config, found '%s'", job->words[0]);
}
