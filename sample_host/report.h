/* One line to stderr for everything that goes wrong. */
#ifndef HOST_REPORT_H
#define HOST_REPORT_H

/* "velum-host: TEXT". */
void report_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void report_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
