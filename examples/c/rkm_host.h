/* SPDX-License-Identifier: MIT */
/* rkm_host.h: a small host library for the RKM04 on a serial port. It knows nothing of the emulator. */
#ifndef RKM_HOST_H
#define RKM_HOST_H

#include <stdbool.h>
#include <stdint.h>

struct rkm_unit {
    int fd;         /* of the port */
    uint8_t node;   /* 1 to 16 */
    int timeout;    /* ms to wait for an answer */
    int retries;    /* how often a request without an answer is sent again */
};

enum rkm_result {
    RKM_OK,
    RKM_NO_ANSWER, /* none came, however often the request was sent */
    RKM_REFUSED,   /* the unit refuses the request */
    RKM_PORT       /* the port failed: errno */
};

/* Open a port at 19200 8N1. Returns RKM_PORT on failure. */
enum rkm_result rkm_open(struct rkm_unit *unit, const char *path, uint8_t node);
void rkm_close(struct rkm_unit *unit);

/* Give a motor, 1 to 4 or 0 for all, commands: a text of at most 500 characters. */
enum rkm_result rkm_set_command(struct rkm_unit *unit, int motor, const char *text);

/* Get the position counter of a motor, 1 to 4. */
enum rkm_result rkm_position(struct rkm_unit *unit, int motor, int32_t *position);

/* Is a motor, 1 to 4, executing a command? */
enum rkm_result rkm_busy(struct rkm_unit *unit, int motor, bool *busy);

#endif
