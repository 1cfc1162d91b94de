/* SPDX-License-Identifier: MIT */
#include "journal.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "record_line.h"

#define PAGE_COST 1024u /* bytes of memory that a page takes besides its text, rounded up */

struct journal_page {
    struct journal_page *before;
    unsigned references;
    size_t length, total; /* total: with all before it, and what pages cost */
    size_t bare;          /* the length of a page in which there is only that time was moved; 0: there is no such line */
    uint64_t moved;       /* by so many ticks */
    char *text;
    FILE *stream;         /* of the page that is being written: into text, length */
};

struct journal {
    struct sim *sim;
    struct sim_journal hooks;
    const struct sim_journal *next; /* who was there before us */
    struct journal_page *page;      /* the present one; NULL: out of memory */
    bool too_long;
};

/* ---- Pages ---------------------------------------------------------------------------------------------------------- */

static void end_stream(struct journal_page *page)
{
    if (page->stream)
        fclose(page->stream);
    page->stream = NULL;
}

void journal_page_free(struct journal_page *page)
{
    while (page && --page->references == 0) {
        struct journal_page *before = page->before;
        end_stream(page);
        free(page->text);
        free(page);
        page = before;
    }
}

/* A new page after `before`, whose reference it takes over. */
static struct journal_page *new_page(struct journal_page *before)
{
    struct journal_page *page = calloc(1, sizeof *page);
    if (page)
        page->stream = open_memstream(&page->text, &page->length);
    if (!page || !page->stream) {
        free(page);
        journal_page_free(before);
        return NULL;
    }
    page->before = before;
    page->references = 1;
    page->total = PAGE_COST + (before ? before->total : 0);
    return page;
}

/* ---- What comes in -------------------------------------------------------------------------------------------------- */

/* Where the next line goes; NULL: there is no room for more. */
static FILE *stream_of(struct journal *journal)
{
    return journal->page && !journal->too_long ? journal->page->stream : NULL;
}

static void note_written(struct journal *journal)
{
    struct journal_page *page = journal->page;
    if (fflush(page->stream) != 0 || page->total + page->length > RECORD_EMBEDDED_MAX)
        journal->too_long = true;
}

static void on_bytes(void *context, uint64_t now, uint64_t tick, const uint8_t *bytes, size_t length)
{
    struct journal *journal = context;
    FILE *out = stream_of(journal);
    if (out) {
        record_line_bytes(out, now, tick, bytes, length);
        note_written(journal);
    }
    if (journal->next)
        journal->next->bytes(journal->next->context, now, tick, bytes, length);
}

static void on_purge(void *context, uint64_t now)
{
    struct journal *journal = context;
    FILE *out = stream_of(journal);
    if (out) {
        record_line_purge(out, now);
        note_written(journal);
    }
    if (journal->next)
        journal->next->purge(journal->next->context, now);
}

static void on_break(void *context, uint64_t now, bool on)
{
    struct journal *journal = context;
    FILE *out = stream_of(journal);
    if (out) {
        record_line_break(out, now, on);
        note_written(journal);
    }
    if (journal->next)
        journal->next->line_break(journal->next->context, now, on);
}

static void on_timed(void *context, uint64_t now, bool timed)
{
    struct journal *journal = context;
    FILE *out = stream_of(journal);
    if (out) {
        record_line_timed(out, now, timed);
        note_written(journal);
    }
    if (journal->next)
        journal->next->timed(journal->next->context, now, timed);
}

/* Snapshots change nothing, and coming back turns the pages (journal_turn()). */
static void on_command(void *context, uint64_t now, const char *method, const json_t *params)
{
    struct journal *journal = context;
    FILE *out = stream_of(journal);
    if (out && strcmp(method, "snapshot") != 0 && strcmp(method, "restore") != 0) {
        if (!record_line_command(out, now, method, params))
            journal->too_long = true;
        note_written(journal);
    }
    if (journal->next)
        journal->next->command(journal->next->context, now, method, params);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

struct journal *journal_begin(struct sim *sim)
{
    struct journal *journal = calloc(1, sizeof *journal);
    if (!journal)
        return NULL;
    journal->sim = sim;
    journal->page = new_page(NULL);
    if (!journal->page || !record_line_head(journal->page->stream, sim, false)) {
        journal_free(journal);
        return NULL;
    }
    note_written(journal);
    journal->hooks = (struct sim_journal){
        .bytes = on_bytes,
        .purge = on_purge,
        .line_break = on_break,
        .timed = on_timed,
        .command = on_command,
        .context = journal,
    };
    journal->next = sim->journal;
    sim->journal = &journal->hooks;
    return journal;
}

void journal_free(struct journal *journal)
{
    if (!journal)
        return;
    if (journal->sim->journal == &journal->hooks)
        journal->sim->journal = journal->next;
    journal_page_free(journal->page);
    free(journal);
}

void journal_skip(struct journal *journal, const struct sim_journal *gone, const struct sim_journal *next)
{
    if (journal->next == gone)
        journal->next = next;
}

/* ---- Marks ---------------------------------------------------------------------------------------------------------- */

/* Nothing more is written into the present page; the next one is begun. */
static bool begin_page(struct journal *journal)
{
    if (!journal->page)
        return false;
    end_stream(journal->page);
    journal->page->total += journal->page->length;
    journal->page = new_page(journal->page);
    return journal->page != NULL;
}

struct journal_page *journal_mark(struct journal *journal)
{
    struct journal_page *page = journal->page;
    if (!page || journal->too_long)
        return NULL;
    if (page->length == 0 && page->before) { /* nothing has happened since the last mark */
        page->before->references++;
        return page->before;
    }
    page->references++;
    if (begin_page(journal))
        return page;
    journal_page_free(page);
    return NULL;
}

/* A page with the whole lines of a text. */
static struct journal_page *page_of(const char *text, size_t length)
{
    struct journal_page *page = new_page(NULL);
    while (length > 0 && text[length - 1u] != '\n')
        length--;
    if (!page)
        return NULL;
    fwrite(text, 1, length, page->stream);
    fputs("{\"outputs\":false}\n", page->stream);
    end_stream(page);
    page->total = page->length;
    return page;
}

bool journal_turn(struct journal *journal, struct journal_page *page, const char *text, size_t length, uint64_t later)
{
    struct journal_page *past = page;
    uint64_t now = sim_now(journal->sim);
    if (page && page->bare > 0 && page->length == page->bare) { /* nothing has come in since: both moves are one */
        later += page->moved;
        past = page->before;
    }
    if (past)
        past->references++;
    else if (text)
        past = page_of(text, length);
    journal_page_free(journal->page);
    journal->page = past ? new_page(past) : NULL;
    journal->too_long = false;
    if (!journal->page)
        return false;
    fprintf(journal->page->stream, "{\"t\":%" PRIu64 ",\"moved\":%" PRIu64 "}\n", now - later, later);
    note_written(journal);
    journal->page->bare = journal->page->length;
    journal->page->moved = later;
    return true;
}

const char *journal_gap(const struct journal *journal)
{
    if (journal->too_long)
        return "a snapshot file holds at most 16 MiB of inputs since power-up: take a named snapshot instead, or "
               "restore an earlier one first";
    return journal->page ? NULL : "the inputs since power-up could not be kept (out of memory): restore a snapshot from a file, "
                                  "or restart";
}

static bool write_pages(const struct journal_page *last, FILE *out)
{
    size_t count = 0;
    for (const struct journal_page *page = last; page; page = page->before)
        count++;
    const struct journal_page **pages = malloc(count * sizeof *pages);
    if (!pages)
        return false;
    size_t at = count;
    for (const struct journal_page *page = last; page; page = page->before)
        pages[--at] = page;
    for (at = 0; at < count; at++)
        if (pages[at]->length > 0)
            fwrite(pages[at]->text, 1, pages[at]->length, out);
    free(pages);
    return ferror(out) == 0;
}

bool journal_write(struct journal *journal, FILE *out)
{
    if (!write_pages(journal->page, out))
        return false;
    fprintf(out, "{\"t\":%" PRIu64 ",\"end\":true}\n", sim_now(journal->sim));
    return fflush(out) == 0;
}
