/* line.h: the emulator's end of the serial line: a pty of its own (line_pty.c) or a device that is there (line_serial.c). */
#ifndef RKM04_HOST_LINE_H
#define RKM04_HOST_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <termios.h>

/* What line_pty.c tells about clients. */
enum line_news {
    LINE_DETACHED, /* the last client has closed the line */
    LINE_ATTACHED, /* the first client has opened it */
    LINE_SHARED,   /* one more client has opened it */
    LINE_FAILED    /* the pty is lost (reported) */
};
typedef void line_tell(void *context, enum line_news news);

struct line {
    int fd;           /* for bytes: master of the pty, or the device; non-blocking */
    int notices;      /* inotify: clients open and close the pty; -1: a device */
    int slave;        /* held open, so that the master never sees a hang-up; -1: a device */
    unsigned clients; /* have the line open; a device counts as one */
    uint64_t dropped; /* bytes that nobody was there for, or that a client did not read in time */
    char path[64];    /* of the pty's slave; "" for a device */
    line_tell *tell;
    void *context;
};

/* Make a pty, raw from the start. Failures are reported. Returns false if it did not work. */
bool line_pty_open(struct line *line, line_tell *tell, void *context);

/* Follow what clients did since the last call: count them, make the line raw again, forget what the last one left unread. */
void line_pty_notice(struct line *line);

/* Bytes came although no client is known: look who is there. */
void line_pty_count_again(struct line *line);

/* Use the serial device or pty `path`: raw, 19200 baud, 8N1 (U7). Failures are reported. Returns false if it did not work. */
bool line_serial_open(struct line *line, const char *path);

/* Read up to `room` bytes. Returns their number; 0: none now; -1: the line is gone (errno says why; 0: hung up). */
ssize_t line_read(struct line *line, uint8_t *bytes, size_t room);

/* Send. Bytes for nobody and bytes that do not fit are dropped and counted: a line has no memory. Never blocks.
 * Returns the number of dropped ones. */
size_t line_write(struct line *line, const uint8_t *bytes, size_t length);

void line_close(struct line *line);

/* Settings of a raw line with 8N1. Leaves speed and control characters alone. Returns false if nothing had to change. */
bool line_make_raw(struct termios *settings);

#endif
