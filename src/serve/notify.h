/* SPDX-License-Identifier: MIT */
/* notify.h: reports to the starter of the emulator that it is ready: the service manager over the socket $NOTIFY_SOCKET (the
 * protocol of sd_notify(3), which is documented and stable; the library would bring more than it saves), a parent process over
 * a file descriptor that it has passed on (--ready-fd). The caller ignores SIGPIPE. */
#ifndef RKM04_SERVE_NOTIFY_H
#define RKM04_SERVE_NOTIFY_H

#include <stdbool.h>

#define NOTIFY_FD_EXPECTED "the number of a file descriptor of yours, 3 or more, that is open for writing"

/* Read the argument of --ready-fd. To be called before the emulator opens files, which would take the numbers that are free. The
 * descriptor is then closed on exec. Returns it, or -1 if the text is no number from 3 up, or not open for writing; for the
 * message there is NOTIFY_FD_EXPECTED. */
int notify_fd_read(const char *text);

#define NOTIFY_WAIT_MS 300u /* how long to wait for a failure of the receiver; a reader may take longer */

/* Report that everything is ready: `text` to `fd` in one piece; then it is closed, so that who reads to the end has the text; and
 * READY=1 to the service manager if there is one, with `status` (one line for `systemctl status`; NULL: none).
 * fd: from notify_fd_read; -1: none. text: with line end.
 * Returns false if `fd` cannot take the text (reported); a reader that has gone, or reads later, is no failure. If the service
 * manager cannot be notified, this is only reported: the variable may be left over from a service further up. */
bool notify_ready(int fd, const char *text, const char *status);

/* Tell the service manager, if there is one, that the emulator is about to end. */
void notify_stopping(void);

#endif
