#include "report.h"

#include <stdarg.h>
#include <stdio.h>

#ifndef REPORT_PROGRAM
#define REPORT_PROGRAM "velum-host"
#endif

static void report(const char *prefix, const char *format, va_list arguments) {
    char text[2048];
    vsnprintf(text, sizeof text, format, arguments);
    for (char *c = text; *c; c++) {
        if (*c == '\n' || *c == '\r') {
            *c = ' ';
        }
    }
    fprintf(stderr, "%s%s\n", prefix, text);
}

void report_error(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    report(REPORT_PROGRAM ": ", format, arguments);
    va_end(arguments);
}

void report_warning(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    report(REPORT_PROGRAM ": warning: ", format, arguments);
    va_end(arguments);
}
