/* SPDX-License-Identifier: MIT */
/* Runs PLC programs: registers, sections, mechanisms that wait (NP5, NP6, NP7). */
#include "plc_code.h"

#ifdef __FLT_EVAL_METHOD__
_Static_assert(__FLT_EVAL_METHOD__ == 0 || __FLT_EVAL_METHOD__ == 1, "REAL is IEEE double: -msse2 -mfpmath=sse on i386");
#endif

struct run {
    struct cnc_plc *plc;
    const struct cnc_plc_program *program;
    struct cnc_cells *cells;
    const struct cnc_plc_surroundings *surroundings;
    void *context;
    unsigned part; /* section or mechanism that runs */
    unsigned at;   /* next instruction */
    bool is_over, has_ended; /* the call; the section with it */
};

static void report(struct run *run, enum cnc_plc_event event, int64_t value, const struct cnc_instruction *instruction)
{
    run->surroundings->report(run->context, event, value, instruction->line);
}

/* ---- Operands -------------------------------------------------------------------------------------------------------- */

static unsigned block_of(const struct run *run, const struct cnc_operand *operand)
{
    return operand->block == CNC_BLOCK_BX ? run->plc->bx : operand->block;
}

static int64_t queue_number(const struct run *run, const struct cnc_operand *operand)
{
    return run->surroundings->queue_number(run->context, block_of(run, operand), (enum cnc_queue_field)operand->place,
                                           operand->index);
}

static bool read_bit(const struct run *run, const struct cnc_operand *operand)
{
    if (operand->kind == CNC_OPERAND_QUEUE_BIT)
        return queue_number(run, operand) != 0;
    return cnc_bit(run->cells, operand->place);
}

static int64_t read_whole(const struct run *run, const struct cnc_operand *operand)
{
    enum cnc_type type = (enum cnc_type)operand->type;

    if (operand->kind == CNC_OPERAND_CONSTANT)
        return operand->value;
    if (operand->kind == CNC_OPERAND_QUEUE)
        return cnc_cut_number(queue_number(run, operand), type);
    return cnc_read_number(run->cells, operand->place, type);
}

static double read_real(const struct run *run, const struct cnc_operand *operand)
{
    if (operand->kind == CNC_OPERAND_QUEUE)
        return run->surroundings->queue_real(run->context, block_of(run, operand), (enum cnc_queue_field)operand->place,
                                             operand->index);
    return cnc_read_real(run->cells, operand->place);
}

/* ---- Numbers --------------------------------------------------------------------------------------------------------- */

/* Cut towards 0; what no number of 64 bits is, is the nearest one; what is no number is 0. */
static int64_t cut_real(double value)
{
    if (value >= 9223372036854775808.0)
        return INT64_MAX;
    if (value < -9223372036854775808.0)
        return INT64_MIN;
    return value == value ? (int64_t)value : 0;
}

static void calculate_real(struct run *run, const struct cnc_instruction *instruction)
{
    double value = read_real(run, &instruction->operand);
    double *real = &run->plc->real;

    switch ((enum cnc_plc_code)instruction->code) {
    case CODE_LOD: *real = value; break;
    case CODE_AD: *real += value; break;
    case CODE_SU: *real -= value; break;
    case CODE_MULB: *real *= value; break;
    case CODE_EQ: run->plc->rlo = *real == value; return;
    case CODE_LE: run->plc->rlo = *real <= value; return;
    case CODE_LT: run->plc->rlo = *real < value; return;
    case CODE_GE: run->plc->rlo = *real >= value; return;
    case CODE_GT: run->plc->rlo = *real > value; return;
    default: /* DIVB */
        if (value == 0)
            report(run, CNC_PLC_DIVISION, 0, instruction);
        *real = value == 0 ? 0 : *real / value;
        break;
    }
    if (*real != *real)
        *real = cnc_no_number();
    run->plc->dr = cut_real(*real);
}

static int64_t divide(struct run *run, int64_t dividend, int64_t divisor, const struct cnc_instruction *instruction)
{
    if (divisor == 0) {
        report(run, CNC_PLC_DIVISION, 0, instruction);
        return 0;
    }
    if (divisor == -1)
        return (int64_t)(0 - (uint64_t)dividend); /* of the least number: itself */
    return dividend / divisor;
}

static void calculate_whole(struct run *run, const struct cnc_instruction *instruction)
{
    int64_t value = read_whole(run, &instruction->operand);
    int64_t dr = run->plc->dr;
    bool *rlo = &run->plc->rlo;

    switch ((enum cnc_plc_code)instruction->code) {
    case CODE_LOD: dr = value; break;
    case CODE_AD: dr = (int64_t)((uint64_t)dr + (uint64_t)value); break;
    case CODE_SU: dr = (int64_t)((uint64_t)dr - (uint64_t)value); break;
    case CODE_MULB: dr = (int64_t)((uint64_t)dr * (uint64_t)value); break;
    case CODE_DIVB: dr = divide(run, dr, value, instruction); break;
    case CODE_ORB: dr |= value; break;
    case CODE_ANDB: dr &= value; break;
    case CODE_XORB: dr ^= value; break;
    case CODE_EQ: *rlo = dr == value; break;
    case CODE_LE: *rlo = dr <= value; break;
    case CODE_LT: *rlo = dr < value; break;
    case CODE_GE: *rlo = dr >= value; break;
    default: *rlo = dr > value; break; /* GT */
    }
    run->plc->dr = dr;
}

static void store(struct run *run, const struct cnc_operand *operand)
{
    if (operand->type == CNC_REAL)
        cnc_write_real(run->cells, operand->place, run->plc->real);
    else
        cnc_write_number(run->cells, operand->place, (enum cnc_type)operand->type, run->plc->dr);
}

/* |DR| in the width of the type. */
static int64_t absolute(int64_t dr, enum cnc_type type)
{
    unsigned shift = 64u - 8u * cnc_type_size[type];
    uint64_t value = (uint64_t)dr << shift; /* its sign is now bit 63 */

    return (int64_t)((value >> 63 ? 0 - value : value) >> shift);
}

/* DR in the width of the type, without a sign, shifted to the right. */
static int64_t shift_right(int64_t dr, enum cnc_type type, int64_t places)
{
    unsigned cut = 64u - 8u * cnc_type_size[type];

    return (int64_t)((uint64_t)dr << cut >> cut >> places);
}

static void calculate(struct run *run, const struct cnc_instruction *instruction)
{
    const struct cnc_operand *operand = &instruction->operand;
    enum cnc_type type = (enum cnc_type)operand->type;
    struct cnc_plc *plc = run->plc;

    switch ((enum cnc_plc_code)instruction->code) {
    case CODE_STO: store(run, operand); break;
    case CODE_ABS: plc->dr = absolute(plc->dr, type); break;
    case CODE_RR: plc->dr = shift_right(plc->dr, type, operand->value); break;
    case CODE_BX: plc->bx = (uint16_t)read_whole(run, operand); break;
    case CODE_ESET:
        cnc_put_number(run->cells, CNC_CELL_PLC_ERROR, 0, plc->dr);
        report(run, CNC_PLC_ERROR_SET, plc->dr, instruction);
        break;
    case CODE_SPINDLE_AXIS: run->surroundings->seek_zero_pulse(run->context, (unsigned)operand->value); break;
    case CODE_NOTHING: break;
    default:
        if (type == CNC_REAL)
            calculate_real(run, instruction);
        else
            calculate_whole(run, instruction);
        break;
    }
}

/* ---- Bits ------------------------------------------------------------------------------------------------------------ */

static void work_bit(struct run *run, const struct cnc_instruction *instruction)
{
    const struct cnc_operand *operand = &instruction->operand;
    bool *rlo = &run->plc->rlo;

    switch ((enum cnc_plc_code)instruction->code) {
    case CODE_LDR: *rlo = read_bit(run, operand); break;
    case CODE_LA: *rlo = read_bit(run, operand) && *rlo; break;
    case CODE_LO: *rlo = read_bit(run, operand) || *rlo; break;
    case CODE_LX: *rlo = read_bit(run, operand) != *rlo; break;
    case CODE_WR: cnc_put_bit(run->cells, operand->place, *rlo); break;
    case CODE_CA: *rlo = !*rlo; break;
    case CODE_LICENCE: *rlo = !(run->plc->no_license >> operand->value & 1); break;
    default: /* FL, FL1 */
        if (instruction->code == CODE_FL || *rlo)
            cnc_put_bit(run->cells, operand->place, operand->value != 0);
        break;
    }
}

/* ---- The way through the code ---------------------------------------------------------------------------------------- */

/* The part that runs waits; its next call begins at its place. */
static void wait_here(struct run *run, const struct cnc_instruction *instruction)
{
    run->plc->waits[run->part] = (uint16_t)(instruction - run->program->code + 1);
    if (run->part < CNC_PLC_SECTIONS) {
        run->is_over = true;
        return;
    }
    run->at = run->program->parts[run->part].end + 1u;
    run->part = CNC_PLC_MAIN;
}

static void enter_mechanism(struct run *run, const struct cnc_operand *operand)
{
    unsigned part = CNC_PLC_SECTIONS + (unsigned)operand->value;

    if (cnc_bit(run->cells, operand->place)) {
        run->part = part;
        run->at = run->plc->place[part];
    } else {
        run->plc->place[part] = run->program->parts[part].begin;
        run->plc->waits[part] = 0;
        run->at = run->program->parts[part].end + 1u;
    }
}

static void end_part(struct run *run, const struct cnc_instruction *instruction)
{
    run->plc->place[run->part] = run->program->parts[run->part].begin;
    run->plc->waits[run->part] = 0;
    if (instruction->code == CODE_END) {
        run->is_over = run->has_ended = true;
        return;
    }
    cnc_put_bit(run->cells, instruction->operand.place, false);
    run->part = CNC_PLC_MAIN;
}

/* TEX0 (NP7): run->at is the time's instruction, the jump lies behind it. */
static void wait_with_limit(struct run *run, const struct cnc_instruction *instruction)
{
    const struct cnc_operand *counter = &instruction->operand;
    enum cnc_type type = (enum cnc_type)counter->type;
    int64_t calls = 0;
    bool is_late = false;

    if (!run->plc->rlo) {
        calls = (int64_t)((uint64_t)cnc_read_number(run->cells, counter->place, type) + 1);
        calls = cnc_cut_number(calls, type);
        is_late = calls >= read_whole(run, &instruction[1].operand);
    }
    cnc_write_number(run->cells, counter->place, type, is_late ? 0 : calls);
    if (!run->plc->rlo && !is_late) {
        wait_here(run, instruction);
        return;
    }
    run->at += 2;
    if (is_late) {
        run->plc->dr = counter->value;
        run->at = (unsigned)instruction[2].operand.value;
    }
    run->plc->place[run->part] = (uint16_t)run->at;
}

static void walk(struct run *run, const struct cnc_instruction *instruction)
{
    const struct cnc_operand *operand = &instruction->operand;
    bool rlo = run->plc->rlo;

    switch ((enum cnc_plc_code)instruction->code) {
    case CODE_JUM: run->at = (unsigned)operand->value; break;
    case CODE_JL0: run->at = rlo ? run->at : (unsigned)operand->value; break;
    case CODE_JL1: run->at = rlo ? (unsigned)operand->value : run->at; break;
    case CODE_EX:
        run->plc->place[run->part] = (uint16_t)run->at;
        wait_here(run, instruction);
        break;
    case CODE_EX0:
    case CODE_EX1:
        if (rlo == (instruction->code == CODE_EX1))
            wait_here(run, instruction);
        else
            run->plc->place[run->part] = (uint16_t)run->at;
        break;
    case CODE_TEX0: wait_with_limit(run, instruction); break;
    case CODE_MECHANISM: enter_mechanism(run, operand); break;
    default: end_part(run, instruction); break;
    }
}

static void halt(struct run *run)
{
    run->plc->is_halted = true;
    run->plc->halted_at = (uint16_t)run->at;
    cnc_put_bit(run->cells, CNC_BIT_STOP_EMERGENCY_REQ, true);
    report(run, CNC_PLC_FAULT, 0, &run->program->code[run->at]);
}

bool cnc_pass_plc(struct cnc_plc *plc, const struct cnc_plc_program *program, struct cnc_cells *cells,
                  enum cnc_plc_section section, const struct cnc_plc_surroundings *surroundings, void *context)
{
    struct run run = {plc, program, cells, surroundings, context, section, plc->place[section], false, false};
    uint32_t left = CNC_PLC_CALL_MAX;

    if (!program->parts[section].is_there)
        return true;
    if (plc->is_halted)
        return false;
    for (; !run.is_over && left > 0; left--) {
        const struct cnc_instruction *instruction = &program->code[run.at++];
        if (instruction->code <= CODE_LICENCE)
            work_bit(&run, instruction);
        else if (instruction->code <= CODE_SPINDLE_AXIS)
            calculate(&run, instruction);
        else
            walk(&run, instruction);
    }
    plc->done[section] = CNC_PLC_CALL_MAX - left;
    if (plc->done[section] > plc->most[section])
        plc->most[section] = plc->done[section];
    if (!run.is_over)
        halt(&run);
    return run.has_ended;
}

void cnc_restart_section(struct cnc_plc *plc, const struct cnc_plc_program *program, enum cnc_plc_section section)
{
    plc->place[section] = program->parts[section].begin;
    plc->waits[section] = 0;
}

const struct cnc_operand *cnc_plc_cell(const struct cnc_instruction *instruction)
{
    switch ((enum cnc_plc_code)instruction->code) {
    case CODE_CA:
    case CODE_LICENCE:
    case CODE_ABS:
    case CODE_RR:
    case CODE_ESET:
    case CODE_NOTHING:
    case CODE_SPINDLE_AXIS:
    case CODE_JUM:
    case CODE_JL0:
    case CODE_JL1:
    case CODE_EX:
    case CODE_EX0:
    case CODE_EX1:
    case CODE_TIME:
    case CODE_END_MECHANISM:
    case CODE_END:
        return NULL;
    default:
        return instruction->operand.kind == CNC_OPERAND_CONSTANT ? NULL : &instruction->operand;
    }
}

void cnc_begin_plc(struct cnc_plc *plc, const struct cnc_plc_program *program, struct cnc_cells *cells)
{
    *plc = (struct cnc_plc){.no_license = plc->no_license};
    for (unsigned part = 0; part < CNC_PLC_PLACES; part++)
        plc->place[part] = program->parts[part].begin;
    for (unsigned i = 0; i < program->names.count; i++) {
        const struct cnc_symbol *symbol = &program->names.symbols[i];
        if (symbol->kind == CNC_SYMBOL_BIT)
            cnc_put_bit(cells, symbol->place, symbol->value != 0);
        else if (symbol->kind == CNC_SYMBOL_VARIABLE)
            cnc_write_number(cells, symbol->place, (enum cnc_type)symbol->type, symbol->value);
    }
}
