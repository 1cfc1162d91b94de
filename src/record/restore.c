/* SPDX-License-Identifier: MIT */
/* restore.c: restoring a file: its lines are checked, then replayed in a sim of their own, both in pieces; at the end the sim
 * becomes like that one. The machine's clock is checked for limits only. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "record_line.h"
#include "replay_state.h"
#include "snapshot_store.h"

#define SECOND UINT64_C(1000000) /* us */

struct restore {
    struct sim *sim;
    const char *name;
    FILE *in;
    unsigned depth;
    bool checked;           /* `replay` is the one that does it */
    enum replay_end end;
    struct replay *replay;

    /* Of the command: */
    json_t *params;
    char *text;
    size_t length;
    uint64_t timeout, deadline; /* us of the machine's clock */
    bool late;
};

static const char out_of_memory[] = "out of memory";

/* ---- The recording ------------------------------------------------------------------------------------------------------- */

static bool open_replay(struct restore *restore)
{
    rewind(restore->in);
    restore->replay = replay_open_within(restore->name, restore->in, restore->depth);
    restore->end = REPLAY_INTERRUPTED;
    return restore->replay != NULL;
}

/* Refuse what another bus has recorded, as soon as the head is read. Returns whether it fits. */
static bool is_fitting(const struct restore *restore, struct refusal *refusal)
{
    struct sim *recorded = replay_sim(restore->replay);
    const char *unlike = recorded ? snapshot_difference(restore->sim, recorded) : NULL;
    if (!recorded)
        refuse(refusal, REFUSED_STATE, "file: %s", replay_text(restore->replay));
    else if (unlike)
        refuse(refusal, REFUSED_STATE, "the snapshot does not fit this bus: %s is different", unlike);
    return recorded && !unlike;
}

struct restore *restore_open(struct sim *sim, const char *name, const char *text, size_t length, unsigned depth,
                             struct refusal *refusal)
{
    if (length == 0) {
        refuse(refusal, REFUSED_STATE, "%.160s is empty: expected a recording", name);
        return NULL;
    }
    struct restore *restore = calloc(1, sizeof *restore);
    if (restore) {
        *restore = (struct restore){.sim = sim, .name = name, .depth = depth, .in = fmemopen((void *)text, length, "r")};
        if (restore->in && open_replay(restore)) {
            if (is_fitting(restore, refusal))
                return restore;
            restore_cancel(restore);
            return NULL;
        }
    }
    restore_cancel(restore);
    refuse(refusal, REFUSED_MEMORY, out_of_memory);
    return NULL;
}

void restore_cancel(struct restore *restore)
{
    if (!restore)
        return;
    if (restore->replay)
        replay_free(restore->replay);
    if (restore->in)
        fclose(restore->in);
    json_decref(restore->params);
    free(restore->text);
    free(restore);
}

bool restore_go_on(struct restore *restore, bool (*interrupted)(void *context), void *context)
{
    if (!restore->checked) {
        restore->end = replay_check(restore->replay, interrupted, context);
        if (restore->end != REPLAY_SAME)
            return restore->end != REPLAY_INTERRUPTED;
        restore->checked = true;
        replay_free(restore->replay);
        if (!open_replay(restore)) {
            restore->end = REPLAY_NO_MEMORY;
            return true;
        }
    }
    restore->end = replay_run(restore->replay, interrupted, context);
    return restore->end != REPLAY_INTERRUPTED;
}

static json_t *put_state(const struct restore *restore, struct refusal *refusal)
{
    struct sim_snapshots *store = snapshots_of(restore->sim);
    if (restore->late)
        return refuse(refusal, REFUSED_STATE, "file: after %" PRIu64 ".%03" PRIu64 " s of real time the replay has only "
                      "reached %" PRIu64 " us: give a longer timeout",
                      restore->timeout / SECOND, restore->timeout % SECOND / 1000u,
                      sim_now(replay_sim(restore->replay)));
    if (restore->end != REPLAY_SAME && restore->end != REPLAY_NO_MEMORY)
        return refuse(refusal, REFUSED_STATE, "file: %s", replay_text(restore->replay));
    struct snapshot *snapshot = store && restore->end == REPLAY_SAME ? snapshot_take(replay_sim(restore->replay)) : NULL;
    json_t *result = snapshot ? snapshots_put(store, snapshot, NULL, refusal) : refuse(refusal, REFUSED_MEMORY, out_of_memory);
    snapshot_free(snapshot);
    return result;
}

/* ---- The command ------------------------------------------------------------------------------------------------------ */

static uint64_t real_time(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * SECOND + (uint64_t)now.tv_nsec / 1000u;
}

/* Open a regular file. Its kind is checked when it is open: a pipe put there in between would wait for its
 * writer. Returns NULL: refused. */
static FILE *open_regular(const char *path, struct refusal *refusal)
{
    struct stat status;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd >= 0 && fstat(fd, &status) == 0 && !S_ISREG(status.st_mode)) {
        close(fd);
        refuse(refusal, REFUSED_STATE, "file: %.160s is not a regular file: expected a recording or a snapshot", path);
        return NULL;
    }
    FILE *in = fd >= 0 ? fdopen(fd, "r") : NULL;
    if (in == NULL)
        refuse(refusal, REFUSED_STATE, "file: cannot read %.160s: %s", path, strerror(errno));
    if (in == NULL && fd >= 0)
        close(fd);
    return in;
}

/* Read a whole file. Returns false: refused. */
static bool read_file(struct restore *restore, struct refusal *refusal)
{
    const char *path = restore->name;
    FILE *in = open_regular(path, refusal);
    if (in == NULL)
        return false;
    char *text = malloc(RECORD_EMBEDDED_MAX + 1u);
    size_t length = text ? fread(text, 1, RECORD_EMBEDDED_MAX + 1u, in) : 0;
    int error = errno;
    bool ok = text && !ferror(in) && length <= RECORD_EMBEDDED_MAX;
    fclose(in);
    if (ok) {
        restore->text = text;
        restore->length = length;
        text = realloc(restore->text, length + 1u);
        if (text)
            restore->text = text;
        return true;
    }
    free(text);
    if (length > RECORD_EMBEDDED_MAX)
        refuse(refusal, REFUSED_STATE, "file: %.160s is longer than %u MiB", path, RECORD_EMBEDDED_MAX >> 20);
    else
        refuse(refusal, REFUSED_STATE, "file: cannot read %.160s: %s", path, strerror(error));
    return false;
}

static struct restore *open_text(struct sim *sim, struct restore *read, struct refusal *refusal)
{
    struct restore *restore = restore_open(sim, read->name, read->text, read->length, 0, refusal);
    if (!restore) {
        free(read->text);
        return NULL;
    }
    restore->text = read->text;
    restore->length = read->length;
    restore->timeout = read->timeout;
    return restore;
}

struct restore *restore_begin(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"file", "timeout", NULL};
    struct restore read = {.name = params_known(params, names, refusal) ? param_string(params, "file", refusal) : NULL};
    if (!read.name || !param_time(params, "timeout", RESTORE_SECONDS * SECOND, &read.timeout, refusal))
        return NULL;
    if (*read.name == '\0') {
        refuse(refusal, REFUSED_PARAMS, "file: expected a path");
        return NULL;
    }
    struct restore *restore = read_file(&read, refusal) ? open_text(sim, &read, refusal) : NULL;
    if (restore)
        restore->params = json_incref((json_t *)params);
    return restore;
}

uint64_t restore_timeout(const struct restore *restore)
{
    return restore->timeout;
}

void restore_is_late(struct restore *restore)
{
    restore->late = true;
}

static bool is_to_end(void *context)
{
    struct restore *restore = context;
    const struct sim *sim = restore->sim;
    restore->late = real_time() >= restore->deadline;
    return restore->late || (sim->interrupted && sim->interrupted(sim->interrupted_context));
}

json_t *restore_at_once(struct restore *restore, struct refusal *refusal)
{
    restore->deadline = real_time() + restore->timeout;
    restore_go_on(restore, is_to_end, restore);
    return restore_put(restore, refusal);
}

json_t *restore_put(struct restore *restore, struct refusal *refusal)
{
    struct sim_snapshots *store = snapshots_of(restore->sim);
    if (store && restore->text) {
        snapshots_keep_text(store, restore->text, restore->length);
        restore->text = NULL; /* it stays until the next one: records and the journal want it */
    }
    json_t *result = put_state(restore, refusal);
    restore_cancel(restore);
    return result;
}

json_t *restore_end(struct restore *restore, struct refusal *refusal)
{
    struct sim *sim = restore->sim;
    json_t *params = json_incref(restore->params);
    sim_finish_tick(sim);
    uint64_t now = sim_now(sim);
    json_t *result = restore_put(restore, refusal);
    if (result && sim->journal)
        sim->journal->command(sim->journal->context, now, "restore", params);
    json_decref(params);
    return result;
}
