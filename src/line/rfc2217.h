/* SPDX-License-Identifier: MIT */
/* rfc2217.h: a serial port over telnet (RFC 2217, 854), the access server's side: what the bytes of a client mean, and what is
 * answered. Pure: bytes in, bytes out.
 *
 * It has no real port: every setting that has a name is taken and acknowledged, so that a client gets what it asks for,
 * and CTS, DSR and carrier are always there, so that none waits for them. */
#ifndef RKM04_LINE_RFC2217_H
#define RKM04_LINE_RFC2217_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RFC2217_REPLY_MAX 64   /* bytes of the longest reply */
#define RFC2217_COMMAND_MAX 16 /* bytes of a command that are checked; only signatures are longer */

/* What a byte of the client meant, besides the reply it may have caused. */
enum rfc2217_event {
    RFC2217_NOTHING,
    RFC2217_DATA,        /* `data` is data */
    RFC2217_SETTINGS,    /* baud, data_bits, parity or stop_bits has changed */
    RFC2217_LINES,       /* dtr or rts has changed */
    RFC2217_BREAK,       /* `breaking` has changed */
    RFC2217_BREAK_PULSE, /* a break of no given length */
    RFC2217_PURGE,       /* `purge` says what is to be discarded */
    RFC2217_FLOW         /* `suspended` has been set */
};

enum rfc2217_purge {
    RFC2217_PURGE_TO_CLIENT = 1,
    RFC2217_PURGE_TO_LINE = 2
};

struct rfc2217 {
    /* In force. */
    uint32_t baud;
    uint8_t data_bits; /* 5..8 */
    char parity;       /* N, O, E, M, S */
    uint8_t stop_bits; /* 1, 2; 3 stands for 1.5 */
    bool dtr, rts, breaking;
    bool suspended;    /* the client wants no data for now */

    /* What the byte before has brought. */
    uint8_t data;
    uint8_t purge; /* of enum rfc2217_purge */
    uint8_t reply[RFC2217_REPLY_MAX];
    size_t reply_length;

    /* Inside. */
    uint8_t flow_out, flow_in; /* SET-CONTROL values */
    uint8_t line_mask, modem_mask;
    uint8_t state, verb;
    uint8_t ours[3], theirs[3]; /* telnet options: how far they are agreed */
    bool reported_lines;        /* the client knows of CTS, DSR and carrier */
    uint8_t command[RFC2217_COMMAND_MAX];
    size_t command_length;
};

/* A client has connected: 19200 baud, 8N1 (U7), DTR and RTS on. The first bytes for it are in `reply`. */
void rfc2217_begin(struct rfc2217 *port);

/* Take one byte of the client, any. Its reply, if any, is in `reply` until the next call and is to be sent as it is.
 * Returns what it meant. */
enum rfc2217_event rfc2217_receive(struct rfc2217 *port, uint8_t byte);

/* Write data for the client in telnet's form. `out` takes 2 * length bytes. Returns their number. */
size_t rfc2217_escape(const uint8_t *data, size_t length, uint8_t *out);

#endif
