/* SPDX-License-Identifier: MIT */
/* line.h: the ways in and out of the process; the face of the room.
 *
 *     line (here)                  the serial end: a pty of its own (line_pty.c) or a device (line_serial.c)
 *     line_poll, wake_timer        when it can be read, and when it is time, for the event loop
 *     line_settings                what a client has set, and how bytes of another speed are received
 *     net_port, rfc2217            TCP, raw or with the settings of a port
 *     service_port                 TCP for many clients
 *     net_address, net_listen      where it listens
 *     link_path, lock_file         the link to the pty, and who owns it
 *     wine_link                    a COM port of Wine that leads there
 *     flash_file                   the flash of a unit in a file
 *     log, delivery                the log of the program, and the thread that writes it to a slow reader
 *
 * Knows bytes, descriptors and paths; nothing of units and virtual time but the tick of a byte. */
#ifndef RKM04_LINE_H
#define RKM04_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <uv.h>

/* What line_pty.c reports about clients. */
enum line_event {
    LINE_DETACHED, /* the last client has closed the line */
    LINE_ATTACHED, /* the first client has opened it */
    LINE_SHARED,   /* one more client has opened it */
    LINE_FAILED    /* there is no client, and no client can open the pty any more: it is to be closed, but not within the call */
};
typedef void line_notify(void *context, enum line_event event);

/* Who opens and closes ptys, for all of a process: the system gives a user few such watches. */
struct line_watch {
    int fd;             /* readable: line_watch_update() is due; -1: not open */
    int notices;        /* inotify; -1: there is none for us */
    int timer;          /* goes off regularly while `looking`; -1: there is none */
    bool looking;       /* there is a line that inotify does not watch, or on which it is not certain who is there */
    struct line *lines; /* those being watched */
};

/* Who turns the driver of an RS485 device on while units send. */
enum line_rts {
    LINE_RTS_DRIVER, /* the kernel's driver if it can (TIOCSRS485), else the adapter itself */
    LINE_RTS_TOGGLES /* we do: RTS is on while bytes go out */
};

struct line {
    int fd;                   /* for bytes: master of the pty, or the device; non-blocking; -1: neither */
    int slave;                /* held open, so that the master never sees a hang-up; -1: a device, or a client keeps us out */
    struct line_watch *watch; /* NULL: a device */
    struct line *next;        /* being watched */
    int mark;                 /* inotify's, for this pty; -1: none, it is checked now and then */
    bool left;                /* by a client: its settings have not been checked yet */
    bool doubtful;            /* notices were lost, or came too fast: `clients` may be wrong */
    bool certain;             /* one of `clients` is there for certain: a client that comes now is another one */
    unsigned looks;           /* at this line that are still needed to be certain */
    unsigned closings;        /* notices of clients that have closed it, not counted yet */
    unsigned clients;         /* have the line open; a device counts as one */
    uint64_t dropped;         /* bytes without a client, or that a client did not read in time */
    char path[64];            /* of the pty's slave; "" for a device */
    bool is_wire;             /* a device with a real line: bytes take their time there */
    bool toggles, raised;     /* LINE_RTS_TOGGLES, and RTS is on */
    struct line_device *device; /* what the system knows of it; NULL: nothing */
    line_notify *notify;
    void *context;
};

/* Begin to watch; end it. Without inotify (its watches or instances are used up) the lines are checked ten times a second: who
 * comes and goes between two looks is not noticed then. Failures are reported. Returns false if it did not work. */
bool line_watch_open(struct line_watch *watch);
void line_watch_close(struct line_watch *watch);

/* Follow what clients of any line did since the last call: count them, discard what the last one left unread, make a line raw
 * that it left cooked. */
void line_watch_update(struct line_watch *watch);

/* A line that is not open. */
void line_none(struct line *line);

/* Make a pty, raw from the start, and watch it. Failures are reported. Returns false if it did not work. */
bool line_pty_open(struct line *line, struct line_watch *watch, line_notify *notify, void *context);

/* Bytes came although no client is known: look who is there. */
void line_pty_recount(struct line *line);

/* Use the serial device or pty `path`: raw, 19200 baud, 8N1 (U7). Failures are reported. Returns false if it did not work. */
bool line_serial_open(struct line *line, const char *path, enum line_rts rts);

/* Set another speed, if it has one. */
void line_set_baud(const struct line *line, unsigned baud);

/* RTS is on and everything has gone out by now, as far as the caller knows: turn it off. Returns false if the device is still
 * sending: try again a little later. */
bool line_serial_lower(struct line *line);

/* Give the driver's own settings back, and forget the device. */
void line_serial_restore(struct line *line);

/* Read up to `room` bytes. Returns their number; 0: none now; -1: the line is gone (errno says why; 0: hung up). */
ssize_t line_read(struct line *line, uint8_t *bytes, size_t room);

/* Send. Bytes without a client and bytes that do not fit are dropped and counted: a line has no memory. Never blocks.
 * Returns the number of dropped ones. */
size_t line_write(struct line *line, const uint8_t *bytes, size_t length);

void line_close(struct line *line);

/* ---- The event loop -------------------------------------------------------------------------------------------------- */

/* Tells the event loop when a line can be read. */
struct line_poll {
    void (*readable)(void *context); /* bytes wait, or the line is gone */
    void (*closed)(void *context);   /* NULL: not to be called */
    void *context;

    /* Inside. */
    struct line *line;
    bool open;
    union {
        uv_poll_t poll;
        uv_async_t async;
    } handle;
};

/* Prepare for an open line and start. readable(), closed() and context are set. Returns 0, or an error of libuv: then it is not
 * open. */
int line_poll_open(struct line_poll *poll, uv_loop_t *loop, struct line *line);

/* Start again, or stop, to call readable() while there is something to read. Returns 0 or an error of libuv; one that is not open
 * cannot be started. */
int line_poll_start(struct line_poll *poll);
void line_poll_stop(struct line_poll *poll);

/* Close it, before the line is closed; closed() is called in a later turn of the loop. One that is not open is left alone. */
void line_poll_close(struct line_poll *poll);

/* The other parts that rooms above use. */
#include "delivery.h"
#include "flash_file.h"
#include "line_settings.h"
#include "link_path.h"
#include "lock_file.h"
#include "log.h"
#include "net_listen.h"
#include "net_port.h"
#include "service_port.h"
#include "wake_timer.h"
#include "wine_link.h"

#endif
