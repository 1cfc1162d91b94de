/* SPDX-License-Identifier: MIT */
/* nearest.h: the name that was probably meant by a mistyped one. */
#ifndef RKM04_TEXT_NEAREST_H
#define RKM04_TEXT_NEAREST_H

/* Find the word of `list` ("serve, exec, test or replay") nearest to `word`: up to two letters are wrong, missing, too many or
 * changed places, and one at least is right. Returns it, valid until the next call; "" if none is near. */
const char *nearest_name(const char *word, const char *list);

/* The same as "; did you mean `serve'?", valid until the next call; "" if none is near. */
const char *nearest_hint(const char *word, const char *list);

#endif
