/* SPDX-License-Identifier: MIT */
/* prt.h: the PRT messages: request -> action -> answer (section 3). Knows messages 1-7 and 255, no syntax of programs. */
#ifndef RKM04_SRC_PRT_H
#define RKM04_SRC_PRT_H

#include <rkm04/unit.h>

/* Obey one message and, unless it was a broadcast, prepare the answer in unit->answer for the asker `from`. */
void prt_handle(struct rkm04_unit *unit, const uint8_t *message, size_t length, uint8_t from, bool broadcast);

/* Set Command for motors '0'..'4' (P1 to P4). Returns the flag; *character is 0 unless the flag is 1 or 2. */
int prt_set_command(struct rkm04_unit *unit, uint8_t motor, const uint8_t *text, size_t length, uint8_t *character);

/* The next byte of the answer's message. Returns false after the last one. */
bool prt_answer_byte(const struct rkm04_unit *unit, struct rkm04_answer *answer, uint8_t *byte);

/* Bytes of the whole message of an answer that has not been begun. */
size_t prt_answer_length(const struct rkm04_unit *unit, const struct rkm04_answer *answer);

#endif
