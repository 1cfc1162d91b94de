/* SPDX-License-Identifier: MIT */
/* interrupt.h: ending a run by SIGINT or SIGTERM. */
#ifndef RKM04_RUN_INTERRUPT_H
#define RKM04_RUN_INTERRUPT_H

/* Call `handler` at SIGINT and SIGTERM; a second one of the same kind ends the process at once. From now on a closed pipe is a
 * failed write, which is reported. */
void interrupt_catch(void (*handler)(int signal_number));

#endif
