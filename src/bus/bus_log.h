/* SPDX-License-Identifier: MIT */
/* bus_log.h: the log of one bus: each line with the tick, and with the number of the bus if there are several. */
#ifndef RKM04_BUS_LOG_H
#define RKM04_BUS_LOG_H

#include <stdbool.h>
#include <stdint.h>

struct bus_log {
    unsigned number; /* of the bus: 0, 1, … */
    bool several;    /* there are other buses */
    bool detailed;   /* --verbose */
    uint64_t (*present)(const void *context); /* returns the present tick */
    const void *context;
};

/* Write one line, at the present tick. */
void bus_log(const struct bus_log *log, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same with --verbose only: what happens at every call of a client. */
void bus_log_detail(const struct bus_log *log, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Write one line, at `tick`. */
void bus_log_at(const struct bus_log *log, uint64_t tick, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
