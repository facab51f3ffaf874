/* Output folders, and files that appear whole or not at all. */
#ifndef HOST_FILES_H
#define HOST_FILES_H

#include <stdbool.h>

enum { FILES_PATH_MAX = 4096 };

/* Makes the folder and those above it where they are missing, and makes sure that a file can be written there. */
bool files_prepare_folder(const char *path);
/* The same for the folder of a file. */
bool files_prepare_parent(const char *file);

/* `temporary` is a name beside `path`; write there, then files_commit(), or files_discard(). */
bool files_temporary(const char *path, char temporary[FILES_PATH_MAX]);
bool files_commit(const char *temporary, const char *path);
void files_discard(const char *temporary);

/* FOLDER/NAME; false (reported) if it is too long. */
bool files_join(const char *folder, const char *name, char out[FILES_PATH_MAX]);

#endif
