/* SPDX-License-Identifier: MIT */
/* com_line.c: the serial end of a bus (line.h): a COM port with overlapped reads and writes, so that nothing waits for it.
 *
 * One read is always under way: of one byte if none waits, else of those that do, so it never waits for more than comes. What is
 * sent goes into `out`, and in one piece to the port when the piece before is out. The system signals the end of either; a thread
 * of its pool wakes the event loop then. */
#include <errno.h>
#include <uv.h>

#include "com.h"
#include "line/line.h"

#define IN_SIZE 4096u
#define OUT_SIZE 20480u /* as many as with a pty */

struct transfer {
    OVERLAPPED overlapped; /* its event is reset by who waits for it */
    HANDLE wait;
    bool pending;
};

struct line_device {
    HANDLE com;
    struct transfer read, write;
    struct line_poll *poll;    /* NULL: none */
    bool started;              /* readable() is wanted */
    bool failed;
    size_t at, length;         /* of what has been read, in `in` */
    size_t waiting, under_way; /* of what is sent: in `out`, in `wire` */
    uint8_t in[IN_SIZE], out[OUT_SIZE], wire[OUT_SIZE];
};

/* ---- Reading -------------------------------------------------------------------------------------------------------- */

/* How many bytes a read can take without waiting, at least one. */
static DWORD read_size(struct line_device *device)
{
    COMSTAT status;
    DWORD errors;
    if (!ClearCommError(device->com, &errors, &status) || status.cbInQue < 1)
        return 1;
    return status.cbInQue < IN_SIZE ? status.cbInQue : IN_SIZE;
}

/* Begin a read unless one is under way, and see whether it has come to its end. Returns false if it has not, or the port is
 * gone. */
static bool finish_read(struct line_device *device)
{
    DWORD length = 0;
    struct transfer *read = &device->read;
    if (!read->pending)
        read->pending = ReadFile(device->com, device->in, read_size(device), NULL, &read->overlapped) ||
                        GetLastError() == ERROR_IO_PENDING;
    device->failed = device->failed || !read->pending;
    if (!read->pending)
        return false;
    bool ended = GetOverlappedResult(device->com, &read->overlapped, &length, FALSE);
    if (!ended && GetLastError() == ERROR_IO_INCOMPLETE)
        return false;
    read->pending = false;
    device->failed = device->failed || (ended ? length == 0 : GetLastError() != ERROR_OPERATION_ABORTED);
    device->at = 0;
    device->length = length;
    return length > 0;
}

ssize_t line_read(struct line *line, uint8_t *bytes, size_t room)
{
    struct line_device *device = line->device;
    if (device->at == device->length && !finish_read(device)) {
        errno = ENODEV;
        return device->failed ? -1 : 0;
    }
    size_t length = device->length - device->at < room ? device->length - device->at : room;
    memcpy(bytes, device->in + device->at, length);
    device->at += length;
    return (ssize_t)length;
}

/* ---- Sending -------------------------------------------------------------------------------------------------------- */

static void pump(struct line_device *device)
{
    DWORD length = 0;
    struct transfer *write = &device->write;
    if (write->pending) {
        bool ended = GetOverlappedResult(device->com, &write->overlapped, &length, FALSE);
        if (!ended && GetLastError() == ERROR_IO_INCOMPLETE)
            return;
        write->pending = false;
        device->under_way = 0;
    }
    if (device->waiting == 0)
        return;
    memcpy(device->wire, device->out, device->waiting);
    device->under_way = device->waiting;
    device->waiting = 0;
    write->pending = WriteFile(device->com, device->wire, (DWORD)device->under_way, NULL, &write->overlapped) ||
                     GetLastError() == ERROR_IO_PENDING;
    if (!write->pending)
        device->under_way = 0; /* reading reports it */
}

size_t line_write(struct line *line, const uint8_t *bytes, size_t length)
{
    struct line_device *device = line->device;
    if (line->toggles && !line->raised && length > 0)
        line->raised = EscapeCommFunction(device->com, SETRTS);
    size_t taken = length < OUT_SIZE - device->waiting ? length : OUT_SIZE - device->waiting;
    memcpy(device->out + device->waiting, bytes, taken);
    device->waiting += taken;
    pump(device);
    line->dropped += length - taken;
    return length - taken;
}

bool line_serial_lower(struct line *line)
{
    COMSTAT status = {0};
    DWORD errors;
    struct line_device *device = line->device;
    pump(device);
    if (device->write.pending || (ClearCommError(device->com, &errors, &status) && status.cbOutQue > 0))
        return false;
    EscapeCommFunction(device->com, CLRRTS);
    line->raised = false;
    return true;
}

/* ---- The event loop ------------------------------------------------------------------------------------------------- */

static void CALLBACK on_signal(void *context, BOOLEAN timed_out)
{
    struct line_device *device = context;
    (void)timed_out;
    uv_async_send(&device->poll->handle.async);
}

static void on_wake(uv_async_t *handle)
{
    struct line_poll *poll = handle->data;
    struct line_device *device = poll->open ? poll->line->device : NULL;
    if (!device)
        return;
    pump(device);
    if (device->started && (device->at < device->length || finish_read(device) || device->failed))
        poll->readable(poll->context);
    bool more = device->at < device->length || !device->read.pending;
    if (poll->open && device->started && more && !device->failed)
        uv_async_send(&poll->handle.async);
}

int line_poll_start(struct line_poll *poll)
{
    if (!poll->open)
        return UV_EINVAL;
    poll->line->device->started = true;
    return uv_async_send(&poll->handle.async);
}

void line_poll_stop(struct line_poll *poll)
{
    if (poll->open)
        poll->line->device->started = false;
}

int line_poll_open(struct line_poll *poll, uv_loop_t *loop, struct line *line)
{
    struct line_device *device = line->device;
    struct transfer *each[] = {&device->read, &device->write};
    poll->line = line;
    poll->handle.async.data = poll;
    int error = uv_async_init(loop, &poll->handle.async, on_wake);
    if (error != 0)
        return error;
    poll->open = true;
    device->poll = poll;
    for (size_t i = 0; i < 2 && error == 0; i++)
        if (!RegisterWaitForSingleObject(&each[i]->wait, each[i]->overlapped.hEvent, on_signal, device, INFINITE,
                                         WT_EXECUTEINWAITTHREAD))
            error = UV_ENOMEM;
    if (error == 0)
        return line_poll_start(poll);
    line_poll_close(poll);
    return error;
}

static void on_closed(uv_handle_t *handle)
{
    struct line_poll *poll = handle->data;
    if (poll->closed)
        poll->closed(poll->context);
}

/* Afterwards no thread of the pool is in on_signal(). */
static void stop_waiting(struct transfer *transfer)
{
    if (transfer->wait)
        UnregisterWaitEx(transfer->wait, INVALID_HANDLE_VALUE);
    transfer->wait = NULL;
}

void line_poll_close(struct line_poll *poll)
{
    if (!poll->open)
        return;
    struct line_device *device = poll->line->device;
    poll->open = device->started = false;
    stop_waiting(&device->read);
    stop_waiting(&device->write);
    uv_close((uv_handle_t *)&poll->handle.async, on_closed);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

/* Is it a port with a wire? Not one of a pair of com0com, nor one of Wine that leads to a pty. */
static bool is_wire(HANDLE com, const char *name)
{
    char device[256] = "";
    DWORD lines;
    const char *slash = strrchr(name, '/'), *backslash = strrchr(name, '\\');
    const char *last = slash > backslash ? slash : backslash;
    QueryDosDeviceA(last ? last + 1 : name, device, sizeof device);
    return strstr(device, "com0com") == NULL && GetCommModemStatus(com, &lines);
}

static bool set_up(struct line_device *device, const char *name)
{
    COMMTIMEOUTS timeouts = {0}; /* a read ends when it has all, a write when all is out */
    device->read.overlapped.hEvent = CreateEventA(NULL, FALSE, FALSE, NULL);
    device->write.overlapped.hEvent = CreateEventA(NULL, FALSE, FALSE, NULL);
    if (!device->read.overlapped.hEvent || !device->write.overlapped.hEvent) {
        log_error("out of memory");
        return false;
    }
    if (com_set_up(device->com, CBR_19200) && SetCommTimeouts(device->com, &timeouts))
        return true;
    log_error("%s is not a serial device that takes 19200 baud, 8N1: expected one like COM3", name);
    return false;
}

static bool set_rts(struct line *line, const char *name, enum line_rts rts)
{
    line->is_wire = is_wire(line->device->com, name);
    if (rts == LINE_RTS_TOGGLES) {
        line->toggles = EscapeCommFunction(line->device->com, CLRRTS);
        if (!line->toggles)
            log_error("--rts toggles: %s has no RTS", name);
        return line->toggles;
    }
    if (line->is_wire)
        log_at(0, "the adapter of %s has to switch between sending and receiving; if it needs RTS for that, give --rts toggles",
               name);
    return true;
}

bool line_serial_open(struct line *line, const char *path, enum line_rts rts)
{
    const char *why;
    line_none(line);
    HANDLE com = com_open(path, FILE_FLAG_OVERLAPPED, &why);
    if (com == INVALID_HANDLE_VALUE) {
        log_error("cannot open %s: %s", path, why);
        return false;
    }
    line->device = calloc(1, sizeof *line->device);
    if (!line->device) {
        log_error("out of memory");
        CloseHandle(com);
        return false;
    }
    line->device->com = com;
    line->fd = 0; /* it is open; the number stands for nothing */
    line->clients = 1;
    if (set_up(line->device, path) && set_rts(line, path, rts))
        return true;
    line_close(line);
    return false;
}

void line_set_baud(const struct line *line, unsigned baud)
{
    com_set_up(line->device->com, baud);
}

/* Give up what is under way: the system must not write to the memory any more. */
static void end_transfer(struct line_device *device, struct transfer *transfer)
{
    DWORD length;
    if (transfer->pending && CancelIoEx(device->com, &transfer->overlapped))
        GetOverlappedResult(device->com, &transfer->overlapped, &length, TRUE);
    if (transfer->overlapped.hEvent)
        CloseHandle(transfer->overlapped.hEvent);
}

void line_serial_restore(struct line *line)
{
    struct line_device *device = line->device;
    if (!device)
        return;
    if (line->raised)
        EscapeCommFunction(device->com, CLRRTS);
    line->raised = false;
    end_transfer(device, &device->read);
    end_transfer(device, &device->write);
    CloseHandle(device->com);
    free(device);
    line->device = NULL;
}

void line_none(struct line *line)
{
    *line = (struct line){.fd = -1, .slave = -1, .mark = -1};
}

void line_close(struct line *line)
{
    line_serial_restore(line);
    line->fd = -1;
}
