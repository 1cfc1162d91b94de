/* SPDX-License-Identifier: MIT */
/* bus_options.h: how buses are to be: the options of `rkm04 serve`. */
#ifndef RKM04_BUS_OPTIONS_H
#define RKM04_BUS_OPTIONS_H

#include <stdbool.h>


#include "device/device.h"
#include "line/line.h"
#include "text/text.h"
#include "virtual_clock.h"

#define BUS_LINES_MAX 256u
#define BUS_FOLDERS_MAX 16u
/* A server of the device's own: --service NAME=ADDRESS. */
struct bus_service_option {
    const char *name; /* of the service, in the device's table; NULL: no more */
    const char *address;
};

#define BUS_FILES_MAX 8u /* traces, and logs of the wires */

struct bus_options {
    struct device_arguments device; /* --device and its options */
    const char *nodes_text;     /* --node as given; NULL: the default */
    struct node_list nodes;     /* the same */
    unsigned lines;             /* --lines */
    const char *lines_text, *rts_text; /* --lines, --rts as given; NULL: the default */
    bool pty;                   /* lines have a pty of their own */
    const char *link;           /* NULL: the default */
    const char *wine;           /* NULL: none */
    const char *port;           /* NULL: none */
    const char *tcp;            /* NULL: none */
    const char *rfc2217;        /* NULL: none */
    const char *service_text[DEVICE_SERVICES_MAX]; /* --service as given; NULL: no more */
    struct bus_service_option service[DEVICE_SERVICES_MAX];
    const char *flash, *backup; /* --flash, --backup: the same file; NULL: memory only */
    const char *coverage;       /* NULL: no report */
    int min_coverage;           /* tenths of a per cent; -1: not asked for */
    const char *clock_text;     /* as given: "real", "x10", "max", "stepped" */
    struct virtual_clock clock;
    unsigned baud;              /* of the units, or 0: bytes take no time */
    uint32_t turnaround;        /* us */
    enum line_rts rts;
    bool strict_line;
    bool exit_when_idle;
    unsigned idle_seconds;      /* of --exit-when-idle */
    bool late_skips;            /* --late */
    uint64_t seed;              /* of injected faults */
    const char *plant;          /* file; NULL: none */
    char *plant_text;           /* its content, from read_plant() */
    const char *trace[BUS_FILES_MAX], *wire[BUS_FILES_MAX]; /* patterns; NULL: no more */
    const char *record;         /* pattern; NULL: none */
    unsigned output_flags;      /* of output_file.h: --force */
    const char *control;        /* socket, or file of a TCP port; NULL: the default */
    const char *control_file;   /* as it was given; NULL: it was not */
    const char *control_tcp;    /* address of the TCP port; NULL: none is asked for */
    bool no_control;
    const char *window;         /* ADDRESS:PORT of --window; NULL: none */
    bool verbose;
    bool no_sandbox;            /* --no-sandbox */
    const char *folder[BUS_FOLDERS_MAX]; /* --allow-folder; NULL: no more */
    int ready_fd;               /* -1: none */
};

#endif
