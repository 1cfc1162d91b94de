/* SPDX-License-Identifier: MIT */
#include "control_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <uv.h>

#include "line/line.h"

#define LINE_MAX_LENGTH (sizeof CONTROL_FILE_BEGIN + NET_NAME_SIZE + CONTROL_TOKEN_LENGTH + 2)

bool control_file_token(char token[CONTROL_TOKEN_LENGTH + 1])
{
    unsigned char random[CONTROL_TOKEN_LENGTH / 2];
    int error = uv_random(NULL, NULL, random, sizeof random, 0, NULL);
    if (error != 0) {
        log_error("the system gives no random bytes for a token: %s", uv_strerror(error));
        return false;
    }
    for (size_t i = 0; i < sizeof random; i++)
        snprintf(token + 2 * i, 3, "%02x", random[i]);
    return true;
}

bool control_file_is_token(const char token[CONTROL_TOKEN_LENGTH + 1], const char *text, size_t length)
{
    unsigned char differences = 0;
    if (length != CONTROL_TOKEN_LENGTH)
        return false;
    for (size_t i = 0; i < CONTROL_TOKEN_LENGTH; i++)
        differences |= (unsigned char)(token[i] ^ text[i]);
    return differences == 0;
}

/* A new file: not what is there, and not what a link leads to. */
static bool write_private(struct control_place *place, const char *line)
{
    size_t length = strlen(line);
    int fd = open(place->path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    bool made = fd >= 0 && control_place_record(place);
    errno = made ? ENOSPC : errno; /* of a file that is only half written */
    bool written = made && write(fd, line, (unsigned)length) == (ssize_t)length;
    int why = errno;
    if (fd >= 0)
        close(fd);
    errno = why;
    return written;
}

bool control_file_write(struct control_place *place, const char *path, const char *address,
                        const char token[CONTROL_TOKEN_LENGTH + 1])
{
    char line[LINE_MAX_LENGTH + 1];
    snprintf(line, sizeof line, CONTROL_FILE_BEGIN "%s %s\n", address, token);
    if (!control_place_claim(place, path))
        return false;
    if (write_private(place, line))
        return true;
    log_error("cannot write the control file %s: %s; choose another --control-file", path, strerror(errno));
    control_place_release(place);
    return false;
}
