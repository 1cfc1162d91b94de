/* SPDX-License-Identifier: MIT */
#include "client_rpc.h"

#include <err.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client_port.h"
#include "client_socket.h"

#define LINE_MAX_BYTES (64u << 20) /* longest object believed to be an answer */
#define ROOM_FIRST 65536u
#define ENTRY_MS 10000 /* for the answer to the token */
#define SEND_MS 10000  /* for a request to be taken */
#define NOTE_MS 5000   /* then a person at the terminal is informed */

/* ---- The default ------------------------------------------------------------------------------------------------------ */

/* As link_path.c finds the default link, of line 0: the emulator may have had no use for the first folder. */
static bool default_path(char found[PATH_MAX])
{
    char folder[PATH_MAX], first[PATH_MAX] = "";
    for (unsigned i = 0; client_socket_folder(i, folder); i++) {
        if (snprintf(found, PATH_MAX, "%s/bus0.control", folder) >= PATH_MAX)
            return false;
        if (access(found, F_OK) == 0)
            return true;
        if (first[0] == '\0')
            strcpy(first, found);
    }
    strcpy(found, first);
    return first[0] != '\0';
}

bool client_rpc_path(const char *path, char found[PATH_MAX])
{
    if (path == NULL)
        path = getenv("RKM04_CONTROL");
    if (path != NULL && path[0] != '\0' ? snprintf(found, PATH_MAX, "%s", path) < PATH_MAX : default_path(found))
        return true;
    warnx("the path of the control socket is too long");
    return false;
}

/* ---- The connection --------------------------------------------------------------------------------------------------- */

/* Report what is wrong with the connection, now or when the caller likes to. */
static void report(struct client_rpc *rpc, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void report(struct client_rpc *rpc, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(rpc->trouble, sizeof rpc->trouble, format, arguments);
    va_end(arguments);
    if (!rpc->quiet)
        warnx("%s", rpc->trouble);
}

static const char *connect_advice(const char *path, bool is_tcp, int error)
{
    struct stat found;
    if (!is_tcp && stat(path, &found) == 0 && !S_ISSOCK(found.st_mode))
        return "; expected the control socket of `rkm04 serve', by default LINK.control";
    switch (error) {
    case ENOENT:
        return "; is `rkm04 serve' running? --control PATH names another socket";
    case ECONNREFUSED:
        return "; the emulator that made it has ended";
    case EACCES:
        return "; it belongs to another user";
    case ENAMETOOLONG:
        return "; the name of a socket, after the last /, has at most 80 characters";
    default:
        return "";
    }
}

/* What a control file has (docs/CONTROL.md). */
struct entrance {
    char address[80], token[65];
    bool foreign; /* the file is another user's */
};

/* Returns false if it is no control file. */
static bool read_entrance(struct entrance *entrance, const char *path)
{
    char line[160] = "";
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    ssize_t length = fd >= 0 ? read(fd, line, sizeof line - 1) : -1;
    bool ok = length > 0 && sscanf(line, "tcp:%79s %64s", entrance->address, entrance->token) == 2;
    entrance->foreign = ok && client_socket_is_foreign_file(fd);
    if (fd >= 0)
        close(fd);
    return ok;
}

/* Show the token. Returns false if that did not let us in (reported). */
static bool authenticate(struct client_rpc *rpc, const char *token)
{
    json_t *json;
    enum client_rpc_outcome outcome =
        client_rpc_call(rpc, "authenticate", json_pack("{s:s}", "token", token), ENTRY_MS, &json);
    const char *message = json_string_value(json_object_get(json, "message"));
    if (outcome == CLIENT_RPC_REFUSED)
        report(rpc, "%s: the emulator refuses: %s", rpc->path, message != NULL ? message : "");
    else if (outcome == CLIENT_RPC_NOTHING)
        report(rpc, "%s: no answer from the emulator", rpc->path);
    json_decref(json);
    return outcome == CLIENT_RPC_RESULT;
}

bool client_rpc_open(struct client_rpc *rpc, const char *path)
{
    const char *chosen = path != NULL ? path : getenv("RKM04_CONTROL");
    struct entrance entrance;
    if (!client_rpc_path(path, rpc->path))
        return false;
    const bool is_named = chosen != NULL && chosen[0] != '\0', is_tcp = read_entrance(&entrance, rpc->path);
    rpc->fd = -1;
    if (!is_tcp || is_named || !entrance.foreign)
        rpc->fd = is_tcp ? client_socket_open_tcp(entrance.address) : client_socket_open(rpc->path);
    int error = errno;
    bool is_foreign = !is_named && (is_tcp ? entrance.foreign : rpc->fd >= 0 && client_socket_is_foreign(rpc->fd));
    if (is_foreign)
        report(rpc, "%s: it belongs to another user's emulator; to use it, name it: --control PATH", rpc->path);
    else if (rpc->fd < 0)
        report(rpc, "cannot connect to %s: %s%s", rpc->path, strerror(error), connect_advice(rpc->path, is_tcp, error));
    else if (!is_tcp || authenticate(rpc, entrance.token))
        return true;
    if (rpc->fd >= 0)
        client_rpc_close(rpc);
    return false;
}

void client_rpc_close(struct client_rpc *rpc)
{
    client_socket_close(rpc->fd);
    free(rpc->buffer);
    rpc->buffer = NULL;
    rpc->begin = rpc->length = rpc->room = 0;
}

/* ---- Patience --------------------------------------------------------------------------------------------------------- */

/* How long something is waited for: times of client_now(). */
struct patience {
    uint64_t end, note; /* UINT64_MAX: none */
};

/* timeout_ms: CLIENT_RPC_FOREVER: no limit. */
static struct patience begin_patience(int timeout_ms)
{
    const uint64_t now = client_now();
    return (struct patience){timeout_ms < 0 ? UINT64_MAX : now + (uint64_t)timeout_ms * 1000u, UINT64_MAX};
}

/* The same for one request; if a person watches, with a note. */
static struct patience begin_request(const struct client_rpc *rpc, int timeout_ms)
{
    struct patience patience = begin_patience(timeout_ms);
    if (!rpc->quiet && isatty(STDERR_FILENO))
        patience.note = client_now() + NOTE_MS * 1000u;
    return patience;
}

/* How long to wait next, in ms; 0: the time is over. */
static int next_wait(const struct client_rpc *rpc, struct patience *patience)
{
    const uint64_t now = client_now();
    if (now >= patience->note && now < patience->end) {
        warnx("no answer from %s yet; Ctrl-C ends the wait, --timeout MS limits it", rpc->path);
        patience->note = UINT64_MAX;
    }
    const uint64_t end = patience->note < patience->end ? patience->note : patience->end;
    if (end == UINT64_MAX)
        return CLIENT_RPC_FOREVER;
    return now < end ? (int)((end - now + 999u) / 1000u) : 0;
}

/* ---- What goes -------------------------------------------------------------------------------------------------------- */

/* Returns CLIENT_RPC_RESULT if all has gone. */
static enum client_rpc_outcome write_all(struct client_rpc *rpc, const char *bytes, size_t length, struct patience *patience)
{
    while (length > 0) {
        ssize_t done = client_socket_write(rpc->fd, bytes, length);
        if (done >= 0) {
            bytes += done;
            length -= (size_t)done;
        } else if (errno == EAGAIN) {
            const int left = next_wait(rpc, patience);
            if (left == 0)
                return CLIENT_RPC_NOTHING;
            client_socket_wait_room(rpc->fd, left);
        } else if (errno != EINTR) {
            report(rpc, "lost the connection to the emulator at %s: %s", rpc->path, strerror(errno));
            return CLIENT_RPC_LOST;
        }
    }
    return CLIENT_RPC_RESULT;
}

static enum client_rpc_outcome send_request(struct client_rpc *rpc, const char *method, json_t *params, struct patience *patience)
{
    json_t *request = json_pack("{s:s, s:I, s:s, s:o*}", "jsonrpc", "2.0", "id", ++rpc->id, "method", method, "params", params);
    char *text = request != NULL ? json_dumps(request, JSON_COMPACT) : NULL;
    size_t length = text != NULL ? strlen(text) : 0;
    if (text != NULL)
        text[length] = '\n'; /* in place of the end */
    else
        report(rpc, "%s", strerror(ENOMEM));
    enum client_rpc_outcome outcome = text != NULL ? write_all(rpc, text, length + 1, patience) : CLIENT_RPC_LOST;
    free(text);
    json_decref(request);
    return outcome;
}

bool client_rpc_send(struct client_rpc *rpc, const char *method, json_t *params)
{
    struct patience patience = begin_request(rpc, SEND_MS);
    enum client_rpc_outcome outcome = send_request(rpc, method, params, &patience);
    if (outcome == CLIENT_RPC_NOTHING)
        report(rpc, "the emulator at %s takes no requests", rpc->path);
    return outcome == CLIENT_RPC_RESULT;
}

/* ---- What comes ------------------------------------------------------------------------------------------------------- */

/* The next whole line in the buffer, ended by 0; NULL: none yet. */
static char *next_line(struct client_rpc *rpc)
{
    char *line = rpc->length > 0 ? rpc->buffer + rpc->begin : NULL;
    char *end = line != NULL ? memchr(line, '\n', rpc->length) : NULL;
    if (end == NULL)
        return NULL;
    *end = '\0';
    size_t taken = (size_t)(end - line) + 1;
    rpc->begin += taken;
    rpc->length -= taken;
    return line;
}

/* Make room after what is there. */
static bool make_room(struct client_rpc *rpc)
{
    if (rpc->length > 0 && rpc->begin > 0)
        memmove(rpc->buffer, rpc->buffer + rpc->begin, rpc->length);
    rpc->begin = 0;
    if (rpc->length < rpc->room)
        return true;
    size_t room = rpc->room > 0 ? 2 * rpc->room : ROOM_FIRST;
    char *buffer = room <= LINE_MAX_BYTES ? realloc(rpc->buffer, room) : NULL;
    if (buffer == NULL)
        return false;
    rpc->buffer = buffer;
    rpc->room = room;
    return true;
}

/* Read what there is, waiting for it up to `timeout_ms`. Returns CLIENT_RPC_RESULT if something came. */
static enum client_rpc_outcome read_bytes(struct client_rpc *rpc, int timeout_ms)
{
    if (!client_socket_wait(rpc->fd, timeout_ms))
        return CLIENT_RPC_NOTHING;
    if (!make_room(rpc)) {
        report(rpc, "%s does not speak JSON-RPC: expected the control socket of `rkm04 serve'", rpc->path);
        return CLIENT_RPC_LOST;
    }
    ssize_t length = client_socket_read(rpc->fd, rpc->buffer + rpc->length, rpc->room - rpc->length);
    if (length < 0 && (errno == EINTR || errno == EAGAIN))
        return CLIENT_RPC_NOTHING;
    if (length <= 0) {
        report(rpc, "the emulator at %s has ended the connection", rpc->path);
        return CLIENT_RPC_LOST;
    }
    rpc->length += (size_t)length;
    return CLIENT_RPC_RESULT;
}

/* What an object lacks of what an emulator sends; NULL: nothing. */
static const char *find_missing(const json_t *object, bool ours)
{
    const json_t *error = json_object_get(object, "error"), *result = json_object_get(object, "result");
    if (json_is_string(json_object_get(object, "method")))
        return json_is_object(json_object_get(object, "params")) ? NULL : "expected an object as params";
    return !ours || json_is_object(error != NULL ? error : result) ? NULL : "expected an object as result or error";
}

/* Check one object. Returns true if it is the answer to the last request, or an error to no request: *outcome and *json. */
static bool handle_line(struct client_rpc *rpc, const char *line, enum client_rpc_outcome *outcome, json_t **json, bool *event)
{
    json_error_t wrong;
    json_t *object = json_loads(line, 0, &wrong);
    const json_t *id = json_object_get(object, "id");
    const char *method = json_string_value(json_object_get(object, "method"));
    json_t *error = json_object_get(object, "error"), *result = json_object_get(object, "result");
    bool ours = json_is_integer(id) ? json_integer_value(id) == rpc->id : json_is_null(id) && error != NULL;
    const char *lacking = object == NULL            ? wrong.text
                          : json_is_object(object) ? find_missing(object, ours)
                                                   : "expected an object";
    if (lacking != NULL) {
        report(rpc, "%s does not speak JSON-RPC: %s", rpc->path, lacking);
        *outcome = CLIENT_RPC_LOST;
        ours = true;
    } else if (method != NULL) {
        *event = true;
        ours = false;
        if (rpc->notified != NULL)
            rpc->notified(rpc->context, method, json_object_get(object, "params"));
    } else if (ours) {
        *outcome = error != NULL ? CLIENT_RPC_REFUSED : CLIENT_RPC_RESULT;
        *json = json_incref(error != NULL ? error : result);
    }
    json_decref(object);
    return ours;
}

/* Take what comes: until the answer is there or, with `any`, an event. */
static enum client_rpc_outcome receive_until(struct client_rpc *rpc, struct patience *patience, json_t **json, bool any)
{
    *json = NULL;
    for (;;) {
        enum client_rpc_outcome outcome = CLIENT_RPC_NOTHING;
        bool event = false;
        for (char *line = next_line(rpc); line != NULL; line = next_line(rpc)) {
            if (handle_line(rpc, line, &outcome, json, &event))
                return outcome;
        }
        if (event && any)
            return CLIENT_RPC_RESULT;
        const int left = next_wait(rpc, patience);
        outcome = read_bytes(rpc, left);
        if (outcome == CLIENT_RPC_LOST || (outcome == CLIENT_RPC_NOTHING && left == 0))
            return outcome;
    }
}

enum client_rpc_outcome client_rpc_receive(struct client_rpc *rpc, int timeout_ms, json_t **json)
{
    struct patience patience = begin_patience(timeout_ms);
    return receive_until(rpc, &patience, json, false);
}

enum client_rpc_outcome client_rpc_listen(struct client_rpc *rpc, int timeout_ms, json_t **json)
{
    struct patience patience = begin_patience(timeout_ms);
    return receive_until(rpc, &patience, json, true);
}

enum client_rpc_outcome client_rpc_call(struct client_rpc *rpc, const char *method, json_t *params, int timeout_ms,
                                        json_t **json)
{
    struct patience patience = begin_request(rpc, timeout_ms);
    *json = NULL;
    enum client_rpc_outcome outcome = send_request(rpc, method, params, &patience);
    return outcome == CLIENT_RPC_RESULT ? receive_until(rpc, &patience, json, false) : outcome;
}

bool client_rpc_ends(struct client_rpc *rpc, int timeout_ms)
{
    struct patience patience = begin_patience(timeout_ms);
    char rest[1024];
    for (;;) {
        const int left = next_wait(rpc, &patience);
        if (client_socket_wait(rpc->fd, left)) {
            ssize_t length = client_socket_read(rpc->fd, rest, sizeof rest);
            if (length == 0 || (length < 0 && errno != EINTR && errno != EAGAIN))
                return true;
        }
        if (left == 0)
            return false;
    }
}
