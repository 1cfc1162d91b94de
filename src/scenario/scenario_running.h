/* SPDX-License-Identifier: MIT */
/* scenario_running.h: a scenario while it runs. Private to the room: scenario_run.c has time and stimuli, scenario_do.c the steps
 * (it writes `last` alone), scenario_host.c what the host sends and receives (it writes `host` alone). */
#ifndef RKM04_SCENARIO_RUNNING_H
#define RKM04_SCENARIO_RUNNING_H

#include "scenario_model.h"

#define ANSWER_ROOM 16384 /* the longest answer, a full memory, has 9101 bytes */

struct running_stimulus {
    struct condition *when; /* NULL: at a time */
    uint64_t due;           /* DEVICE_NEVER: not known yet */
    bool acted;
};

struct pulse_count {
    int64_t forward, back;
};

/* The first fault of a motor. */
struct running_fault {
    bool there;
    uint64_t tick;
    unsigned unit, motor;
    unsigned fault;
};

struct host {
    struct rkm04_receiver receiver;
    uint8_t buffer[ANSWER_ROOM];
    bool listening, answered; /* the first answer since it began to listen is kept */
    uint8_t dnode, snode;
    size_t length;            /* of the answer in the buffer */
    uint64_t sent;            /* tick at which the last message had passed; 0: none */
};

struct running {
    const struct scenario *scenario;
    struct sim *sim;
    struct scenario_result *result;
    enum scenario_end end;
    bool over;                /* it has failed, or cannot continue */
    bool (*interrupted)(void *context, uint64_t tick);
    void *context;
    unsigned turns;           /* of time, between two questions whether it is to end */
    const struct scenario_step *step; /* being done */
    struct condition **always;
    struct running_stimulus *stimulus;
    struct host host;
    struct watcher watcher;
    struct running_fault fault;
    uint32_t forward[SEGMENT_UNITS]; /* direction outputs, bit 0: motor 1 */
    struct pulse_count count[SEGMENT_UNITS][DEVICE_AXES_MAX], last[SEGMENT_UNITS][DEVICE_AXES_MAX];
};

/* The run has failed, at `tick` and because of the content of `step`. `expected` and `seen` are taken over; NULL: memory was
 * short. Always returns false. */
bool running_failed(struct running *running, const struct scenario_step *step, uint64_t tick, char *expected, char *seen);
bool running_no_memory(struct running *running);

/* printf into a string to be freed. */
char *running_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Let time continue, up to `limit` at most, but no further than to where `condition` (NULL: none) may have come to hold, or an
 * answer may be there while the host listens. Returns false if the run is over. */
bool running_advance(struct running *running, uint64_t limit, struct condition *condition);

/* Do a step, or what a stimulus has to do. Returns false if the run is over. */
bool running_do_step(struct running *running, const struct scenario_step *step);

/* The host's receiver, for sim_config.out. */
void running_receive(void *context, const uint8_t *bytes, size_t length);

/* Messages that end with a silence: when the one that comes in ends if nothing more does, DEVICE_NEVER: none comes in; it may be
 * over. */
uint64_t running_silence_end(const struct running *running);
void running_end_silence(struct running *running);

/* Send what the step says and judge the answer. */
bool running_send(struct running *running, const struct scenario_step *step);

#endif
