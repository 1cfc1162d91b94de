/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_ERR_H
#define RKM04_WINDOWS_ERR_H

#include <stdarg.h>

__attribute__((format(printf, 1, 2))) void warn(const char *format, ...);
__attribute__((format(printf, 1, 2))) void warnx(const char *format, ...);
void vwarnx(const char *format, va_list values);
__attribute__((format(printf, 2, 3), noreturn)) void err(int status, const char *format, ...);
__attribute__((format(printf, 2, 3), noreturn)) void errx(int status, const char *format, ...);

#endif
