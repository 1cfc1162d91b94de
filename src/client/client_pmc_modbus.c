/* SPDX-License-Identifier: MIT */
/* A PMC over Modbus RTU (specification section 10). */
#include <stdlib.h>
#include <string.h>

#include "client_pmc_way.h"
#include "client_port.h"
#include "client_report.h"
#include "modbus/modbus.h"

#define COMMAND 0x0000u
#define BLOCK 0x0001u
#define START 0x0485u
#define Y_VALUES 8u
#define PROGRAM 0x1000u
#define PROGRAM_AXIS 0x200u
#define REGISTER_WORDS 8u
#define REGISTERS_AT_ONCE 15u /* in one frame */
#define INPUTS_AXIS 0x10u
#define SILENCE_US 4000u      /* between two frames: 3.5 characters at 9600 Bd */

/* ---- Frames ------------------------------------------------------------------------------------------------------------- */

static bool is_whole(const uint8_t *bytes, size_t length)
{
    size_t whole = modbus_answer_length(bytes, length);
    return whole == MODBUS_NO_LENGTH || (whole > 0 && length >= whole);
}

static enum exit_status report_exception(const struct pmc_link *link, uint8_t code)
{
    static const char *const names[] = {[MODBUS_ILLEGAL_FUNCTION] = "it does not know the function",
                                        [MODBUS_ILLEGAL_ADDRESS] = "it has no such register (one axis only?)",
                                        [MODBUS_ILLEGAL_VALUE] = "a value is not legal",
                                        [MODBUS_DEVICE_FAILURE] = "it cannot store",
                                        [MODBUS_DEVICE_BUSY] = "the axis is busy, or the emergency stop is active"};
    const char *name = code < sizeof names / sizeof *names ? names[code] : NULL;
    client_report("%s: the unit refuses with exception %u: %s", link->port, code, name ? name : "unknown");
    return STATUS_FAILURE;
}

/* Send function and data in frame[1..length) and get the answer into the same place. *code: of an exception, which is not
 * reported; NULL: it is. */
static enum exit_status exchange(struct pmc_link *link, uint8_t frame[MODBUS_FRAME_MAX], size_t length, uint8_t *code)
{
    uint8_t function = frame[1];
    frame[0] = link->node;
    enum exit_status status = client_pmc_send(link, frame, modbus_append_crc(frame, length));
    link->free_at = client_now() + SILENCE_US;
    if (status != STATUS_SUCCESS || link->node == 0)
        return status;
    size_t found = client_pmc_receive(link, frame, MODBUS_FRAME_MAX, is_whole);
    link->free_at = client_now() + SILENCE_US;
    if (found == 0)
        return STATUS_NO_ANSWER;
    if (!modbus_is_frame(frame, found) || frame[0] != link->node || (frame[1] & 0x7Fu) != function) {
        client_report("%s: the answer is no frame from unit %u", link->port, link->node);
        return STATUS_FAILURE;
    }
    if (code)
        *code = frame[1] != function ? frame[2] : 0;
    else if (frame[1] != function)
        return report_exception(link, frame[2]);
    return STATUS_SUCCESS;
}

static enum exit_status read_words(struct pmc_link *link, uint8_t function, unsigned address, unsigned count, uint16_t *words,
                                   uint8_t *code)
{
    uint8_t frame[MODBUS_FRAME_MAX] = {0, function};
    modbus_put_word(frame + 2, (uint16_t)address);
    modbus_put_word(frame + 4, (uint16_t)count);
    enum exit_status status = exchange(link, frame, 6, code);
    if (status != STATUS_SUCCESS || (code && *code != 0))
        return status;
    if (frame[2] != 2u * count) {
        client_report("%s: the answer has another number of registers", link->port);
        return STATUS_FAILURE;
    }
    for (unsigned i = 0; i < count; i++)
        words[i] = modbus_word(frame + 3u + 2u * i);
    return STATUS_SUCCESS;
}

static enum exit_status write_word(struct pmc_link *link, unsigned address, unsigned word)
{
    uint8_t frame[MODBUS_FRAME_MAX] = {0, MODBUS_WRITE_HOLDING};
    modbus_put_word(frame + 2, (uint16_t)address);
    modbus_put_word(frame + 4, (uint16_t)word);
    return exchange(link, frame, 6, NULL);
}

static enum exit_status write_words(struct pmc_link *link, unsigned address, const uint16_t *words, unsigned count)
{
    uint8_t frame[MODBUS_FRAME_MAX] = {0, MODBUS_WRITE_REGISTERS};
    modbus_put_word(frame + 2, (uint16_t)address);
    modbus_put_word(frame + 4, (uint16_t)count);
    frame[6] = (uint8_t)(2u * count);
    for (unsigned i = 0; i < count; i++)
        modbus_put_word(frame + 7u + 2u * i, words[i]);
    return exchange(link, frame, 7u + 2u * count, NULL);
}

/* How many axes are there? Y has input registers, or not. */
static enum exit_status count_axes(struct pmc_link *link, unsigned *axes)
{
    uint16_t word;
    uint8_t code = 0;
    enum exit_status status = read_words(link, MODBUS_READ_INPUT, INPUTS_AXIS, 1, &word, &code);
    *axes = code == MODBUS_ILLEGAL_ADDRESS ? 1 : 2;
    return status;
}

/* ---- Commands ----------------------------------------------------------------------------------------------------------- */

static enum exit_status jog(struct pmc_link *link, const struct pmc_request *request)
{
    unsigned digits = 0;
    for (unsigned axis = 0; axis < PMC_AXES; axis++)
        if ((request->axes & 1u << axis) != 0)
            digits |= (request->value[axis] > 0 ? 0x20u : 0x10u) >> 4u * axis;
    return write_word(link, COMMAND, 0x0100u | digits);
}

static enum exit_status run(struct pmc_link *link, const struct pmc_request *request)
{
    enum exit_status status = STATUS_SUCCESS;
    for (unsigned axis = 0; axis < PMC_AXES && status == STATUS_SUCCESS; axis++)
        if ((request->axes & 1u << axis) != 0)
            status = write_word(link, START + Y_VALUES * axis, (unsigned)request->value[axis]);
    return status == STATUS_SUCCESS ? write_word(link, COMMAND, 0x0700u | request->axes) : status;
}

static enum exit_status move(struct pmc_link *link, const struct pmc_request *request, unsigned code)
{
    const uint32_t x = (uint32_t)request->value[0], y = (uint32_t)request->value[1];
    const uint16_t words[] = {(uint16_t)(code << 8 | request->axes), (uint16_t)(x >> 16), (uint16_t)x, (uint16_t)(y >> 16),
                              (uint16_t)y};
    return write_words(link, BLOCK, words, 5);
}

static enum exit_status ask(struct pmc_link *link, const struct pmc_request *request)
{
    const uint16_t speeds[] = {(uint16_t)(0x6100u | request->axes), (uint16_t)request->value[0], (uint16_t)request->value[1]};
    switch (request->kind) {
    case PMC_RUN:
        return run(link, request);
    case PMC_JOG:
        return jog(link, request);
    case PMC_MOVE_TO:
        return move(link, request, 0x71);
    case PMC_MOVE_BY:
        return move(link, request, 0x72);
    case PMC_SET_SPEED:
        return write_words(link, BLOCK, speeds, 3);
    case PMC_STOP:
        return write_word(link, COMMAND, 0x0500u | request->axes);
    case PMC_STOP_NOW:
        return write_word(link, COMMAND, 0x0500u | (unsigned)request->axes << 4);
    case PMC_SEARCH:
        return write_word(link, COMMAND, 0x0600u | request->axes);
    case PMC_CLEAR_ERRORS:
        return write_word(link, COMMAND, 0x0900u | request->axes);
    default:
        return client_usage("Modbus cannot do this");
    }
}

static enum exit_status positions(struct pmc_link *link, int32_t position[PMC_AXES], unsigned *axes)
{
    uint16_t words[2];
    enum exit_status status = count_axes(link, axes);
    for (unsigned axis = 0; axis < *axes && status == STATUS_SUCCESS; axis++) {
        status = read_words(link, MODBUS_READ_INPUT, INPUTS_AXIS * axis, 2, words, NULL);
        if (status == STATUS_SUCCESS)
            position[axis] = (int32_t)((uint32_t)words[0] << 16 | words[1]);
    }
    return status;
}

static enum exit_status errors(struct pmc_link *link, uint8_t found[PMC_AXES], unsigned *axes)
{
    uint16_t word;
    enum exit_status status = count_axes(link, axes);
    for (unsigned axis = 0; axis < *axes && status == STATUS_SUCCESS; axis++) {
        status = read_words(link, MODBUS_READ_INPUT, INPUTS_AXIS * axis + 8u, 1, &word, NULL);
        if (status == STATUS_SUCCESS)
            found[axis] = (uint8_t)word;
    }
    return status;
}

/* ---- Programs ----------------------------------------------------------------------------------------------------------- */

static void put_command(uint16_t words[REGISTER_WORDS], const struct pmc_command *command)
{
    const uint16_t all[REGISTER_WORDS] = {
        command->op, (uint16_t)((uint32_t)command->value >> 16), (uint16_t)command->value, command->speed,
        command->ms, command->argument, command->number, command->wait};
    memcpy(words, all, sizeof all);
}

static struct pmc_command command_of(const uint16_t words[REGISTER_WORDS])
{
    return (struct pmc_command){.op = (uint8_t)words[0],
                                .value = (int32_t)((uint32_t)words[1] << 16 | words[2]),
                                .speed = (uint8_t)words[3],
                                .ms = words[4],
                                .argument = (uint8_t)words[5],
                                .number = (uint8_t)words[6],
                                .wait = words[7] != 0};
}

static enum exit_status read_some(struct pmc_link *link, unsigned address, struct pmc_command *command, unsigned count)
{
    uint16_t words[REGISTERS_AT_ONCE * REGISTER_WORDS];
    enum exit_status status = read_words(link, MODBUS_READ_HOLDING, address, REGISTER_WORDS * count, words, NULL);
    if (status != STATUS_SUCCESS)
        return status;
    for (unsigned i = 0; i < count; i++) {
        command[i] = command_of(words + REGISTER_WORDS * i);
        if (!pmc_command_valid(&command[i])) {
            client_report("%s: holding register %04X has a command that is not known", link->port, address + REGISTER_WORDS * i);
            return STATUS_FAILURE;
        }
    }
    return STATUS_SUCCESS;
}

static enum exit_status write_some(struct pmc_link *link, unsigned address, const struct pmc_command *command, unsigned count)
{
    uint16_t words[REGISTERS_AT_ONCE * REGISTER_WORDS];
    for (unsigned i = 0; i < count; i++)
        put_command(words + REGISTER_WORDS * i, &command[i]);
    return write_words(link, address, words, REGISTER_WORDS * count);
}

/* Read or write the registers of an axis, some in each frame. */
static enum exit_status pass_program(struct pmc_link *link, unsigned axis, struct pmc_command program[PMC_REGISTERS],
                                     bool is_write)
{
    enum exit_status status = STATUS_SUCCESS;
    for (unsigned reg = 0; reg < PMC_REGISTERS && status == STATUS_SUCCESS; reg += REGISTERS_AT_ONCE) {
        unsigned rest = PMC_REGISTERS - reg, count = rest < REGISTERS_AT_ONCE ? rest : REGISTERS_AT_ONCE;
        unsigned address = PROGRAM + PROGRAM_AXIS * axis + REGISTER_WORDS * reg;
        status = is_write ? write_some(link, address, program + reg, count) : read_some(link, address, program + reg, count);
    }
    return status;
}

/* ---- Parameters --------------------------------------------------------------------------------------------------------- */

static enum exit_status read_parameters(struct pmc_link *link, unsigned axis, struct pmc_parameters *parameters)
{
    uint16_t words[2];
    enum exit_status status = STATUS_SUCCESS;
    for (unsigned which = 0; which < PMC_PARAMETERS && status == STATUS_SUCCESS; which++) {
        const struct pmc_parameter_row *row = &pmc_parameter_rows[which];
        status = read_words(link, MODBUS_READ_HOLDING, row->address[axis], row->is_wide ? 2 : 1, words, NULL);
        if (status == STATUS_SUCCESS)
            parameters->value[which] = row->is_wide ? (int32_t)((uint32_t)words[0] << 16 | words[1]) : words[0];
    }
    return status;
}

static enum exit_status write_parameter(struct pmc_link *link, unsigned axis, unsigned which, int32_t value)
{
    const struct pmc_parameter_row *row = &pmc_parameter_rows[which];
    const uint16_t words[] = {(uint16_t)((uint32_t)value >> 16), (uint16_t)value};
    return row->is_wide ? write_words(link, row->address[axis], words, 2) : write_word(link, row->address[axis], words[1]);
}

/* The flags come last: a deceleration sets one of them. */
static enum exit_status write_parameters(struct pmc_link *link, unsigned axis, const struct pmc_parameters *parameters)
{
    enum exit_status status = STATUS_SUCCESS;
    for (unsigned which = 0; which < PMC_PARAMETERS && status == STATUS_SUCCESS; which++)
        if (which != PMC_FLAGS)
            status = write_parameter(link, axis, which, parameters->value[which]);
    return status == STATUS_SUCCESS ? write_parameter(link, axis, PMC_FLAGS, parameters->value[PMC_FLAGS]) : status;
}

/* ---- Texts -------------------------------------------------------------------------------------------------------------- */

struct content {
    struct pmc_command program[PMC_AXES][PMC_REGISTERS];
    struct pmc_parameters parameters[PMC_AXES];
};

static char *write_text(enum pmc_text_kind kind, const struct content *content, unsigned axes)
{
    const struct pmc_command *const program[PMC_AXES] = {content->program[0], content->program[1]};
    const struct pmc_parameters *const parameters[PMC_AXES] = {&content->parameters[0], &content->parameters[1]};
    char *text = malloc(PMC_PROGRAM_TEXT_MAX + 1u);
    if (!text)
        return NULL;
    size_t length = kind == PMC_TEXT_PROGRAM ? pmc_program_write(program, axes, text, PMC_PROGRAM_TEXT_MAX)
                                             : pmc_parameters_write(parameters, axes, text, PMC_PROGRAM_TEXT_MAX);
    text[length] = '\0';
    return text;
}

static enum exit_status get(struct pmc_link *link, enum pmc_text_kind kind, char **text)
{
    struct content content;
    unsigned axes;
    enum exit_status status = count_axes(link, &axes);
    *text = NULL;
    for (unsigned axis = 0; axis < axes && status == STATUS_SUCCESS; axis++)
        status = kind == PMC_TEXT_PROGRAM ? pass_program(link, axis, content.program[axis], false)
                                          : read_parameters(link, axis, &content.parameters[axis]);
    if (status != STATUS_SUCCESS)
        return status;
    *text = write_text(kind, &content, axes);
    return *text ? STATUS_SUCCESS : STATUS_FAILURE;
}

static enum exit_status put(struct pmc_link *link, enum pmc_text_kind kind, const char *name, const char *text)
{
    struct content content;
    unsigned axes;
    char file[256];
    enum exit_status status = count_axes(link, &axes);
    if (status != STATUS_SUCCESS)
        return status;
    strncpy(file, name, sizeof file - 1u)[sizeof file - 1u] = '\0';
    bool is_right = kind == PMC_TEXT_PROGRAM
                        ? pmc_program_read(text, strlen(text), axes, content.program, client_pmc_print_error, file)
                        : pmc_parameters_read(text, strlen(text), axes, content.parameters, client_pmc_print_error, file);
    if (!is_right)
        return STATUS_FAILURE;
    for (unsigned axis = 0; axis < axes && status == STATUS_SUCCESS; axis++)
        status = kind == PMC_TEXT_PROGRAM ? pass_program(link, axis, content.program[axis], true)
                                          : write_parameters(link, axis, &content.parameters[axis]);
    return status;
}

static enum exit_status store(struct pmc_link *link, uint8_t axes)
{
    unsigned count = 0;
    enum exit_status status = axes == 0 ? count_axes(link, &count) : STATUS_SUCCESS;
    if (axes == 0)
        axes = count == 1 ? 1 : 3;
    return status == STATUS_SUCCESS ? write_word(link, COMMAND, 0x0B00u | axes) : status;
}

const struct pmc_way client_pmc_modbus = {
    .name = "modbus", .ask = ask, .positions = positions, .errors = errors, .get = get, .put = put, .store = store};
