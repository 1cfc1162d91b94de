/* SPDX-License-Identifier: MIT */
#include "client_request.h"

#include <err.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client_find.h"
#include "client_link.h"
#include "client_port.h"
#include "client_send.h"
#include "client_usage.h"

/* ---- The commands ----------------------------------------------------------------------------------------------------- */

enum operand { NO_OPERAND, TEXT_OPERAND, FILE_OPERAND, HEX_OPERAND };
enum motors { NO_MOTOR, ANY_MOTOR, ONE_MOTOR };

static const struct command {
    const char *name;
    enum operand operand;
    enum motors motors;
    uint8_t number; /* of the message, for those without operand */
    enum exit_status (*show)(const struct client_answer *answer);
} commands[] = {
    {"version", NO_OPERAND, NO_MOTOR, 1, client_show_version},
    {"set", TEXT_OPERAND, ANY_MOTOR, 2, NULL},
    {"send", FILE_OPERAND, ANY_MOTOR, 2, NULL},
    {"store", NO_OPERAND, ANY_MOTOR, 3, client_show_store},
    {"position", NO_OPERAND, ANY_MOTOR, 4, client_show_position},
    {"command", NO_OPERAND, ONE_MOTOR, 5, client_show_command},
    {"table", NO_OPERAND, ONE_MOTOR, 6, client_show_table},
    {"progress", NO_OPERAND, ONE_MOTOR, 7, client_show_progress},
    {"raw", HEX_OPERAND, NO_MOTOR, 0, client_show_raw},
};

struct asking {
    const struct client_request *request;
    const struct command *command;
    const char *port;
    uint8_t raw[CLIENT_MESSAGE_MAX];
    size_t raw_length;
};

static const struct command *find_command(const char *name)
{
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    }
    return NULL;
}

bool client_request_has(const char *name)
{
    return find_command(name) != NULL;
}

/* ---- Usage ------------------------------------------------------------------------------------------------------------ */

static int hex_digit(char c)
{
    return '0' <= c && c <= '9' ? c - '0' : 'a' <= c && c <= 'f' ? c - 'a' + 10 : 'A' <= c && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Bytes of two digits each, blanks between them. Returns the exit status if that is not what they are. */
static enum exit_status read_hex(struct asking *a, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == ' ')
            continue;
        int high = hex_digit(text[0]), low = high >= 0 ? hex_digit(text[1]) : -1;
        if (low < 0)
            return client_usage("raw: expected bytes of two hexadecimal digits, like 04 31, found '%s'", text);
        if (a->raw_length == sizeof a->raw)
            return client_usage("raw: a message has up to %zu bytes", sizeof a->raw);
        a->raw[a->raw_length++] = (uint8_t)(high << 4 | low);
        text++;
    }
    return STATUS_SUCCESS;
}

/* Check what follows the command. Returns the exit status if it is wrong. */
static enum exit_status read_words(struct asking *a)
{
    static const char *const operands[] = {[TEXT_OPERAND] = "a TEXT", [FILE_OPERAND] = "a FILE", [HEX_OPERAND] = "HEX bytes"};
    const struct client_request *request = a->request;
    enum operand operand = a->command->operand;
    if (operand == NO_OPERAND && request->count > 0)
        return client_usage("%s takes no argument, found '%s'", a->command->name, request->words[0]);
    if (operand != NO_OPERAND && operand != HEX_OPERAND && request->count > 1)
        return client_usage("%s takes one argument: put it in quotes", a->command->name);
    for (size_t i = 0; operand == HEX_OPERAND && i < request->count; i++) {
        enum exit_status status = read_hex(a, request->words[i]);
        if (status != STATUS_SUCCESS)
            return status;
    }
    if (operand != NO_OPERAND && (request->count == 0 || (operand == HEX_OPERAND && a->raw_length == 0)))
        return client_usage("%s needs %s", a->command->name, operands[operand]);
    return STATUS_SUCCESS;
}

/* --port, else RKM04_PORT of the environment, else the bus of the emulator that is running. NULL: reported. */
static const char *port_of(const struct client_request *request)
{
    const char *named = request->port != NULL ? request->port : getenv("RKM04_PORT");
    if (named != NULL && named[0] != '\0')
        return named;
    const struct client_found *found = client_find_one("--port");
    return found != NULL ? found->port : NULL;
}

static enum exit_status check_request(struct asking *a)
{
    const struct client_request *request = a->request;
    enum exit_status status = read_words(a);
    if (status != STATUS_SUCCESS)
        return status;
    a->port = port_of(request);
    if (a->port == NULL)
        return STATUS_USAGE;
    if (!client_port_valid(a->port))
        return client_usage("--port: expected tcp:HOST:PORT, PORT 1 to 65535, like tcp:localhost:4001, found '%s'", a->port);
    if (a->command->motors == ONE_MOTOR && request->motor == 0)
        return client_usage("%s works with one motor only: -m 1 to 4", a->command->name);
    return STATUS_SUCCESS;
}

/* ---- Work ------------------------------------------------------------------------------------------------------------- */

static enum exit_status show_answer(const struct asking *a, const struct client *client, char motor)
{
    struct client_answer answer = {.bytes = client->answer, .length = client->length, .motor = motor, .json = a->request->json};
    const struct command *command = a->command;
    if (client->answer[0] == 255 && command->operand != HEX_OPERAND) {
        warnx("the unit does not know message %u (%s)", command->number, command->name);
        return STATUS_FAILURE;
    }
    return command->show(&answer);
}

static enum exit_status send_request(const struct asking *a, struct client *client, char motor)
{
    const struct command *command = a->command;
    uint8_t question[] = {command->number, (uint8_t)motor};
    bool raw = command->operand == HEX_OPERAND;
    size_t length = raw ? a->raw_length : command->motors == NO_MOTOR ? 1 : 2;
    switch (client_exchange(client, raw ? a->raw : question, length)) {
    case CLIENT_ANSWERED:
        return show_answer(a, client, motor);
    case CLIENT_SENT:
        if (command->show != client_show_store && !raw)
            warnx("note: no unit answers a request to all units");
        return a->request->json ? client_print_json(json_pack("{s:b}", "broadcast", 1)) : STATUS_SUCCESS;
    case CLIENT_SILENT:
        return STATUS_NO_ANSWER;
    default:
        return STATUS_FAILURE;
    }
}

static enum exit_status run_request(const struct asking *a, struct client *client)
{
    char motor = (char)('0' + a->request->motor);
    const struct client_request *request = a->request;
    struct client_send sender = {.client = client, .motor = motor, .message_max = request->message_max, .json = request->json,
                                 .allow_overflow = request->allow_overflow};
    switch (a->command->operand) {
    case TEXT_OPERAND:
        return client_send_text(&sender, request->words[0]);
    case FILE_OPERAND:
        return client_send_file(&sender, request->words[0]);
    default:
        return send_request(a, client, motor);
    }
}

enum exit_status client_request(const struct client_request *request, const char *name)
{
    static struct client client; /* its buffers are large */
    static struct asking a;
    a = (struct asking){.request = request, .command = find_command(name)};
    enum exit_status status = check_request(&a);
    if (status != STATUS_SUCCESS)
        return status;
    client.port = a.port;
    client.framing = request->framing;
    client.node = (uint8_t)request->node;
    client.timeout_ms = request->timeout_ms;
    client.fd = client_port_open(a.port, request->timeout_ms);
    if (client.fd < 0)
        return STATUS_FAILURE;
    status = run_request(&a, &client);
    close(client.fd);
    return status;
}
