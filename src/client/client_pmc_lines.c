/* SPDX-License-Identifier: MIT */
/* A PMC at its line of text (specification section 9): commands have no answer. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_pmc_way.h"
#include "client_report.h"

#define LINE_MAX_BYTES 64
#define CR '\r'

static enum exit_status send_line(struct pmc_link *link, const char *line)
{
    char text[LINE_MAX_BYTES + 1];
    int length = snprintf(text, sizeof text, "%s%c", line, CR);
    return client_pmc_send(link, (const uint8_t *)text, (size_t)length);
}

/* CR ends an answer: the last of its bytes, after an LF, too. */
static bool is_whole(const uint8_t *bytes, size_t length)
{
    return memchr(bytes, CR, length) != NULL;
}

/* Ask, and get what follows the blank. */
static enum exit_status ask_line(struct pmc_link *link, const char *line, char answer[LINE_MAX_BYTES])
{
    uint8_t bytes[LINE_MAX_BYTES];
    enum exit_status status = send_line(link, line);
    if (status != STATUS_SUCCESS)
        return status;
    size_t length = client_pmc_receive(link, bytes, sizeof bytes - 1u, is_whole);
    bytes[length] = '\0';
    if (length == 0)
        return STATUS_NO_ANSWER;
    if (length < 5 || memcmp(bytes, line, 3) != 0) {
        client_report("%s: expected an answer to %.3s, found other bytes", link->port, line);
        return STATUS_FAILURE;
    }
    bytes[4 + strcspn((char *)bytes + 4, "\r\n")] = '\0';
    strcpy(answer, (char *)bytes + 4);
    return STATUS_SUCCESS;
}

static const char *axes_text(uint8_t axes)
{
    static const char *const names[] = {"", "X", "Y", "XY"};
    return names[axes & 3u];
}

/* "[n][,[n]]" */
static void put_numbers(char *line, const struct pmc_request *request)
{
    bool has_x = (request->axes & 1u) != 0, has_y = (request->axes & 2u) != 0;
    size_t length = strlen(line);
    if (has_x)
        length += (size_t)snprintf(line + length, LINE_MAX_BYTES - length, "%" PRId32, request->value[0]);
    if (has_y)
        snprintf(line + length, LINE_MAX_BYTES - length, ",%" PRId32, request->value[1]);
}

static void put_jog(char *line, const struct pmc_request *request)
{
    for (unsigned axis = 0; axis < PMC_AXES; axis++)
        if ((request->axes & 1u << axis) != 0)
            strcat(strcat(line, request->value[axis] > 0 ? " " : " -"), axis == 0 ? "X" : "Y");
}

static enum exit_status ask(struct pmc_link *link, const struct pmc_request *request)
{
    char line[LINE_MAX_BYTES] = "";
    switch (request->kind) {
    case PMC_RUN:
        snprintf(line, sizeof line, "PRG %s%02" PRId32, axes_text(request->axes), request->value[request->axes == 2]);
        break;
    case PMC_JOG:
        put_jog(strcpy(line, "JOG"), request);
        break;
    case PMC_MOVE_TO:
        put_numbers(strcpy(line, "PAB "), request);
        break;
    case PMC_MOVE_BY:
        put_numbers(strcpy(line, "PIC "), request);
        break;
    case PMC_SET_SPEED:
        put_numbers(strcpy(line, "SPD "), request);
        break;
    case PMC_STOP:
        snprintf(line, sizeof line, "STO %s", axes_text(request->axes));
        break;
    case PMC_SEARCH:
        snprintf(line, sizeof line, "HOM %s", axes_text(request->axes));
        break;
    default:
        return client_usage("the line of text cannot do this: expected --face modbus");
    }
    return send_line(link, line);
}

static enum exit_status positions(struct pmc_link *link, int32_t position[PMC_AXES], unsigned *axes)
{
    char answer[LINE_MAX_BYTES], *at = answer;
    enum exit_status status = ask_line(link, "POS", answer);
    if (status != STATUS_SUCCESS)
        return status;
    for (*axes = 0; *axes < PMC_AXES && *at != '\0'; ++*axes) {
        position[*axes] = (int32_t)(uint32_t)strtoul(at, &at, 16);
        at += *at == ',';
    }
    return STATUS_SUCCESS;
}

static enum exit_status errors(struct pmc_link *link, uint8_t found[PMC_AXES], unsigned *axes)
{
    int32_t position[PMC_AXES];
    char answer[LINE_MAX_BYTES];
    enum exit_status status = positions(link, position, axes); /* says how many axes there are */
    for (unsigned axis = 0; axis < *axes && status == STATUS_SUCCESS; axis++) {
        status = ask_line(link, axis == 0 ? "ERD X" : "ERD Y", answer);
        if (status == STATUS_SUCCESS)
            found[axis] = (uint8_t)strtoul(answer, NULL, 16);
    }
    return status;
}

static enum exit_status refuse_files(void)
{
    return client_usage("the line of text has no commands for programs and parameters: expected --face modbus, or --control");
}

static enum exit_status get(struct pmc_link *link, enum pmc_text_kind kind, char **text)
{
    (void)link;
    (void)kind;
    *text = NULL;
    return refuse_files();
}

static enum exit_status put(struct pmc_link *link, enum pmc_text_kind kind, const char *name, const char *text)
{
    (void)link;
    (void)kind;
    (void)name;
    (void)text;
    return refuse_files();
}

static enum exit_status store(struct pmc_link *link, uint8_t axes)
{
    (void)link;
    (void)axes;
    return refuse_files();
}

const struct pmc_way client_pmc_lines = {
    .name = "ascii", .ask = ask, .positions = positions, .errors = errors, .get = get, .put = put, .store = store};
