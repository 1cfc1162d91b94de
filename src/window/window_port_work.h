/* SPDX-License-Identifier: MIT */
/* window_port_work.h: what a job does on the port, in its thread. */
#ifndef RKM04_WINDOW_PORT_WORK_H
#define RKM04_WINDOW_PORT_WORK_H

#include "window_job.h"

/* Fills in job->result and job->trouble. May last as long as the units take. */
void port_work(struct window_port *port, struct port_job *job);

/* Close the port, if one is open. */
void port_work_close(struct window_port *port);

#endif
