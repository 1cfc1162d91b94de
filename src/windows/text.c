/* SPDX-License-Identifier: MIT */
/* text.c: texts, and messages of the program. */
#include <err.h>
#include <errno.h>
#include <stdarg.h>

#undef strerror

/* Of the numbers that Windows has of POSIX, it has no texts. */
char *windows_strerror(int error)
{
    static const struct {
        int error;
        const char *text;
    } texts[] = {{ECONNREFUSED, "Connection refused"}, {ECONNRESET, "Connection reset by peer"}, {EWOULDBLOCK, "Try again"},
                 {EAFNOSUPPORT, "Not in Windows"},     {ETIMEDOUT, "Connection timed out"},
                 {ENODEV, "Windows has a device of this name"},
                 {EBUSY, "another program has it open"}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (texts[i].error == error)
            return (char *)(uintptr_t)texts[i].text;
    return strerror(error);
}

char *strndup(const char *text, size_t length)
{
    size_t kept = strnlen(text, length);
    char *copy = malloc(kept + 1);
    if (copy) {
        memcpy(copy, text, kept);
        copy[kept] = '\0';
    }
    return copy;
}

void *memrchr(const void *bytes, int wanted, size_t length)
{
    const unsigned char *at = bytes;
    while (length > 0)
        if (at[--length] == (unsigned char)wanted)
            return (void *)(at + length);
    return NULL;
}

void *memmem(const void *bytes, size_t length, const void *wanted, size_t wanted_length)
{
    const char *at = bytes;
    for (; wanted_length <= length; at++, length--)
        if (memcmp(at, wanted, wanted_length) == 0)
            return (void *)at;
    return NULL;
}

const char *windows_name(const char *path, int *length)
{
    const char *slash = strrchr(path, '/'), *backslash = strrchr(path, '\\');
    const char *name = slash > backslash ? slash + 1 : backslash ? backslash + 1 : path;
    const char *end = strstr(name, ".exe");
    *length = (int)(end ? (size_t)(end - name) : strlen(name));
    return name;
}

static void report(int error, const char *format, va_list values)
{
    fprintf(stderr, "%s: ", windows_short_name());
    vfprintf(stderr, format, values);
    fprintf(stderr, error ? ": %s\n" : "%s\n", error ? windows_strerror(error) : "");
}

void vwarnx(const char *format, va_list values)
{
    report(0, format, values);
}

char *windows_short_name(void)
{
    static char own[64];
    int length;
    const char *name = windows_name(_pgmptr, &length);
    snprintf(own, sizeof own, "%.*s", length, name);
    return own;
}

void warn(const char *format, ...)
{
    int error = errno;
    va_list values;
    va_start(values, format);
    report(error, format, values);
    va_end(values);
}

void warnx(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    report(0, format, values);
    va_end(values);
}

void err(int status, const char *format, ...)
{
    int error = errno;
    va_list values;
    va_start(values, format);
    report(error, format, values);
    va_end(values);
    exit(status);
}

void errx(int status, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    report(0, format, values);
    va_end(values);
    exit(status);
}
