/* SPDX-License-Identifier: MIT */
#include "log.h"

#include <inttypes.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "text/text.h"

#include "delivery.h"

#define LINE_SIZE 8192u /* more than a path and what is said about it; the rest of a longer line is cut */

static const char *program = "rkm04 serve: ";

static struct {
    bool queued;        /* lines go into the queue */
    bool running;       /* the thread */
    pthread_mutex_t lock;
    pthread_cond_t news, done;
    size_t start, end;  /* of what waits, in `text` */
    uint64_t dropped;   /* lines after it for which there was no room */
    bool writing;
    char text[LOG_QUEUE_SIZE];
} queue = {.lock = PTHREAD_MUTEX_INITIALIZER, .news = PTHREAD_COND_INITIALIZER, .done = PTHREAD_COND_INITIALIZER};

/* ---- The thread ----------------------------------------------------------------------------------------------------- */

/* Take whole lines, as many as a pipe takes in one piece, or one that is longer. Returns their length; 0: there are none. */
static size_t take_lines(char *lines)
{
    size_t length = 0, held = queue.end - queue.start;
    const char *from = queue.text + queue.start, *end;
    while (length < held && (end = memchr(from + length, '\n', held - length))) {
        size_t next = (size_t)(end + 1 - from);
        if (length > 0 && next > PIPE_BUF)
            break;
        length = next;
    }
    memcpy(lines, from, length);
    queue.start += length;
    if (queue.start == queue.end)
        queue.start = queue.end = 0;
    return length;
}

/* What is to be written next; waits for it. */
static size_t next_piece(char *lines)
{
    pthread_mutex_lock(&queue.lock);
    queue.writing = false;
    while (queue.end == 0 && queue.dropped == 0) {
        pthread_cond_broadcast(&queue.done);
        pthread_cond_wait(&queue.news, &queue.lock);
    }
    size_t length = take_lines(lines);
    if (length == 0) {
        length = (size_t)snprintf(lines, LINE_SIZE, "rkm04 serve: %" PRIu64
                                  " lines of the log were dropped here: nothing read them\n", queue.dropped);
        queue.dropped = 0;
    }
    queue.writing = true;
    pthread_mutex_unlock(&queue.lock);
    return length;
}

static void *write_lines(void *unused)
{
    static char lines[LINE_SIZE];
    (void)unused;
    for (;;)
        delivery_write(STDERR_FILENO, lines, next_piece(lines)); /* what cannot be written is lost */
    return NULL;
}

void log_begin(void)
{
    struct stat found;
    queue.queued = fstat(STDERR_FILENO, &found) == 0 && !S_ISREG(found.st_mode);
}

void log_start_thread(void)
{
    if (queue.queued && !queue.running)
        queue.running = delivery_thread(write_lines, NULL);
}

void log_flush(unsigned milliseconds)
{
    struct timespec end = delivery_deadline(milliseconds);
    pthread_mutex_lock(&queue.lock);
    while (queue.running && (queue.end > 0 || queue.dropped > 0 || queue.writing))
        if (pthread_cond_clockwait(&queue.done, &queue.lock, CLOCK_MONOTONIC, &end) != 0)
            break;
    pthread_mutex_unlock(&queue.lock);
}

/* ---- Lines ---------------------------------------------------------------------------------------------------------- */

static void put(const char *line, size_t length)
{
    if (!queue.queued) {
        delivery_write(STDERR_FILENO, line, length);
        return;
    }
    pthread_mutex_lock(&queue.lock);
    if (queue.dropped == 0 && length > sizeof queue.text - queue.end && queue.start > 0) {
        memmove(queue.text, queue.text + queue.start, queue.end - queue.start);
        queue.end -= queue.start;
        queue.start = 0;
    }
    if (queue.dropped > 0 || length > sizeof queue.text - queue.end) {
        queue.dropped++;
    } else {
        memcpy(queue.text + queue.end, line, length);
        queue.end += length;
    }
    pthread_cond_signal(&queue.news);
    pthread_mutex_unlock(&queue.lock);
}

static void put_line(const char *head, const char *format, va_list list)
{
    char line[LINE_SIZE];
    size_t length = (size_t)snprintf(line, sizeof line, "%s", head);
    int more = vsnprintf(line + length, sizeof line - length, format, list);
    length += more > 0 ? (size_t)more : 0;
    if (length > sizeof line - 1)
        length = sizeof line - 1;
    line[length++] = '\n';
    put(line, length);
}

static void put_prefixed(const char *head, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put_prefixed(const char *head, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    put_line(head, format, list);
    va_end(list);
}

void log_as(const char *head)
{
    program = head;
}

void log_error(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    put_line(program, format, list);
    va_end(list);
}

void log_at(uint64_t tick, const char *format, ...)
{
    char head[64];
    va_list list;
    snprintf(head, sizeof head, "[%6" PRIu64 ".%06" PRIu64 "] ", tick / US_PER_SECOND, tick % US_PER_SECOND);
    va_start(list, format);
    put_line(head, format, list);
    va_end(list);
}

void log_text(const char *text)
{
    for (const char *end; (end = strchr(text, '\n')); text = end + 1)
        put_prefixed("", "%.*s", (int)(end - text), text);
}
