/* SPDX-License-Identifier: MIT */
/* line_settings.h: the speed and character format that a client has set, and which bytes arrive when the two ends use different
 * settings (U7).
 *
 * A pty stores the speed without applying it, so bytes pass whatever the client has set. The user is informed
 * (line_settings_changed()); with --strict-line every byte passes through a struct line_receiver, which draws the bits as the
 * sender sends them and samples them as the receiver does. */
#ifndef RKM04_LINE_SETTINGS_H
#define RKM04_LINE_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct line_settings {
    uint32_t baud;       /* 0: hung up, nothing is sent or received */
    uint8_t data_bits;   /* 5..8 */
    char parity;         /* 'N', 'E', 'O', 'M' (mark), 'S' (space) */
    uint8_t stop_halves; /* 2, 3 (one and a half), 4 */
};

#define LINE_SETTINGS_TEXT_MAX 24
#define LINE_SETTINGS_CHANGE_MAX 80

extern const struct line_settings line_settings_unit; /* of an RKM04: 19200 8N1 */

/* Read the settings of a terminal. With the master of a pty they are the client's. Speeds of any number are taken. Linux gives
 * a pty 8 data bits and no parity, whatever the client asks for. Returns false if `fd` is no terminal. */
bool line_settings_read(int fd, struct line_settings *settings);

/* The settings as RFC 2217 brings them (net_port.h): stop_bits 1, 2; 3 stands for 1.5. */
struct line_settings line_settings_of(uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits);

bool line_settings_equal(struct line_settings a, struct line_settings b);

/* "19200 8N1", "9600 7E1.5". Returns `text`. */
char *line_settings_text(struct line_settings settings, char text[LINE_SETTINGS_TEXT_MAX]);

/* Has the client changed its settings? `unit`: those of the unit. `known`: what was reported last, or `unit` when a client comes;
 * it becomes `now`. Returns true on a change; `change` is then "client is 9600 8N1, unit is 19200 8N1", or "client is 19200
 * 8N1, as the unit is". A client sets the line up after it has opened it: look again whenever bytes come. */
bool line_settings_changed(struct line_settings *known, struct line_settings now, struct line_settings unit,
                           char change[LINE_SETTINGS_CHANGE_MAX]);

/* Set the speed of a terminal, if it is one. */
void line_settings_set_baud(int fd, unsigned baud);

/* ---- Bytes received -------------------------------------------------------------------------------------------------- */

#define LINE_RECEIVER_MAX 8            /* bytes received for one byte sent, at most */
#define LINE_RECEIVER_BAUD_MAX 2000000 /* faster ends are taken to be as fast as this: nothing of them is received anyway */

struct line_received {
    uint64_t tick; /* in which its start bit began */
    uint8_t byte;
};

/* A receiver that listens to a sender. Plain data. Who may read it: framing_errors. */
struct line_receiver {
    struct line_settings from, to;
    bool keeps_bad;          /* characters with a wrong stop bit are received too, not lost */
    uint8_t phase;           /* waits for the line to be 1, for a start bit, or is within a character */
    uint8_t bit;             /* number of the next sample: 0 in the start bit */
    uint8_t bits;            /* of the character, as far as sampled */
    uint64_t origin;         /* tick at which the next three are 0: a byte that set out while the line was idle */
    uint64_t time;           /* up to which the line has been drawn; units of 1 / (2 * from.baud * to.baud) s, as the next two */
    uint64_t start;          /* when the character under way began */
    uint64_t sample;         /* when the next sample is taken */
    uint64_t framing_errors; /* characters with a wrong stop bit */
};

/* Begin to listen at tick 0, the line idle. `keeps_bad`: false for the unit, which drops such a character; true for a client on
 * Linux, whose tty hands it on unless INPCK is set. Parity is not checked, for the same reason. */
void line_receiver_begin(struct line_receiver *receiver, struct line_settings from, struct line_settings to, bool keeps_bad);

/* The sender sends `byte` at `tick`, or as soon as the one before is out; until then the line is idle. Returns the number of
 * bytes received by the end of it: what is under way then ends with the next byte or in silence. A byte received may have begun
 * before `tick`, and after it if bytes before are still going out. */
size_t line_receiver_byte(struct line_receiver *receiver, uint8_t byte, uint64_t tick,
                          struct line_received received[LINE_RECEIVER_MAX]);

/* The sender has no more to send for now: what is under way is received to its end, the line being idle. Returns the number of
 * bytes received, 0 or 1. */
size_t line_receiver_silence(struct line_receiver *receiver, struct line_received received[LINE_RECEIVER_MAX]);

#endif
