/* Output folders, and files that appear whole or not at all. */
#ifndef HOST_FILES_H
#define HOST_FILES_H

#include <stdbool.h>
#include <stddef.h>

enum { FILES_PATH_MAX = 4096 };

struct files_folder {
    char path[FILES_PATH_MAX];
    size_t made; /* length of the topmost part of the path that was made here; 0: all of it was there */
};

/* Makes the folder and those above it where they are missing, and makes sure that a file can be written there. */
bool files_prepare_folder(const char *path, struct files_folder *folder);
/* The same for the folder of a file. */
bool files_prepare_parent(const char *file, struct files_folder *folder);
/* Removes what was made, as far as nothing is in it. */
void files_remove_empty(const struct files_folder *folder);

/* `temporary` is a name beside `path`; write there, then files_commit(), or files_discard(). */
bool files_temporary(const char *path, char temporary[FILES_PATH_MAX]);
bool files_commit(const char *temporary, const char *path);
void files_discard(const char *temporary);

/* FOLDER/NAME; false (reported) if it is too long. */
bool files_join(const char *folder, const char *name, char out[FILES_PATH_MAX]);

#endif
