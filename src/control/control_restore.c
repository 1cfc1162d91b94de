/* SPDX-License-Identifier: MIT */
/* restore with a file: its recording is replayed in pieces between the turns of the loop, so that however long it lasts only
 * the client that requests it waits. One continues at a time. */
#include "control_inside.h"
#include "record/record.h"

#define SLICE 2000000u /* ns between two turns of the loop */
#define NS_PER_US 1000u

static bool is_slice_over(void *context)
{
    const struct control_restore *restore = context;
    return uv_hrtime() >= restore->slice_end;
}

/* It is over. Returns what has to be known for the answer. */
static struct control_restore detach_restore(struct control *control)
{
    struct control_restore over = control->restore;
    uv_idle_stop(&control->restoring);
    over.client->restores = false;
    control->restore = (struct control_restore){0};
    control_schedule_lines(control); /* those who want one, too, and what follows this one */
    return over;
}

static void finish(struct control *control)
{
    struct control_restore over = detach_restore(control);
    struct refusal refusal;
    bus_sim(over.bus); /* brings it up to the present */
    json_t *result = restore_end(over.restore, &refusal);
    if (result) {
        bus_changed(over.bus);
        control_answer(over.client, over.id, result);
    } else {
        control_refuse(over.client, over.id, &refusal);
    }
    json_decref(over.id);
}

static void on_turn(uv_idle_t *handle)
{
    struct control *control = handle->data;
    struct control_restore *restore = &control->restore;
    uint64_t now = uv_hrtime();
    restore->slice_end = now + SLICE;
    if (now >= restore->deadline)
        restore_is_late(restore->restore);
    if (now >= restore->deadline || restore_go_on(restore->restore, is_slice_over, restore))
        finish(control);
}

json_t *control_restore(struct control_context *context, struct refusal *refusal)
{
    struct control_client *client = context->client;
    struct control *control = client->control;
    context->again = control->restore.client != NULL;
    if (context->again)
        return NULL;
    struct restore *restore = restore_begin(bus_sim(context->bus), context->request->params, refusal);
    if (!restore)
        return NULL;
    control->restore = (struct control_restore){
        .client = client,
        .bus = context->bus,
        .id = json_incref((json_t *)context->request->id),
        .restore = restore,
        .deadline = uv_hrtime() + restore_timeout(restore) * NS_PER_US,
    };
    client->restores = context->later = true;
    uv_idle_start(&control->restoring, on_turn);
    return NULL;
}

void control_restore_remove_client(struct control_client *client)
{
    if (!client->restores)
        return;
    struct control_restore over = detach_restore(client->control);
    restore_cancel(over.restore);
    json_decref(over.id);
}
