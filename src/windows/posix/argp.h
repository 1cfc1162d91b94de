/* SPDX-License-Identifier: MIT */
/* argp.h: of the GNU C library's argp, what the programs use (info libc, Argp); argp.c is the rest of it. */
#ifndef RKM04_WINDOWS_ARGP_H
#define RKM04_WINDOWS_ARGP_H

#include <errno.h>
#include <stdio.h>

typedef int error_t;

#define ARGP_ERR_UNKNOWN 7 /* E2BIG, as there */
#define ARGP_KEY_ARG 0
#define ARGP_KEY_END 0x1000001
#define ARGP_KEY_INIT 0x1000003
#define OPTION_ARG_OPTIONAL 0x1
#define OPTION_HIDDEN 0x2
#define OPTION_DOC 0x8
#define OPTION_NO_USAGE 0x10

struct argp_state;
typedef error_t (*argp_parser_t)(int key, char *arg, struct argp_state *state);

struct argp_option {
    const char *name;
    int key;
    const char *arg;
    int flags;
    const char *doc;
    int group;
};

struct argp {
    const struct argp_option *options;
    argp_parser_t parser;
    const char *args_doc;
    const char *doc; /* "before the options\vafter them" */
    const struct argp_child *children;
    char *(*help_filter)(int key, const char *text, void *input);
    const char *argp_domain;
};

struct argp_child {
    const struct argp *argp;
    int flags;
    const char *header;
    int group;
};

struct argp_state {
    const struct argp *root_argp;
    int argc;
    char **argv;
    int next;
    unsigned flags;
    unsigned arg_num;
    int quoted;
    void *input;
    void **child_inputs;
    void *hook;
    char *name;
    FILE *err_stream, *out_stream;
    void *pstate;
};

extern const char *argp_program_version;
extern error_t argp_err_exit_status;

error_t argp_parse(const struct argp *argp, int argc, char **argv, unsigned flags, int *arg_index, void *input);
__attribute__((format(printf, 2, 3))) void argp_error(const struct argp_state *state, const char *format, ...);
__attribute__((format(printf, 4, 5))) void argp_failure(const struct argp_state *state, int status, int error,
                                                        const char *format, ...);

#endif
