/* SPDX-License-Identifier: MIT */
/* reply.h: what the faces share: the answer on its way, and the speed of the line. */
#ifndef PMC_REPLY_H
#define PMC_REPLY_H

#include "pmc.h"

/* The speed of the line. */
uint32_t pmc_baud(const struct pmc_unit *unit);

/* An answer of `length` bytes is ready; 0: none. */
void pmc_reply_begin(struct pmc_unit *unit, size_t length);

/* Take bytes of the answer, which lies at `answer`. Returns their number. Afterwards reply.length is 0 if it has gone out. */
size_t pmc_reply_take(struct pmc_unit *unit, const uint8_t *answer, uint8_t *bytes, size_t room);

/* pmc_exchange(), pmc_lose_byte() of a face. */
size_t pmc_ascii_exchange(struct pmc_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room);
void pmc_ascii_lose_byte(struct pmc_unit *unit);
void pmc_modbus_lose_byte(struct pmc_unit *unit);

#endif
