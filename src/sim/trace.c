#include "trace.h"

#include <errno.h>
#include <string.h>

#include <rkm04/unit.h>

#define LINE_MAX_LENGTH 64 /* 20 digits, ",m1,command," and 11 more are 45 */

static const char *const event_names[] = {
    [TRACE_STEP] = "step",       [TRACE_DIRECTION] = "dir", [TRACE_MOTION] = "motion", [TRACE_LED] = "led",
    [TRACE_COMMAND] = "command", [TRACE_INPUTS] = "di",     [TRACE_OUTPUTS] = "do",    [TRACE_VARIABLES] = "var",
};

static char *put_text(char *at, const char *text)
{
    size_t length = strlen(text);
    memcpy(at, text, length);
    return at + length;
}

/* A row a pulse: printf would be most of the run time. */
static char *put_number(char *at, uint64_t number)
{
    char digits[20];
    size_t n = 0;
    do {
        digits[n++] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    while (n > 0)
        *at++ = digits[--n];
    return at;
}

static char *put_signed(char *at, int32_t number)
{
    if (number < 0)
        *at++ = '-';
    return put_number(at, (uint64_t)(number < 0 ? -(int64_t)number : number));
}

static char *put_value(char *at, const struct trace_row *row)
{
    switch (row->event) {
    case TRACE_MOTION:
        return put_text(at, row->value ? "begin" : "end");
    case TRACE_LED:
        return put_text(at, row->value == RKM04_LED_OFF ? "off" : row->value == RKM04_LED_ON ? "on" : "blink");
    default:
        return put_signed(at, row->value);
    }
}

static void put(struct trace *trace, const char *text, size_t length)
{
    if (trace->failed || fwrite(text, 1, length, trace->out) == length)
        return;
    trace->failed = true;
    trace->error = errno;
}

static void write_row(struct trace *trace, const struct trace_row *row)
{
    char line[LINE_MAX_LENGTH];
    char *at = put_number(line, row->tick);
    *at++ = ',';
    if (row->motor == 0) {
        at = put_text(at, "unit");
    } else {
        *at++ = 'm';
        *at++ = (char)('0' + row->motor);
    }
    *at++ = ',';
    at = put_text(at, event_names[row->event]);
    *at++ = ',';
    at = put_value(at, row);
    *at++ = '\n';
    put(trace, line, (size_t)(at - line));
}

static void drop_first(struct trace *trace, size_t n)
{
    memmove(trace->row, trace->row + n, (trace->count - n) * sizeof trace->row[0]);
    trace->count -= n;
}

void trace_begin(struct trace *trace, FILE *out)
{
    static const char header[] = "t_us,source,event,value\n";
    trace->out = out;
    trace->failed = false;
    trace->error = 0;
    trace->count = 0;
    put(trace, header, sizeof header - 1);
}

static bool comes_before(const struct trace_row *a, const struct trace_row *b)
{
    return a->tick != b->tick ? a->tick < b->tick : a->phase < b->phase;
}

void trace_add(struct trace *trace, uint64_t tick, enum trace_phase phase, unsigned motor, enum trace_event event,
               int32_t value)
{
    struct trace_row row = {tick, value, (uint8_t)motor, (uint8_t)event, (uint8_t)phase};
    if (trace->count == TRACE_ROOM) {
        write_row(trace, &trace->row[0]);
        drop_first(trace, 1);
    }
    size_t at = trace->count;
    while (at > 0 && comes_before(&row, &trace->row[at - 1])) {
        trace->row[at] = trace->row[at - 1];
        at--;
    }
    trace->row[at] = row;
    trace->count++;
}

void trace_write_before(struct trace *trace, uint64_t tick)
{
    size_t n = 0;
    while (n < trace->count && trace->row[n].tick < tick)
        write_row(trace, &trace->row[n++]);
    if (n > 0)
        drop_first(trace, n);
}

int trace_finish(struct trace *trace)
{
    for (size_t i = 0; i < trace->count; i++)
        write_row(trace, &trace->row[i]);
    trace->count = 0;
    if (!trace->failed && fflush(trace->out) != 0) {
        trace->failed = true;
        trace->error = errno;
    }
    return trace->failed ? (trace->error ? trace->error : EIO) : 0;
}
