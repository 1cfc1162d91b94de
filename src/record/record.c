/* SPDX-License-Identifier: MIT */
#include "record.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "record_line.h"
#include "snapshot_store.h"
#include "tally.h"

#define GAP 2000u      /* ticks: bytes further apart are in two lines */
#define GATHERED 256u  /* bytes in a line */

struct record {
    struct sim *sim;
    FILE *out;
    int error;
    struct tally tally;
    struct sim_journal hooks;
    const struct sim_journal *next;  /* who was there before us */
    uint64_t from, until;            /* ticks of the first and last byte gathered */
    size_t gathered;
    uint8_t bytes[GATHERED];
};

/* After the first failure nothing is written: the content of the file can be used. */
static void note_written(struct record *record)
{
    if (fflush(record->out) != 0 && record->error == 0)
        record->error = errno != 0 ? errno : EIO;
}

/* ---- What goes out -------------------------------------------------------------------------------------------------- */

static void write_gathered(struct record *record)
{
    if (record->gathered > 0 && record->error == 0) {
        fprintf(record->out, "{\"t\":%" PRIu64, record->from);
        if (record->until > record->from)
            fprintf(record->out, ",\"to\":%" PRIu64, record->until);
        fputs(",\"out\":\"", record->out);
        record_hex(record->out, record->bytes, record->gathered);
        fputs("\"}\n", record->out);
        note_written(record);
    }
    record->gathered = 0;
}

static void on_out(void *context, const struct tally_byte *byte)
{
    struct record *record = context;
    if (record->gathered == GATHERED || (record->gathered > 0 && byte->tick - record->until > GAP))
        write_gathered(record);
    if (record->gathered == 0)
        record->from = byte->tick;
    record->until = byte->tick;
    record->bytes[record->gathered++] = byte->byte;
}

static void write_digests(struct record *record, uint64_t tick, const char *more)
{
    write_gathered(record);
    for (unsigned unit = 0; unit < TALLY_UNITS; unit++) {
        for (unsigned motor = 0; motor < TALLY_MOTORS; motor++) {
            const struct tally_stream *stream = &record->tally.stream[unit][motor];
            if (!stream->changed || record->error != 0)
                continue;
            fprintf(record->out, "{\"t\":%" PRIu64 "%s,\"unit\":%u,\"motor\":%u,\"events\":%" PRIu64, tick, more, unit, motor,
                    stream->events);
            if (stream->steps > 0)
                fprintf(record->out, ",\"steps\":%" PRIu64 ",\"position\":%" PRId32, stream->steps, stream->position);
            fprintf(record->out, ",\"digest\":\"%016" PRIx64 "\"}\n", stream->digest);
        }
    }
    if (record->error == 0)
        note_written(record);
}

static void on_span(void *context, uint64_t tick)
{
    write_digests(context, tick, "");
}

/* ---- What comes in -------------------------------------------------------------------------------------------------- */

/* Everything before has gone out. Returns false if nothing is to be written any more. */
static bool finish_tick(struct record *record)
{
    tally_finish_tick(&record->tally);
    write_gathered(record);
    return record->error == 0;
}

static void on_bytes(void *context, uint64_t now, uint64_t tick, const uint8_t *bytes, size_t length)
{
    struct record *record = context;
    if (finish_tick(record)) {
        record_line_bytes(record->out, now, tick, bytes, length);
        note_written(record);
    }
    if (record->next)
        record->next->bytes(record->next->context, now, tick, bytes, length);
}

static void on_purge(void *context, uint64_t now)
{
    struct record *record = context;
    if (finish_tick(record)) {
        record_line_purge(record->out, now);
        note_written(record);
    }
    if (record->next)
        record->next->purge(record->next->context, now);
}

static void on_break(void *context, uint64_t now, bool on)
{
    struct record *record = context;
    if (finish_tick(record)) {
        record_line_break(record->out, now, on);
        note_written(record);
    }
    if (record->next)
        record->next->line_break(record->next->context, now, on);
}

static void on_timed(void *context, uint64_t now, bool timed)
{
    struct record *record = context;
    if (finish_tick(record)) {
        record_line_timed(record->out, now, timed);
        note_written(record);
    }
    if (record->next)
        record->next->timed(record->next->context, now, timed);
}

/* The file that a restore has read is before it, line by line, so that the recording can be replayed anywhere. */
static void embed_recording(struct record *record, uint64_t now, const struct sim_snapshots *store)
{
    size_t length = store->length, lines = 0;
    while (length > 0 && store->text[length - 1u] != '\n')
        length--;
    for (size_t i = 0; i < length; i++)
        lines += store->text[i] == '\n';
    fprintf(record->out, "{\"t\":%" PRIu64 ",\"embedded\":%zu}\n", now, lines);
    fwrite(store->text, 1, length, record->out);
}

static void on_command(void *context, uint64_t now, const char *method, const json_t *params)
{
    struct record *record = context;
    const struct sim_snapshots *store = record->sim->snapshots;
    if (finish_tick(record)) {
        if (strcmp(method, "restore") == 0 && store->text)
            embed_recording(record, now, store);
        if (!record_line_command(record->out, now, method, params))
            record->error = ENOMEM;
        note_written(record);
    }
    if (record->next)
        record->next->command(record->next->context, now, method, params);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

struct record *record_begin(struct sim *sim, FILE *out)
{
    static const struct tally_calls calls = {.byte = on_out, .span = on_span};
    struct record *record = calloc(1, sizeof *record);
    if (!record)
        return NULL;
    record->sim = sim;
    record->out = out;
    if (!record_line_head(out, sim, true)) {
        free(record);
        return NULL;
    }
    note_written(record);
    record->hooks = (struct sim_journal){
        .bytes = on_bytes,
        .purge = on_purge,
        .line_break = on_break,
        .timed = on_timed,
        .command = on_command,
        .context = record,
    };
    record->next = sim->journal;
    sim->journal = &record->hooks;
    tally_begin(&record->tally, sim, &calls, record);
    return record;
}

int record_failed(const struct record *record)
{
    return record->error;
}

int record_end(struct record *record)
{
    sim_finish_tick(record->sim);
    tally_finish(&record->tally);
    write_digests(record, sim_now(record->sim), ",\"partial\":true");
    if (record->error == 0) {
        fprintf(record->out, "{\"t\":%" PRIu64 ",\"end\":true}\n", sim_now(record->sim));
        note_written(record);
    }
    int error = record->tally.short_of_memory || record->sim->watch.short_of_memory ? ENOMEM : record->error;
    tally_end(&record->tally);
    if (record->sim->journal == &record->hooks)
        record->sim->journal = record->next;
    else if (record->sim->snapshots && record->sim->snapshots->journal)
        journal_skip(record->sim->snapshots->journal, &record->hooks, record->next);
    free(record);
    return error;
}
