/* SPDX-License-Identifier: MIT */
/* window_watch.h: the emulator of the window and the state of its units, for the pages that watch: asked for as often as
 * something moves or happens, at most 20 times a second, otherwise once a second, of a device with cells ten times. Pages get
 * what has changed. */
#ifndef RKM04_WINDOW_WATCH_H
#define RKM04_WINDOW_WATCH_H

#include <jansson.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#define WATCH_UNITS_MAX 16u
#define WATCH_NAME_SIZE 8u /* "16-16" */

struct pages;
struct window_control;

struct window_watch {
    struct pages *pages;
    char path[PATH_MAX]; /* of the control socket; empty: no emulator */
    int bus;             /* --line */
    struct window_control *control; /* NULL: no connection now */
    char trouble[256];   /* why; empty: nothing is wrong */
    char units[WATCH_UNITS_MAX][WATCH_NAME_SIZE];
    unsigned count;
    uint64_t sums[WATCH_UNITS_MAX]; /* of what the pages know */
    json_t *about;       /* result of `ready`; NULL: not known */
    json_t *device;      /* result of `device`; NULL: not known */
    unsigned asked;      /* states that have not been answered */
    bool moving, news;   /* a state has changed since the last round; something has happened */
    unsigned messages;   /* of the bus, sent since the last round */
    uint64_t round;      /* loop time of the last one */
    uv_timer_t timer;
};

void window_watch_begin(struct window_watch *watch, struct pages *pages);
void window_watch_end(struct window_watch *watch);

/* Another emulator, or none (NULL). */
void window_watch_choose(struct window_watch *watch, const char *path, int bus);

/* Pages have come, gone, begun or ended to watch. */
void window_watch_pages_changed(struct window_watch *watch);

/* Has the device of the units a method of its own with this name? */
bool window_watch_has_method(const struct window_watch *watch, const char *method);

/* What pages get: {"event": "emulator", "control", "bus", "units", "connected", "trouble", "ready", "device"}. New reference. */
json_t *window_watch_json(const struct window_watch *watch);

#endif
