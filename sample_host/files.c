#include "files.h"

#include "report.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool files_prepare_folder(const char *path) {
    char part[FILES_PATH_MAX];
    size_t length = strlen(path);
    if (length == 0 || length >= sizeof part - 64) {
        report_error("'%.80s': not a usable folder name", path);
        return false;
    }
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') {
            continue;
        }
        memcpy(part, path, i);
        part[i] = '\0';
        struct stat status;
        if (stat(part, &status) == 0 ? S_ISDIR(status.st_mode) : mkdir(part, 0777) == 0 || errno == EEXIST) {
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

bool files_prepare_parent(const char *file) {
    char folder[FILES_PATH_MAX];
    struct stat status;
    size_t length = strlen(file);
    if (length == 0 || length >= sizeof folder || file[length - 1] == '/' ||
        (stat(file, &status) == 0 && S_ISDIR(status.st_mode))) {
        report_error("'%.200s': not a usable file name", file);
        return false;
    }
    strcpy(folder, file);
    char *slash = strrchr(folder, '/');
    if (!slash) {
        return files_prepare_folder(".");
    }
    slash[slash == folder] = '\0';
    return files_prepare_folder(folder);
}

bool files_temporary(const char *path, char temporary[FILES_PATH_MAX]) {
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
