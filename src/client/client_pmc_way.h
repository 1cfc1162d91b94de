/* SPDX-License-Identifier: MIT */
/* client_pmc_way.h: the ways to a PMC: what each can do. Everything reports what goes wrong. */
#ifndef RKM04_CLIENT_PMC_WAY_H
#define RKM04_CLIENT_PMC_WAY_H

#include <stdbool.h>
#include <stdint.h>

#include "client_job.h"
#include "pmc/pmc.h"

/* Text of a whole program or of all parameters. */
enum pmc_text_kind { PMC_TEXT_PROGRAM, PMC_TEXT_PARAMETERS };

struct pmc_link {
    const struct pmc_way *way;
    /* A line. */
    const char *port; /* for messages */
    int fd;           /* -1: none */
    uint8_t node;
    unsigned timeout_ms;
    uint64_t free_at; /* us: when the next frame may be sent */
    /* The control socket. */
    struct client_job *job;
};

struct pmc_way {
    const char *name;
    enum exit_status (*ask)(struct pmc_link *link, const struct pmc_request *request);
    /* Counters, and errors as enum pmc_error, of each axis; their number. */
    enum exit_status (*positions)(struct pmc_link *link, int32_t position[PMC_AXES], unsigned *axes);
    enum exit_status (*errors)(struct pmc_link *link, uint8_t errors[PMC_AXES], unsigned *axes);
    /* *text is to be freed. */
    enum exit_status (*get)(struct pmc_link *link, enum pmc_text_kind kind, char **text);
    enum exit_status (*put)(struct pmc_link *link, enum pmc_text_kind kind, const char *name, const char *text);
    enum exit_status (*store)(struct pmc_link *link, uint8_t axes); /* 0: all */
};

extern const struct pmc_way client_pmc_lines, client_pmc_modbus, client_pmc_control;

/* Send bytes. */
enum exit_status client_pmc_send(struct pmc_link *link, const uint8_t *bytes, size_t length);

/* Read until `is_whole` says so of what has come, or the time is over. Returns how many bytes there are; 0: nothing whole came
 * (reported). */
size_t client_pmc_receive(struct pmc_link *link, uint8_t *bytes, size_t room,
                          bool (*is_whole)(const uint8_t *bytes, size_t length));

/* Report what is wrong in a text: NAME:LINE:COLUMN: error: ... */
pmc_text_report client_pmc_print_error;

#endif
