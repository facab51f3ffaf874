#include "files.h"

#include "report.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool files_prepare_folder(const char *path, struct files_folder *folder) {
    char part[FILES_PATH_MAX];
    size_t length = strlen(path);
    folder->made = 0;
    if (length == 0 || length >= sizeof part - 64) {
        report_error("'%.80s': not a usable folder name", path);
        return false;
    }
    memcpy(folder->path, path, length + 1);
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') {
            continue;
        }
        memcpy(part, path, i);
        part[i] = '\0';
        struct stat status;
        bool there = stat(part, &status) == 0;
        if (!there && mkdir(part, 0777) == 0) {
            folder->made = folder->made ? folder->made : i;
            continue;
        }
        if (there ? S_ISDIR(status.st_mode) : errno == EEXIST) {
            continue;
        }
        report_error("%s: cannot make this folder: %s", part, strerror(stat(part, &status) == 0 ? ENOTDIR : errno));
        return false;
    }
    snprintf(part, sizeof part, "%s/.velum-%ld", path, (long)getpid());
    int file = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) {
        report_error("%s: cannot write here: %s", path, strerror(errno));
        return false;
    }
    close(file);
    unlink(part);
    return true;
}

bool files_prepare_parent(const char *file, struct files_folder *folder) {
    char parent[FILES_PATH_MAX];
    struct stat status;
    size_t length = strlen(file);
    folder->made = 0;
    if (length == 0 || length >= sizeof parent || file[length - 1] == '/' ||
        (stat(file, &status) == 0 && S_ISDIR(status.st_mode))) {
        report_error("'%.200s': not a usable file name", file);
        return false;
    }
    strcpy(parent, file);
    char *slash = strrchr(parent, '/');
    if (!slash) {
        return files_prepare_folder(".", folder);
    }
    slash[slash == parent] = '\0';
    return files_prepare_folder(parent, folder);
}

void files_remove_empty(const struct files_folder *folder) {
    char part[FILES_PATH_MAX];
    if (folder->made == 0) {
        return;
    }
    strcpy(part, folder->path);
    for (size_t length = strlen(part); length >= folder->made;) {
        while (length > folder->made && part[length - 1] == '/') {
            length--;
        }
        part[length] = '\0';
        if (rmdir(part) != 0 && errno != ENOENT) {
            return;
        }
        while (length > 0 && part[length - 1] != '/') {
            length--;
        }
        while (length > 0 && part[length - 1] == '/') {
            length--;
        }
    }
}

bool files_temporary(const char *path, char temporary[FILES_PATH_MAX]) {
    struct stat there;
    if (stat(path, &there) == 0 && !S_ISREG(there.st_mode)) {
        report_error("%s: found something that is no plain file, expected a file or nothing", path);
        return false;
    }
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    int length = snprintf(temporary, FILES_PATH_MAX, "%.*s.%s.%ld.tmp", (int)(name - path), path, name, (long)getpid());
    if (length < 0 || length >= FILES_PATH_MAX) {
        report_error("%.200s...: the path is too long", path);
        return false;
    }
    return true;
}

bool files_commit(const char *temporary, const char *path) {
    if (rename(temporary, path) != 0) {
        report_error("%s: cannot write: %s", path, strerror(errno));
        unlink(temporary);
        return false;
    }
    return true;
}

void files_discard(const char *temporary) {
    unlink(temporary);
}

bool files_join(const char *folder, const char *name, char out[FILES_PATH_MAX]) {
    size_t length = strlen(folder);
    const char *slash = length > 0 && folder[length - 1] == '/' ? "" : "/";
    int written = snprintf(out, FILES_PATH_MAX, "%s%s%s", folder, slash, name);
    if (written < 0 || written >= FILES_PATH_MAX) {
        report_error("%.200s...: the path is too long", folder);
        return false;
    }
    return true;
}
