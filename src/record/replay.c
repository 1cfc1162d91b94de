/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "record_line.h"
#include "replay_state.h"
#include "snapshot_store.h"
#include "text/text.h"

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* The end of the next step towards `tick`: a span in which nothing happens, or RECORD_SPAN. */
static uint64_t step_end(struct replay *replay, uint64_t tick)
{
    uint64_t end = sim_now(replay->head.sim) + RECORD_SPAN;
    if (end < tick) {
        uint64_t event = sim_next_event(replay->head.sim), due = sim_due(replay->head.sim);
        event = due < event ? due : event;
        if (end <= event)
            end = event == DEVICE_NEVER ? DEVICE_NEVER : event + 1u;
    }
    return end < tick ? end : tick;
}

static void pause_replay(struct replay *replay)
{
    replay_set_text(&replay->result, "interrupted at tick %" PRIu64, sim_now(replay->head.sim));
    replay->paused = true;
}

/* Is the replay to pause? */
static bool is_interrupted(struct replay *replay)
{
    if (!replay->paused && replay->interrupted && replay->interrupted(replay->context))
        pause_replay(replay);
    return replay->paused;
}

/* Let time run to `tick`; only `bytes` bytes may come that have not been compared. */
static bool run_to(struct replay *replay, uint64_t tick, size_t bytes)
{
    struct sim *sim = replay->head.sim;
    while (sim_now(sim) < tick) {
        if (is_interrupted(replay))
            return false;
        sim_advance(sim, step_end(replay, tick));
        if (!replay->outputs.are_compared)
            continue;
        replay_collect_before_tick(replay);
        if (!replay_expect_nothing(replay, tick, bytes))
            return false;
    }
    return !replay->result.ended;
}

/* The tick of the present line is over; `last` is that of the replay. Returns false if it comes before. */
static bool run_to_line(struct replay *replay, uint64_t tick, size_t bytes)
{
    if (tick <= replay->until)
        return run_to(replay, tick, bytes);
    if (run_to(replay, replay->until, bytes)) {
        replay_finish(&replay->result, REPLAY_SAME);
    }
    return false;
}

/* Come to a line about what came in: everything before has gone out, and was recorded. */
static bool run_to_input(struct replay *replay, const char *const *keys, uint64_t *tick)
{
    if (!replay_keys(replay, keys) ||
        !replay_number(replay, "t", sim_now(replay->head.sim), TIME_VALUE_MAX, DEVICE_NEVER, tick) ||
        !run_to_line(replay, *tick, 0))
        return false;
    sim_finish_tick(replay->head.sim);
    if (!replay->outputs.are_compared)
        return true;
    replay_collect_before_tick(replay);
    return replay_expect_nothing(replay, DEVICE_NEVER, 0);
}

/* ---- Lines about what came in --------------------------------------------------------------------------------------- */

static bool do_bytes(struct replay *replay)
{
    static const char *const keys[] = {"t", "at", "in", NULL};
    uint64_t tick, at;
    size_t length, room;
    if (!run_to_input(replay, keys, &tick) || !replay_number(replay, "at", tick, TIME_VALUE_MAX, tick, &at))
        return false;
    room = sim_room(replay->head.sim);
    const uint8_t *bytes = replay_bytes(replay, "in", room < SEGMENT_ROOM ? room : SEGMENT_ROOM, &length);
    if (!bytes)
        return false;
    replay->counts.inputs++;
    replay->counts.bytes_in += length;
    sim_queue_bytes(replay->head.sim, bytes, length, at);
    return true;
}

static bool do_purge(struct replay *replay)
{
    static const char *const keys[] = {"t", "purge", NULL};
    uint64_t tick;
    if (!run_to_input(replay, keys, &tick))
        return false;
    replay->counts.inputs++;
    sim_purge(replay->head.sim);
    return true;
}

static bool do_break(struct replay *replay)
{
    static const char *const keys[] = {"t", "break", NULL};
    uint64_t tick;
    bool on;
    if (!replay_flag(replay, "break", false, &on) || !run_to_input(replay, keys, &tick))
        return false;
    replay->counts.inputs++;
    sim_break(replay->head.sim, on);
    return true;
}

static bool do_timed(struct replay *replay)
{
    static const char *const keys[] = {"t", "timed", NULL};
    uint64_t tick;
    bool timed;
    if (!replay_flag(replay, "timed", false, &timed) || !run_to_input(replay, keys, &tick))
        return false;
    replay->counts.inputs++;
    sim_set_timed(replay->head.sim, timed);
    return true;
}

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

static bool do_embedded(struct replay *replay)
{
    static const char *const keys[] = {"t", "embedded", NULL};
    uint64_t lines, tick;
    if (!replay_keys(replay, keys) || !replay_number(replay, "t", 0, TIME_VALUE_MAX, DEVICE_NEVER, &tick) ||
        !replay_number(replay, "embedded", 1, RECORD_EMBEDDED_MAX, DEVICE_NEVER, &lines))
        return false;
    if (replay->depth == REPLAY_DEPTH_MAX)
        return replay_wrong(replay, "embedded", "expected at most %u nested recordings", REPLAY_DEPTH_MAX);
    return replay_read_embedded(replay, lines);
}

static bool report_refused(struct replay *replay, const char *method, const struct refusal *refusal)
{
    const uint64_t now = sim_now(replay->head.sim);
    struct replay_difference difference = {.what = "the control", .from = now, .until = now};
    if (refusal->code == REFUSED_MEMORY)
        return replay_no_memory(replay);
    snprintf(difference.recorded, sizeof difference.recorded, "success of `%.60s'", method);
    snprintf(difference.came, sizeof difference.came, "a refusal: %.170s", refusal->text);
    return replay_differs(replay, &difference);
}

/* Become like the end of the embedded record. NULL: refused, or paused. */
static json_t *restore_embedded(struct replay *replay, struct refusal *refusal)
{
    if (!replay->inner)
        replay->inner = restore_open(replay->head.sim, "the embedded recording", replay->lines.embedded,
                                     replay->lines.embedded_length, replay->depth + 1u, refusal);
    if (!replay->inner)
        return NULL;
    if (!restore_go_on(replay->inner, replay->interrupted, replay->context)) {
        pause_replay(replay);
        return NULL;
    }
    struct restore *restore = replay->inner;
    replay->inner = NULL;
    return restore_put(restore, refusal);
}

/* No file is touched on behalf of a recording: what was read is in it, what was written is of no concern. */
static json_t *execute_command(struct replay *replay, const char *method, const json_t *params, struct refusal *refusal)
{
    if (!json_object_get(params, "file"))
        return sim_command(replay->head.sim, method, params, refusal);
    return strcmp(method, "restore") == 0 ? restore_embedded(replay, refusal) : json_object();
}

static bool do_command(struct replay *replay)
{
    static const char *const keys[] = {"t", "command", "params", NULL};
    const json_t *params = json_object_get(replay->lines.json, "params");
    const char *method = replay_string(replay, "command");
    struct refusal refusal = {0};
    uint64_t tick;
    if (!method || !run_to_input(replay, keys, &tick))
        return false;
    if (!json_is_object(params))
        return replay_wrong(replay, "params", "expected \"params\", an object");
    if (!sim_has_command(replay->head.sim, method))
        return replay_wrong(replay, "command", "expected \"command\", one that rkm04 " RKM04_VERSION " knows");
    bool restore = strcmp(method, "restore") == 0 && json_object_get(params, "file");
    if (restore && !replay->lines.embedded)
        return replay_wrong(replay, "command", "expected a line \"embedded\" with the restored file before this line");
    json_t *result = execute_command(replay, method, params, &refusal);
    json_decref(result);
    if (replay->paused)
        return false;
    replay->counts.inputs++;
    if (restore)
        replay_drop_embedded(replay);
    return result || report_refused(replay, method, &refusal);
}

/* ---- Lines of journals ---------------------------------------------------------------------------------------------- */

/* The state stays, and everything that has a time is moved along: that is what restore did. */
static bool do_moved(struct replay *replay)
{
    static const char *const keys[] = {"t", "moved", NULL};
    uint64_t tick, by;
    if (!replay_keys(replay, keys) ||
        !replay_number(replay, "t", sim_now(replay->head.sim), TIME_VALUE_MAX, DEVICE_NEVER, &tick) ||
        !replay_number(replay, "moved", 0, TIME_VALUE_MAX - tick, DEVICE_NEVER, &by))
        return false;
    if (replay->outputs.are_compared)
        return replay_wrong(replay, "moved", "expected {\"outputs\":false} before this line");
    if (tick + by > replay->until)
        return run_to_line(replay, DEVICE_NEVER, 0);
    return run_to_line(replay, tick, 0) && (snapshot_move(replay->head.sim, by) || replay_no_memory(replay));
}

static bool do_outputs(struct replay *replay)
{
    static const char *const keys[] = {"outputs", NULL};
    bool outputs;
    if (!replay_keys(replay, keys) || !replay_flag(replay, "outputs", true, &outputs))
        return false;
    if (outputs)
        return replay_wrong(replay, "outputs", "expected \"outputs\": false");
    replay_end_compare(replay);
    return true;
}

/* ---- Lines about what went out -------------------------------------------------------------------------------------- */

static bool expects_outputs(struct replay *replay, const char *key)
{
    return replay->outputs.are_compared ||
           replay_wrong(replay, key, "expected no outputs: the recording declares that it has none");
}

static bool do_out(struct replay *replay)
{
    static const char *const keys[] = {"t", "to", "out", NULL};
    uint64_t from, until;
    size_t length;
    if (!expects_outputs(replay, "out") || !replay_keys(replay, keys) ||
        !replay_number(replay, "t", 0, TIME_VALUE_MAX, DEVICE_NEVER, &from) ||
        !replay_number(replay, "to", from, TIME_VALUE_MAX, from, &until))
        return false;
    const uint8_t *bytes = replay_bytes(replay, "out", SEGMENT_ROOM, &length);
    if (!bytes || !run_to_line(replay, until, length))
        return false;
    sim_finish_tick(replay->head.sim);
    replay_collect_before_tick(replay);
    return replay_expect_nothing(replay, from, 0) && replay_compare_bytes(replay, from, until, bytes, length);
}

static bool read_digest(struct replay *replay, uint64_t *digest)
{
    const char *text = replay_string(replay, "digest");
    if (text && (strlen(text) != 16 || text[strspn(text, "0123456789abcdef")] != '\0'))
        return replay_wrong(replay, "digest", "expected \"digest\", 16 hexadecimal digits 0-9a-f");
    if (text)
        *digest = strtoull(text, NULL, 16);
    return text != NULL;
}

static bool read_span(struct replay *replay, struct replay_span *span)
{
    uint64_t unit, motor;
    json_int_t position = json_integer_value(json_object_get(replay->lines.json, "position"));
    if (!replay_number(replay, "t", 0, TIME_VALUE_MAX, DEVICE_NEVER, &span->tick) ||
        !replay_number(replay, "unit", 0, sim_units(replay->head.sim), DEVICE_NEVER, &unit) ||
        !replay_number(replay, "motor", 0, unit > 0 ? sim_device(replay->head.sim)->axes : 0, DEVICE_NEVER, &motor) ||
        !replay_number(replay, "events", 0, INT64_MAX, DEVICE_NEVER, &span->stream.events) ||
        !replay_number(replay, "steps", 0, INT64_MAX, 0, &span->stream.steps) || !read_digest(replay, &span->stream.digest))
        return false;
    if (position < INT32_MIN || position > INT32_MAX)
        return replay_wrong(replay, "position", "expected \"position\", a whole number of 32 bits");
    span->stream.position = (int32_t)position;
    span->unit = (unsigned)unit;
    span->motor = (unsigned)motor;
    return true;
}

static bool do_digest(struct replay *replay)
{
    static const char *const keys[] = {"t", "partial", "unit", "motor", "events", "steps", "position", "digest", NULL};
    struct replay_span span = {0};
    bool partial;
    if (!expects_outputs(replay, "digest") || !replay_keys(replay, keys) || !read_span(replay, &span) ||
        !replay_flag(replay, "partial", false, &partial) || !run_to_line(replay, span.tick, 0))
        return false;
    if (partial) {
        sim_finish_tick(replay->head.sim);
        replay_collect_all(replay);
    } else {
        replay_collect_before_tick(replay);
    }
    return replay_expect_nothing(replay, span.tick, 0) && replay_compare_stream(replay, &span, partial);
}

static bool do_end(struct replay *replay)
{
    static const char *const keys[] = {"t", "end", NULL};
    uint64_t tick;
    if (!replay_keys(replay, keys) ||
        !replay_number(replay, "t", sim_now(replay->head.sim), TIME_VALUE_MAX, DEVICE_NEVER, &tick) ||
        !run_to_line(replay, tick, 0))
        return false;
    sim_finish_tick(replay->head.sim);
    replay->counts.whole = true;
    if (!replay->outputs.are_compared)
        return true;
    replay_collect_all(replay);
    return replay_compare_rest(replay);
}

/* ---- All lines ------------------------------------------------------------------------------------------------------ */

/* A line is what it has: the first of these keys. */
static const struct kind {
    const char *key;
    bool (*obey)(struct replay *replay);
} kinds[] = {
    {"in", do_bytes},       {"out", do_out},           {"digest", do_digest}, {"command", do_command}, {"purge", do_purge},
    {"break", do_break},    {"timed", do_timed},       {"moved", do_moved},   {"end", do_end},         {"embedded", do_embedded},
    {"outputs", do_outputs},
};

static bool unknown_line(struct replay *replay)
{
    return replay_wrong(replay, NULL, "expected a line with one of \"in\", \"out\", \"digest\", \"command\", \"purge\", "
                                      "\"break\", \"timed\", \"moved\", \"embedded\", \"outputs\", \"end\"");
}

static bool do_line(struct replay *replay)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (json_object_get(replay->lines.json, kinds[i].key))
            return kinds[i].obey(replay);
    return unknown_line(replay);
}

/* What can be said of a line without what comes before it. */
static bool check_line(struct replay *replay)
{
    const char *key = NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0] && !key; i++)
        if (json_object_get(replay->lines.json, kinds[i].key))
            key = kinds[i].key;
    if (!key)
        return unknown_line(replay);
    if (strcmp(key, "embedded") == 0)
        return do_embedded(replay);
    if (strcmp(key, "out") == 0 || strcmp(key, "digest") == 0 || strcmp(key, "outputs") == 0)
        return true;
    return replay_number(replay, "t", replay->checked, TIME_VALUE_MAX, DEVICE_NEVER, &replay->checked);
}

/* Deal with all lines, or pause. Returns false if it has paused. */
static bool for_each_line(struct replay *replay, bool (*deal)(struct replay *replay), bool (*interrupted)(void *context),
                          void *context)
{
    replay->interrupted = interrupted;
    replay->context = context;
    replay->paused = false;
    while (replay_next_line(replay) && !is_interrupted(replay) && deal(replay))
        continue;
    if (replay->paused)
        replay_return_line(replay);
    return !replay->paused;
}

enum replay_end replay_check(struct replay *replay, bool (*interrupted)(void *context), void *context)
{
    if (replay->result.ended)
        return replay->result.end;
    if (!for_each_line(replay, check_line, interrupted, context))
        return REPLAY_INTERRUPTED;
    return replay->result.ended ? replay->result.end : REPLAY_SAME;
}

enum replay_end replay_run(struct replay *replay, bool (*interrupted)(void *context), void *context)
{
    if (replay->result.ended)
        return replay->result.end;
    if (replay->head.outputs && !replay->outputs.have_begun)
        replay_begin_compare(replay);
    if (!for_each_line(replay, do_line, interrupted, context))
        return REPLAY_INTERRUPTED;
    if (!replay->result.ended) {
        replay_finish(&replay->result, REPLAY_SAME);
        if (!replay->counts.whole && replay->result.note[0] == '\0')
            replay_set_note(&replay->result, "no \"end\" line: the recording process was killed or is still running");
    }
    if (replay->result.end == REPLAY_SAME)
        replay_set_text(&replay->result, "the same up to tick %" PRIu64, sim_now(replay->head.sim));
    replay_end_compare(replay);
    return replay->result.end;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

struct replay *replay_open_within(const char *name, FILE *in, unsigned depth)
{
    struct replay *replay = calloc(1, sizeof *replay);
    if (!replay)
        return NULL;
    replay_lines_begin(replay, name, in);
    replay->depth = depth;
    replay->until = DEVICE_NEVER;
    replay->begun = replay_begin(replay);
    if (!replay->begun && !replay->result.ended)
        replay_no_memory(replay);
    return replay;
}

struct replay *replay_open(const char *name, FILE *in)
{
    return replay_open_within(name, in, 0);
}

struct sim *replay_sim(struct replay *replay)
{
    return replay->begun ? replay->head.sim : NULL;
}

void replay_until(struct replay *replay, uint64_t tick)
{
    replay->until = tick;
}

const char *replay_text(const struct replay *replay)
{
    return replay->result.text;
}

const char *replay_note(const struct replay *replay)
{
    return replay->result.note[0] != '\0' ? replay->result.note : NULL;
}

const struct replay_difference *replay_difference(const struct replay *replay)
{
    return replay->result.differs ? &replay->result.difference : NULL;
}

struct replay_counts replay_counts(const struct replay *replay)
{
    struct replay_counts counts = replay->counts;
    counts.lines = replay->lines.count;
    counts.bytes_out = replay->outputs.bytes_out;
    for (unsigned unit = 1; unit < TALLY_UNITS; unit++)
        for (unsigned motor = 1; motor < TALLY_MOTORS; motor++)
            counts.steps += replay->outputs.tally.stream[unit][motor].steps;
    return counts;
}

void replay_free(struct replay *replay)
{
    restore_cancel(replay->inner);
    replay_outputs_free(replay);
    replay_head_free(replay);
    replay_lines_free(replay);
    free(replay);
}
