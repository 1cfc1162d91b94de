/* bus_coverage.h: listens to a line for the coverage of the protocol: takes the messages out of the bytes. */
#ifndef RKM04_HOST_BUS_COVERAGE_H
#define RKM04_HOST_BUS_COVERAGE_H

#include "coverage.h"
#include "segment.h"
#include "serve_names.h"

struct bus_ear {
    struct rkm04_receiver receiver;
    uint8_t *message; /* RKM04_MESSAGE_MAX bytes */
};

struct bus_listener {
    struct coverage *coverage; /* NULL: nobody listens */
    const struct rkm04_framing *framing;
    const struct node_list *nodes;
    struct bus_ear requests, answers;
};

/* Begin to listen to a line with these units. Returns false if memory is short. */
bool bus_listener_begin(struct bus_listener *listener, struct coverage *coverage, const struct rkm04_framing *framing,
                        const struct node_list *nodes);

/* A byte has passed. */
void bus_listener_hear(struct bus_listener *listener, const struct segment_byte *byte);

void bus_listener_end(struct bus_listener *listener);

#endif
