/* SPDX-License-Identifier: MIT */
/* The commands snapshot and restore. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "file/file.h"
#include "snapshot_store.h"

static const char out_of_memory[] = "out of memory";

static void free_named(struct named_snapshot *named)
{
    free(named->name);
    snapshot_free(named->snapshot);
    journal_page_free(named->page);
    *named = (struct named_snapshot){0};
}

static void snapshots_free(struct sim_snapshots *snapshots)
{
    for (size_t i = 0; i < snapshots->count; i++)
        free_named(&snapshots->named[i]);
    journal_free(snapshots->journal);
    free(snapshots->text);
    free(snapshots);
}

struct sim_snapshots *snapshots_of(struct sim *sim)
{
    if (!sim->snapshots) {
        sim->snapshots = calloc(1, sizeof *sim->snapshots);
        if (sim->snapshots)
            sim->snapshots->sim = sim;
        sim->free_snapshots = snapshots_free;
    }
    return sim->snapshots;
}

bool snapshots_keep_journal(struct sim *sim)
{
    struct sim_snapshots *store = snapshots_of(sim);
    if (!store)
        return false;
    if (!store->journal)
        store->journal = journal_begin(sim);
    return store->journal != NULL;
}

/* ---- Parameters ----------------------------------------------------------------------------------------------------- */

/* Either `name` or `file`. Returns false: refused. */
static bool read_params(const json_t *params, const char *const *known, const char **name, const char **file,
                        struct refusal *refusal)
{
    const json_t *given_name = json_object_get(params, "name"), *given_file = json_object_get(params, "file");
    *name = *file = NULL;
    if (!params_known(params, known, refusal))
        return false;
    if (!given_name == !given_file) {
        refuse(refusal, REFUSED_PARAMS, "expected either `name', for a snapshot in memory, or `file'");
        return false;
    }
    if (given_file)
        return (*file = param_string(params, "file", refusal)) != NULL && (**file || refuse(refusal, REFUSED_PARAMS,
                                                                                            "file: expected a path"));
    *name = param_string(params, "name", refusal);
    if (*name && (**name == '\0' || strlen(*name) > SNAPSHOT_NAME_MAX)) {
        refuse(refusal, REFUSED_PARAMS, "name: expected 1 to %u characters", SNAPSHOT_NAME_MAX);
        return false;
    }
    return *name != NULL;
}

static struct named_snapshot *find(struct sim_snapshots *store, const char *name)
{
    for (size_t i = 0; i < store->count; i++)
        if (strcmp(store->named[i].name, name) == 0)
            return &store->named[i];
    return NULL;
}

/* ---- snapshot ------------------------------------------------------------------------------------------------------- */

static json_t *take_named(struct sim_snapshots *store, const char *name, struct refusal *refusal)
{
    struct named_snapshot *named = find(store, name), made = {0};
    if (!named && store->count == SNAPSHOTS_MAX)
        return refuse(refusal, REFUSED_STATE, "too many snapshots (%u): replace one by using its name", SNAPSHOTS_MAX);
    made.name = strdup(name);
    made.snapshot = snapshot_take(store->sim);
    if (!made.name || !made.snapshot) {
        free_named(&made);
        return refuse(refusal, REFUSED_MEMORY, "out of memory, or the flash image of a unit cannot be read");
    }
    if (store->journal)
        made.page = journal_mark(store->journal);
    if (named)
        free_named(named);
    else
        named = &store->named[store->count++];
    *named = made;
    return json_pack("{s:s, s:I}", "name", name, "t_us", (json_int_t)sim_now(store->sim));
}

static bool write_journal(void *context, FILE *out)
{
    return journal_write(context, out);
}

static json_t *write_file(struct sim_snapshots *store, const char *path, bool force, struct refusal *refusal)
{
    const char *gap = store->journal ? journal_gap(store->journal) : "the inputs since power-up were not kept: use `name'";
    unsigned flags = OUTPUT_REQUESTED | (force ? OUTPUT_FORCE : 0u);
    char *why;
    if (gap)
        return refuse(refusal, REFUSED_STATE, "file: cannot write a snapshot: %s", gap);
    if (output_file_replace(path, &output_recording, flags, write_journal, store->journal, &why))
        return json_pack("{s:s, s:I}", "file", path, "t_us", (json_int_t)sim_now(store->sim));
    refuse(refusal, REFUSED_STATE, "file: cannot write %.160s: %s", path, why ? why : out_of_memory);
    free(why);
    return NULL;
}

static json_t *command_snapshot(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const known[] = {"name", "file", "force", NULL};
    const char *name, *file;
    bool force;
    struct sim_snapshots *store = snapshots_of(sim);
    if (!store)
        return refuse(refusal, REFUSED_MEMORY, out_of_memory);
    if (!read_params(params, known, &name, &file, refusal) || !param_flag(params, "force", &force, refusal))
        return NULL;
    return file ? write_file(store, file, force, refusal) : take_named(store, name, refusal);
}

/* ---- restore -------------------------------------------------------------------------------------------------------- */

void snapshots_keep_text(struct sim_snapshots *store, char *text, size_t length)
{
    free(store->text);
    store->text = text;
    store->length = length;
}

json_t *snapshots_put(struct sim_snapshots *store, const struct snapshot *snapshot, struct journal_page *page,
                      struct refusal *refusal)
{
    const char *misfit = snapshot_misfit(store->sim, snapshot);
    if (misfit)
        return refuse(refusal, REFUSED_STATE, "the snapshot does not fit this bus: %s is different", misfit);
    if (!snapshot_restore(store->sim, snapshot))
        return refuse(refusal, REFUSED_MEMORY, "out of memory, or the flash image of a unit cannot be written");
    if (sim_services_are_open(store->sim)) { /* their clients are of another present; the journal has to know it */
        struct refusal none;
        json_decref(sim_command(store->sim, "service.close", NULL, &none));
    }
    uint64_t now = sim_now(store->sim), taken = snapshot_tick(snapshot);
    if (store->journal)
        journal_turn(store->journal, page, page ? NULL : store->text, store->length, now - taken);
    return json_pack("{s:I, s:I}", "t_us", (json_int_t)now, "taken_us", (json_int_t)taken);
}

static json_t *restore_named(struct sim_snapshots *store, const char *name, struct refusal *refusal)
{
    struct named_snapshot *named = find(store, name);
    char names[200] = "";
    if (named)
        return snapshots_put(store, named->snapshot, named->page, refusal);
    for (size_t i = 0; i < store->count; i++)
        snprintf(names + strlen(names), sizeof names - strlen(names), i > 0 ? ", %s" : "%s", store->named[i].name);
    return refuse(refusal, REFUSED_STATE, "name: there is no snapshot `%.64s': expected one of %s", name,
                  store->count > 0 ? names : "those taken with `snapshot': none yet");
}

static json_t *command_restore(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const known[] = {"name", "file", "timeout", NULL};
    const char *name, *file;
    struct sim_snapshots *store = snapshots_of(sim);
    if (!store)
        return refuse(refusal, REFUSED_MEMORY, out_of_memory);
    snapshots_keep_text(store, NULL, 0);
    if (!read_params(params, known, &name, &file, refusal))
        return NULL;
    if (name)
        return restore_named(store, name, refusal);
    struct restore *restore = restore_begin(sim, params, refusal);
    return restore ? restore_at_once(restore, refusal) : NULL;
}

static const struct command_method snapshot_methods[] = {
    {"snapshot", command_snapshot, true},
    {"restore", command_restore, true},
    {NULL, NULL, false},
};

bool snapshots_attach(struct sim *sim)
{
    return command_attach(sim, snapshot_methods);
}
