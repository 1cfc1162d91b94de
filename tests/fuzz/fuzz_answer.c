/* SPDX-License-Identifier: MIT */
/* fuzz_answer.c: rkmctl and what comes back to it. Either a command to an emulator (client_control*.c), which gets any bytes in
 * any pieces (cut at `~`) and then the end of the connection (client_rpc.c); or any message shown as the answer of a unit
 * (client_answer.c). Whatever comes: an exit status of those there are, with --json nothing but JSON, and of a unit nothing that
 * a terminal acts on. First byte: bit 7 who is asked; the others which command, or which message; second byte: options. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/client_control.h"
#include "fuzz.h"

#define OUTPUT_MAX (1u << 20) /* bytes looked at */

enum { JSON = 1, UNIT = 2, LINE = 4, LIMIT = 8, HASTY = 16 };

bool __wrap_client_rpc_open(struct client_rpc *rpc, const char *path);

static struct fuzz answers; /* of the emulator */
static bool hasty;          /* it has gone before it was asked */
static int far_end = -1;    /* of the connection; -1: there is none */
static FILE *nowhere, *page;
static char output[OUTPUT_MAX + 1u];

/* ---- What rkmctl prints --------------------------------------------------------------------------------------------- */

static struct {
    FILE *out, *error;
} terminal;

static void open_page(void)
{
    if (!page) {
        page = fdopen(memfd_create("page", MFD_CLOEXEC), "w");
        nowhere = fopen("/dev/null", "we");
        FUZZ_CHECK(page && nowhere, "no page");
    }
    terminal.out = stdout;
    terminal.error = stderr;
    stdout = page;
    stderr = nowhere;
}

/* Returns the number of bytes printed; they are in `output`, ended by 0. */
static size_t close_page(void)
{
    stdout = terminal.out;
    stderr = terminal.error;
    fflush(page);
    ssize_t length = pread(fileno(page), output, OUTPUT_MAX, 0);
    rewind(page);
    FUZZ_CHECK(length >= 0 && ftruncate(fileno(page), 0) == 0, "%s", strerror(errno));
    output[length] = '\0';
    return (size_t)length;
}

static void check_json(size_t length)
{
    json_error_t error;
    size_t at = 0;
    FUZZ_CHECK(length < OUTPUT_MAX, "so much");
    for (char *end; (end = memchr(output + at, '\n', length - at)) != NULL; at = (size_t)(end - output) + 1u) {
        json_t *json = json_loadb(output + at, (size_t)(end - (output + at)), JSON_DECODE_ANY | JSON_ALLOW_NUL, &error);
        FUZZ_CHECK(json, "%s: %.*s", error.text, (int)(end - (output + at)), output + at);
        json_decref(json);
    }
    FUZZ_CHECK(at == length, "no end: %s", output + at);
}

/* ---- An emulator ---------------------------------------------------------------------------------------------------- */

static void answer_with(struct fuzz *fuzz, int fd)
{
    while (fuzz->left > 0) {
        size_t length;
        const uint8_t *piece = fuzz_until(fuzz, '~', &length);
        if (length > 0 && send(fd, piece, length, MSG_DONTWAIT | MSG_NOSIGNAL) < 0)
            break;
    }
    shutdown(fd, SHUT_WR);
}

/* Each piece is read by itself. */
bool __wrap_client_rpc_open(struct client_rpc *rpc, const char *path)
{
    int ends[2];
    snprintf(rpc->path, sizeof rpc->path, "%s", path);
    FUZZ_CHECK(far_end < 0 && socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) == 0, "%s", strerror(errno));
    rpc->fd = ends[0];
    far_end = ends[1];
    answer_with(&answers, far_end);
    if (hasty)
        shutdown(far_end, SHUT_RD); /* what is asked does not go out */
    return true;
}

/* No client holds the connection any more. */
static void check_hung_up(void)
{
    char request[1000];
    ssize_t length;
    if (far_end < 0)
        return;
    do
        length = recv(far_end, request, sizeof request, MSG_DONTWAIT);
    while (length > 0);
    FUZZ_CHECK(length == 0 || errno != EAGAIN, "the connection is still open");
    close(far_end);
    far_end = -1;
}

static void ask_emulator(uint8_t which, struct fuzz *fuzz)
{
    static const char *const asked[][4] = {
        {"state"}, {"state"}, {"di"}, {"di", "3=1"}, {"wait", "m1.position>=5"}, {"advance", "10ms"}, {"watch"}, {"events"},
        {"events", "step", "motor=1", "count=2"}, {"snapshot", "a"}, {"restore", "file=/a"}, {"fault"},
        {"fault", "inject", "drop"}, {"fault", "clear"}, {"plant"}, {"clock"}, {"trace", "start", "/a.csv"}, {"trace", "stop"},
        {"call", "units"}, {"shutdown"},
    };
    const char *const *words = asked[which % (sizeof asked / sizeof asked[0])];
    uint8_t options = fuzz_byte(fuzz);
    bool once = strcmp(words[0], "watch") == 0;
    struct client_job job = {
        .path = "emulator",
        .unit = options & UNIT ? "1" : NULL,
        .line = options & LINE ? 1 : -1,
        .limit = options & LIMIT ? "1s" : NULL,
        .json = options & JSON,
        .once = once,
        .words = words + 1,
    };
    while (job.count < 3 && words[1 + job.count])
        job.count++;
    answers = *fuzz;
    hasty = options & HASTY;
    open_page();
    enum exit_status status = client_control(&job, words[0]);
    size_t length = close_page();
    check_hung_up();
    FUZZ_CHECK(status <= STATUS_NO_ANSWER, "%d", (int)status);
    if (options & JSON)
        check_json(length);
}

/* ---- A unit --------------------------------------------------------------------------------------------------------- */

static void show_unit(uint8_t which, struct fuzz *fuzz)
{
    static enum exit_status (*const shows[])(const struct client_answer *answer) = {
        client_show_version, client_show_store, client_show_position, client_show_command, client_show_table,
        client_show_progress, client_show_raw,
    };
    uint8_t options = fuzz_byte(fuzz);
    struct client_answer answer = {
        .bytes = fuzz->at,
        .length = fuzz->left,
        .motor = (char)('0' + (options >> 1) % 5),
        .json = options & JSON,
    };
    open_page();
    enum exit_status status = shows[which % (sizeof shows / sizeof shows[0])](&answer);
    size_t length = close_page();
    FUZZ_CHECK(status <= STATUS_NO_ANSWER, "%d", (int)status);
    if (answer.json)
        check_json(length);
    for (size_t i = 0; i < length && !answer.json; i++)
        FUZZ_CHECK((output[i] >= ' ' && output[i] < 127) || output[i] == '\n', "%02x is printed", (unsigned)(uint8_t)output[i]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    uint8_t which = fuzz_byte(&fuzz);
    signal(SIGPIPE, SIG_IGN);
    if (which & 0x80)
        show_unit(which & 0x7f, &fuzz);
    else
        ask_emulator(which, &fuzz);
    return 0;
}
