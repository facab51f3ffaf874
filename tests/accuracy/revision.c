/* What a reference picture depends on, as one number: a hash of the given sources without their comments and their
 * layout.
 *     accuracy-revision HEADER SOURCE...
 * writes HEADER with ACCURACY_REVISION, a text. Names and order of the sources count, their folders do not. */
#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum reading { IN_CODE, IN_STRING, IN_CHARACTER, IN_LINE_COMMENT, IN_BLOCK_COMMENT };

typedef struct reader {
    enum reading at;
    int previous; /* not yet hashed, or 0 */
    int escaped;
    int gap; /* since the last character that counts */
    uint64_t hash;
} reader;

/* G. Fowler, L. C. Noll, K.-P. Vo 1991. */
static void add(reader *r, int c) {
    r->hash = (r->hash ^ (uint64_t)(unsigned char)c) * 1099511628211u;
}

static void add_code(reader *r, int c) {
    if (isspace(c)) {
        r->gap = 1;
        return;
    }
    if (r->gap) {
        add(r, ' ');
    }
    r->gap = 0;
    add(r, c);
}

static void take_code(reader *r, int c) {
    if (r->previous == '/' && (c == '/' || c == '*')) {
        r->at = c == '/' ? IN_LINE_COMMENT : IN_BLOCK_COMMENT;
        r->previous = 0;
        r->gap = 1;
        return;
    }
    if (r->previous) {
        add_code(r, r->previous);
    }
    r->previous = c;
    if (c == '"' || c == '\'') {
        add_code(r, c);
        r->previous = 0;
        r->at = c == '"' ? IN_STRING : IN_CHARACTER;
    }
}

static void take(reader *r, int c) {
    switch (r->at) {
    case IN_CODE: take_code(r, c); break;
    case IN_STRING:
    case IN_CHARACTER:
        add(r, c);
        if (r->escaped) {
            r->escaped = 0;
        } else if (c == '\\') {
            r->escaped = 1;
        } else if (c == (r->at == IN_STRING ? '"' : '\'') || c == '\n') {
            r->at = IN_CODE;
        }
        break;
    case IN_LINE_COMMENT: r->at = c == '\n' ? IN_CODE : IN_LINE_COMMENT; break;
    case IN_BLOCK_COMMENT:
        if (r->previous == '*' && c == '/') {
            r->at = IN_CODE;
            c = 0;
        }
        r->previous = c;
        break;
    }
}

static int hash_source(const char *path, uint64_t *hash) {
    const char *slash = strrchr(path, '/');
    reader r = {.at = IN_CODE, .hash = *hash};
    for (const char *name = slash ? slash + 1 : path; *name; name++) {
        add(&r, *name);
    }
    add(&r, '\n');
    FILE *file = fopen(path, "rb");
    if (!file) {
        return 0;
    }
    int c;
    while ((c = getc(file)) != EOF) {
        take(&r, c);
    }
    if (r.at == IN_CODE && r.previous) {
        add_code(&r, r.previous);
    }
    int ok = !ferror(file);
    fclose(file);
    *hash = r.hash;
    return ok;
}

int main(int argc, char **argv) {
    uint64_t hash = 14695981039346656037u;
    if (argc < 3) {
        fprintf(stderr, "accuracy-revision HEADER SOURCE...\n");
        return 2;
    }
    for (int i = 2; i < argc; i++) {
        if (!hash_source(argv[i], &hash)) {
            fprintf(stderr, "%s: cannot read: %s\n", argv[i], strerror(errno));
            return 1;
        }
    }
    FILE *file = fopen(argv[1], "w");
    int ok = file && fprintf(file, "#define ACCURACY_REVISION \"%016" PRIx64 "\"\n", hash) > 0;
    if (!file || fclose(file) != 0 || !ok) {
        fprintf(stderr, "%s: cannot write: %s\n", argv[1], strerror(errno));
        return 1;
    }
    return 0;
}
