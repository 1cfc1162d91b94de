/* SPDX-License-Identifier: MIT */
/* posix.h: what the programs use of POSIX and of the GNU C library beyond what mingw-w64 has, made of Win32. It is included
 * before everything else (cmake/WindowsPrograms.cmake), so that the other rooms are the same on both systems. Paths are UTF-8;
 * files are never translated; a file that is open can be removed and replaced. */
#ifndef RKM04_WINDOWS_POSIX_H
#define RKM04_WINDOWS_POSIX_H

#include <fcntl.h>
#include <io.h>
#include <jansson.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

#define O_CLOEXEC _O_NOINHERIT
#define O_NOCTTY 0
#define O_NONBLOCK 0
#define O_NOFOLLOW 0
#define O_DIRECTORY 0 /* a folder cannot be opened, which is no failure where this stands */

#define S_ISSOCK(mode) 0

typedef uint64_t windows_ino_t;

/* With the numbers that distinguish files, which the system's own has not. */
struct windows_stat {
    uint32_t st_dev;
    windows_ino_t st_ino;
    uint32_t st_mode;
    uint32_t st_uid, st_nlink;
    int64_t st_size;
};

#ifndef NAME_MAX
#define NAME_MAX 255
#endif
#define PIPE_BUF 4096 /* bytes that a pipe takes in one piece */

int windows_open(const char *path, int flags, ...);
FILE *windows_fopen(const char *path, const char *mode);
int windows_stat(const char *path, struct windows_stat *status);
int windows_fstat(int fd, struct windows_stat *status);
int windows_rename(const char *from, const char *to);
int windows_unlink(const char *path);
FILE *windows_tmpfile(void);
char *realpath(const char *path, char *found);
int mkostemp(char *path, int flags);
ssize_t pread(int fd, void *bytes, size_t length, int64_t offset);
ssize_t pwrite(int fd, const void *bytes, size_t length, int64_t offset);
int fchmod(int fd, unsigned mode);
int fsync(int fd);
unsigned geteuid(void); /* the one to whom all files belong (files.c) */
ssize_t getline(char **line, size_t *room, FILE *in);

#define ino_t windows_ino_t
#undef stat
#undef fstat
#undef lstat
#define stat windows_stat
#define lstat windows_stat
#define fstat windows_fstat
#define open windows_open
#define fopen windows_fopen
#define rename windows_rename
#define unlink windows_unlink
#define fdatasync fsync
#define tmpfile windows_tmpfile
#define mkstemp(path) mkostemp(path, 0)
#define getc_unlocked getc
#define putc_unlocked putc

/* ---- Streams in memory ---------------------------------------------------------------------------------------------- */

FILE *fmemopen(void *bytes, size_t length, const char *mode);
FILE *open_memstream(char **text, size_t *length);
int windows_fclose(FILE *file);
int windows_fflush(FILE *file);

#define fclose windows_fclose
#define fflush windows_fflush

/* ---- Text ----------------------------------------------------------------------------------------------------------- */

char *windows_strerror(int error);
char *strndup(const char *text, size_t length);
void *memrchr(const void *bytes, int wanted, size_t length);
void *memmem(const void *bytes, size_t length, const void *wanted, size_t wanted_length);

#define strerror windows_strerror

/* Formats are those of the GNU C library, which __USE_MINGW_ANSI_STDIO gives; in __attribute__((format(printf, 1, 2))) the
 * compiler would take them for those of Windows. */
#define format(function, text, values) format(gnu_##function, text, values)
#undef JSON_INTEGER_FORMAT
#define JSON_INTEGER_FORMAT "lld"

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

#define CLOCK_MONOTONIC_COARSE CLOCK_MONOTONIC

/* ---- The process ---------------------------------------------------------------------------------------------------- */

#define SIGPIPE 13 /* never comes: writing says so */
#define SIGXFSZ 25
#define SA_RESETHAND 0 /* as signal() does in any case */

struct sigaction {
    void (*sa_handler)(int number);
    int sa_flags;
};

int sigaction(int number, const struct sigaction *action, struct sigaction *old);
void (*windows_signal(int number, void (*handler)(int number)))(int number);

/* The name of a program, without folder and .exe; its length is in *length. */
const char *windows_name(const char *path, int *length);
char *windows_short_name(void); /* of this one */

#define program_invocation_short_name windows_short_name()

extern int windows_exit_status; /* of a program that argp ends */
int on_exit(void (*function)(int status, void *context), void *context);

#define signal windows_signal

/* ---- Texts ---------------------------------------------------------------------------------------------------------- */

#define CLIENT_PORT_EXAMPLE "COM3"

#endif
