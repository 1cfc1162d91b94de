/* SPDX-License-Identifier: MIT */
#include "exec_report.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "device/device.h"

static const char *end_name(enum exec_end end)
{
    static const char *const names[] = {
        [EXEC_DONE] = "done",
        [EXEC_UNTIL] = "until",
        [EXEC_ENDLESS] = "endless",
        [EXEC_INTERRUPTED] = "interrupted",
        [EXEC_NO_TRACE] = "no_trace",
    };
    return names[end];
}

void report_begin(struct report *report, bool json)
{
    report->answers = json ? json_array() : NULL;
}

/* The bytes in hexadecimal. Returns a string to be freed, or NULL if out of memory. */
static char *hex_text(const uint8_t *bytes, size_t length)
{
    static const char digits[] = "0123456789ABCDEF";
    char *text = malloc(2 * length + 1);
    if (text == NULL)
        return NULL;
    for (size_t i = 0; i < length; i++) {
        text[2 * i] = digits[bytes[i] >> 4];
        text[2 * i + 1] = digits[bytes[i] & 15];
    }
    text[2 * length] = '\0';
    return text;
}

void report_answer(void *context, uint64_t tick, const struct stimulus *stimulus, const uint8_t *answer, size_t length)
{
    struct report *report = context;
    char *sent = hex_text(stimulus->data, stimulus->length);
    char *received = length > 0 ? hex_text(answer, length) : NULL;
    if (report->answers != NULL)
        json_array_append_new(report->answers, json_pack("{s:I, s:s?, s:s?}", "t_us", (json_int_t)tick, "message", sent,
                                                         "answer", received));
    else
        fprintf(stderr, "%" PRIu64 " us: message %s, answer %s\n", tick, sent != NULL ? sent : "?",
                received != NULL ? received : "none");
    free(sent);
    free(received);
}

/* ---- For people --------------------------------------------------------------------------------------------------- */

/* The numbers of the set bits, two digits each, "01 05". */
/* `names`: what they are called; NULL: numbers from `first` on. */
static void print_bits(FILE *out, const char *name, unsigned mask, const char *const *names, unsigned first)
{
    fprintf(out, "%s", name);
    if (mask == 0)
        fputs(" none", out);
    for (unsigned bit = 0; mask >> bit != 0; bit++) {
        if ((mask >> bit & 1) == 0)
            continue;
        if (names)
            fprintf(out, " %s", names[bit]);
        else
            fprintf(out, " %02u", first + bit);
    }
}

static void print_table(FILE *out, struct exec_run *run, enum exec_end end, bool waits)
{
    static const char *const ends[] = {
        [EXEC_DONE] = "finished",
        [EXEC_UNTIL] = "--until reached",
        [EXEC_ENDLESS] = "the state repeats",
        [EXEC_INTERRUPTED] = "interrupted",
        [EXEC_NO_TRACE] = "stopped",
    };
    const struct device_kind *kind = run->device;
    const struct device_unit *unit = exec_run_unit(run);
    fprintf(out, "at %" PRIu64 ".%06" PRIu64 " s: %s\n", run->reached / US_PER_SECOND, run->reached % US_PER_SECOND,
            waits ? "not finished, but no motor can continue" : ends[end]);
    fprintf(out, "motor     position  state   command  led    fault\n");
    for (unsigned motor = 1; motor <= kind->axes; motor++) {
        struct device_axis state;
        kind->axis(unit, motor, &state);
        if (state.absent)
            continue;
        fprintf(out, "%-5u  %11" PRId32 "  %-6s  %7u  %-5s  %s\n", motor, state.position, kind->state_name(state.state),
                (unsigned)state.index, kind->led_name(state.led),
                state.fault == 0 ? "-" : kind->fault_name(state.fault));
    }
    print_bits(out, "inputs on:", kind->inputs_of(unit), kind->input_names, 1);
    print_bits(out, "; outputs on:", kind->outputs_of(unit), kind->output_names, 1);
    print_bits(out, "; variables on:", kind->variables_of(unit), NULL, kind->first_variable);
    fputc('\n', out);
}

bool report_faults(struct exec_run *run)
{
    char text[DEVICE_ERROR_SIZE], last[DEVICE_ERROR_SIZE] = "";
    bool any = false;
    for (unsigned motor = 1; motor <= run->device->axes; motor++) {
        if (!run->device->is_stuck(exec_run_unit(run), motor, text))
            continue;
        any = true;
        if (run->device->is_program_whole && strcmp(text, last) == 0) /* all motors have one program */
            continue;
        memcpy(last, text, sizeof last);
        fprintf(stderr, "rkm04 exec: motor %u: %s\n", motor, text);
    }
    return any;
}

/* ---- What is waited for --------------------------------------------------------------------------------------------- */

/* A list of {motor, command, for}: what keeps a motor that has not come to its end from going on, when nothing will bring it.
 * Returns a new reference; NULL: out of memory. */
static json_t *waits_json(struct exec_run *run, enum exec_end end)
{
    json_t *list = json_array(), *motor, *state = NULL;
    size_t i;
    if (end == EXEC_DONE)
        state = run->device->describe(exec_run_unit(run), run->reached);
    json_array_foreach(json_object_get(state, "motors"), i, motor) {
        json_t *what = json_object_get(motor, "waits_for");
        struct device_axis axis;
        run->device->axis(exec_run_unit(run), (unsigned)i + 1, &axis);
        if (json_is_string(what) && !axis.idle)
            json_array_append_new(list, json_pack("{s:i, s:O, s:O}", "motor", (int)i + 1, "command",
                                                  json_object_get(motor, "command"), "for", what));
    }
    json_decref(state);
    return list;
}

/* Report on stderr for which of them no stimulus is left. Faults and labels: report_faults(). */
static void report_waits(struct exec_run *run, const json_t *waits)
{
    char text[DEVICE_ERROR_SIZE];
    json_t *wait;
    size_t i;
    json_array_foreach(waits, i, wait) {
        unsigned motor = (unsigned)json_integer_value(json_object_get(wait, "motor"));
        const char *command = json_string_value(json_object_get(wait, "command"));
        if (!run->device->is_stuck(exec_run_unit(run), motor, text))
            fprintf(stderr, "rkm04 exec: motor %u waits%s%s for %s, which never happens\n", motor,
                    command != NULL ? " in " : "", command != NULL ? command : "",
                    json_string_value(json_object_get(wait, "for")));
    }
}

/* ---- The end ------------------------------------------------------------------------------------------------------ */

static bool print_json(FILE *out, json_t *answers, struct exec_run *run, enum exec_end end, json_t *waits)
{
    json_t *state = run->device->state(exec_run_unit(run), run->reached);
    bool ok = state != NULL && json_object_set_new(state, "end", json_string(end_name(end))) == 0 &&
                json_object_set(state, "answers", answers) == 0 &&
                (json_array_size(waits) == 0 || json_object_set(state, "waits", waits) == 0) &&
                json_dumpf(state, out, JSON_COMPACT) == 0;
    json_decref(state);
    fputc('\n', out);
    return ok;
}

bool report_end(struct report *report, struct exec_run *run, enum exec_end end, FILE *out)
{
    bool ok = true;
    json_t *waits = waits_json(run, end);
    errno = 0;
    report_waits(run, waits);
    if (report->answers != NULL)
        ok = print_json(out, report->answers, run, end, waits);
    else
        print_table(out, run, end, json_array_size(waits) > 0);
    json_decref(waits);
    json_decref(report->answers);
    if (fflush(out) != 0 || ferror(out))
        ok = false;
    if (!ok)
        fprintf(stderr, "rkm04 exec: cannot write the final state: %s\n", strerror(errno ? errno : EIO));
    return ok;
}
