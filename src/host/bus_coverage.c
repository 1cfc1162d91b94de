#include "bus_coverage.h"

#include <stdlib.h>

#define MASTER 1u /* segment_byte.senders */

bool bus_listener_begin(struct bus_listener *listener, struct coverage *coverage, const struct rkm04_framing *framing,
                        const struct node_list *nodes)
{
    *listener = (struct bus_listener){.coverage = coverage, .framing = framing, .nodes = nodes};
    if (!coverage)
        return true;
    listener->requests.message = malloc(RKM04_MESSAGE_MAX);
    listener->answers.message = malloc(RKM04_MESSAGE_MAX);
    return listener->requests.message && listener->answers.message;
}

/* Returns true when a whole message stands in the ear. */
static bool hear(const struct bus_listener *listener, struct bus_ear *ear, const struct segment_byte *byte)
{
    return listener->framing->receive(&ear->receiver, byte->byte, byte->tick, ear->message, RKM04_MESSAGE_MAX);
}

void bus_listener_hear(struct bus_listener *listener, const struct segment_byte *byte)
{
    if (!listener->coverage || byte->lost)
        return;
    if (byte->senders & ~MASTER) {
        /* Where the framing names the sender, what a collision leaves of a frame is no answer; else it cannot be told. */
        if (hear(listener, &listener->answers, byte))
            coverage_answer(listener->coverage, listener->answers.message, listener->answers.receiver.length);
        return;
    }
    struct bus_ear *ear = &listener->requests;
    if (!hear(listener, ear, byte) || ear->receiver.snode != 0)
        return;
    if (ear->receiver.dnode == 0 || node_list_has(listener->nodes, ear->receiver.dnode))
        coverage_request(listener->coverage, ear->receiver.dnode, ear->message, ear->receiver.length);
}

void bus_listener_end(struct bus_listener *listener)
{
    free(listener->requests.message);
    free(listener->answers.message);
    listener->requests.message = listener->answers.message = NULL;
}
