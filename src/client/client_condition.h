/* SPDX-License-Identifier: MIT */
/* client_condition.h: what to wait for, as one types it into a shell, turned into the JSON of docs/CONTROL.md.
 *
 *     m1.position>=5000   m2.true<=0     m1.steps>10       numbers: also index, commands; = != < <= > >=
 *     m1.state=idle       m1.led=blink   m1.fault!=none    words, those of the device; = !=
 *     m1.idle             idle           powered=0         one motor; all motors of the unit; its power
 *     do3=1               di08=0         var80=1           binary values
 *     message             message=4      host.message=2  one that passes, of any number; who sent it: host, unit, u3
 *     dropped                                              a frame that was dropped
 *     t>=2.5s                                              the time of the bus, with its unit or in us
 *     u3.m1.position=0    u3-2.do1=1                       of unit 3; of the second one with address 3
 *
 * Several beside one another, with "and", "&&" or "," between them or just a blank, have to hold together; of what stands to
 * the left and right of "or" or "||" one is enough. "and" binds tighter. A text that begins with { is JSON already. */
#ifndef RKM04_CLIENT_CONDITION_H
#define RKM04_CLIENT_CONDITION_H

#include <jansson.h>

#define CLIENT_CONDITION_WRONG_SIZE 256

/* Read a condition. `unit`: the one that terms without a unit are about; NULL: not named. Returns a new reference, or NULL: then
 * `wrong` says what was expected and what was found. */
json_t *client_condition(const char *text, const char *unit, char wrong[CLIENT_CONDITION_WRONG_SIZE]);

#endif
