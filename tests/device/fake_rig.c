/* SPDX-License-Identifier: MIT */
#include "fake_rig.h"

#include <check.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "command/command.h"
#include "fake_device.h"
#include "record/record.h"

static void on_event(void *context, const struct watch_event *event)
{
    struct fake_rig *rig = context;
    if (event->kind == WATCH_BYTE || event->kind == WATCH_MESSAGE)
        return;
    if (event->kind == WATCH_NOTE)
        fprintf(rig->stream, "%" PRIu64 " unit %u motor %u note %s\n", event->tick, event->unit, event->motor, event->text);
    else
        fprintf(rig->stream, "%" PRIu64 " unit %u motor %u %s %" PRId32 "\n", event->tick, event->unit, event->motor,
                watch_kind_name((enum watch_kind)event->kind), event->value);
}

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    struct fake_rig *rig = context;
    for (size_t i = 0; i < length; i++)
        fprintf(rig->stream, "%" PRIu64 " heard %02x\n", sim_now(&rig->sim), bytes[i]);
}

static void open_text(struct fake_rig *rig)
{
    rig->stream = open_memstream(&rig->text, &rig->length);
    ck_assert_ptr_nonnull(rig->stream);
}

void fake_rig_begin(struct fake_rig *rig, const char *nodes, bool timed)
{
    fake_rig_begin_as(rig, &fake_device, NULL, nodes, timed);
}

/* The config with a setting, "end=sums"; of a file, its text. */
static void set_option(struct device_config *config, const struct device_kind *kind, const char *setting)
{
    char name[32], error[DEVICE_ERROR_SIZE];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(setting, "="), setting);
    const struct device_option *option = device_option_named(kind, name);
    ck_assert_ptr_nonnull(option);
    const char *value = strchr(setting, '=') + 1;
    if (option->read_file)
        ck_assert(option->read_file(config, name, value, strlen(value), stderr));
    else
        ck_assert_msg(option->read(config, value, error), "%s", error);
}

void fake_rig_begin_as(struct fake_rig *rig, const struct device_kind *kind, const char *setting, const char *nodes, bool timed)
{
    struct sim_config config = {
        .device = kind,
        .timed = timed,
        .turnaround = timed ? SEGMENT_TURNAROUND : 0,
        .seed = 1,
        .out = hear,
        .context = rig,
    };
    memset(rig, 0, sizeof *rig);
    ck_assert(node_list_read_up_to(&config.nodes, nodes, kind->addresses));
    if (setting)
        set_option(&config.unit, kind, setting);
    open_text(rig);
    ck_assert(sim_begin(&rig->sim, &config));
    ck_assert(snapshots_attach(&rig->sim));
    rig->watcher = (struct watcher){.kinds = WATCH_ALL, .on_event = on_event, .context = rig};
    sim_watch(&rig->sim, &rig->watcher);
}

void fake_rig_end(struct fake_rig *rig)
{
    sim_end(&rig->sim);
    fclose(rig->stream);
    free(rig->text);
}

void fake_rig_ask(struct fake_rig *rig, unsigned address, const char *text)
{
    uint8_t bytes[64];
    size_t length = strlen(text);
    ck_assert_uint_lt(length, sizeof bytes - 2);
    bytes[0] = (uint8_t)(0x80 + address);
    memcpy(bytes + 1, text, length);
    bytes[length + 1] = '\r';
    sim_queue_bytes(&rig->sim, bytes, length + 2, sim_now(&rig->sim));
}

const char *fake_rig_seen(struct fake_rig *rig)
{
    static char seen[65536];
    fclose(rig->stream);
    snprintf(seen, sizeof seen, "%s", rig->text);
    free(rig->text);
    open_text(rig);
    return seen;
}

void fake_rig_expect_answer(struct fake_rig *rig, unsigned address, const char *text, const char *answer)
{
    char heard[64];
    size_t length = 0;
    fake_rig_seen(rig);
    fake_rig_ask(rig, address, text);
    sim_advance(&rig->sim, sim_now(&rig->sim) + 1);
    const char *at = fake_rig_seen(rig);
    unsigned byte;
    for (; (at = strstr(at, " heard ")) != NULL && length < sizeof heard - 1 && sscanf(at, " heard %2x", &byte) == 1; at++)
        if (byte != '\r')
            heard[length++] = (char)byte;
    heard[length] = '\0';
    ck_assert_msg(strcmp(heard, answer) == 0, "%s: answer `%s', expected `%s'", text, heard, answer);
}

json_t *fake_rig_command(struct fake_rig *rig, const char *method, const char *params)
{
    struct refusal refusal;
    json_t *json = json_loads(params, 0, NULL), *result = sim_command(&rig->sim, method, json, &refusal);
    ck_assert_msg(result != NULL, "%s %s: %s", method, params, refusal.text);
    json_decref(json);
    return result;
}

void fake_rig_expect_result(struct fake_rig *rig, const char *method, const char *params, const char *wanted)
{
    json_t *result = fake_rig_command(rig, method, params);
    char *text = json_dumps(result, JSON_COMPACT);
    ck_assert_msg(strstr(text, wanted) != NULL, "%s %s: %s, expected %s", method, params, text, wanted);
    free(text);
    json_decref(result);
}

void fake_rig_do(struct fake_rig *rig, const char *method, const char *params)
{
    json_decref(fake_rig_command(rig, method, params));
}

void fake_rig_expect_refusal(struct fake_rig *rig, const char *method, const char *params, const char *expected)
{
    struct refusal refusal;
    json_t *json = json_loads(params, 0, NULL), *result = sim_command(&rig->sim, method, json, &refusal);
    ck_assert_msg(result == NULL, "%s %s is obeyed", method, params);
    ck_assert_msg(strstr(refusal.text, expected) != NULL, "%s %s: %s", method, params, refusal.text);
    json_decref(json);
}

void fake_rig_expect_state(struct fake_rig *rig, const char *name, const char *value)
{
    char params[32], part[32];
    snprintf(params, sizeof params, "{\"unit\": \"%s\"}", rig->sim.unit[0].name);
    json_t *all = fake_rig_command(rig, "state", params), *at = all;
    for (const char *rest = name; *rest; rest += strcspn(rest, "."), rest += *rest == '.') {
        snprintf(part, sizeof part, "%.*s", (int)strcspn(rest, "."), rest);
        at = json_is_array(at) ? json_array_get(at, (size_t)atoi(part)) : json_object_get(at, part);
    }
    char *text = json_dumps(at, JSON_ENCODE_ANY | JSON_COMPACT);
    ck_assert_msg(text != NULL && strcmp(text, value) == 0, "%s is %s, expected %s", name, text ? text : "missing", value);
    free(text);
    json_decref(all);
}

void run_story(const char *text, enum scenario_end wanted, const char *said)
{
    static const struct scenario_files files = {0};
    struct scenario_result result = {0};
    char *told;
    size_t length;
    FILE *errors = open_memstream(&told, &length);
    struct scenario *scenario = scenario_read("test.yaml", text, strlen(text), &files, errors);
    enum scenario_end came = scenario ? scenario_run(scenario, NULL, NULL, NULL, &result) : SCENARIO_FAILED;
    if (scenario && came == SCENARIO_FAILED)
        fprintf(errors, "line %zu: expected %s, seen %s", result.line, result.expected, result.seen);
    fclose(errors);
    ck_assert_msg(came == wanted && (!said || strstr(told, said)), "%s", told);
    scenario_result_free(&result);
    scenario_free(scenario);
    free(told);
}
