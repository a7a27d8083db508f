/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads each directory named with every allocation failed in turn, then with every read failed in turn, in each way that
 * a read can fail: an error, an early end, half of what was requested. OpenEXR's own memory and reads are among them. A
 * load either succeeds or says what is wrong, and leaves no memory behind. glibc: the functions below take the places of
 * those in its library. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <string.h>
#include <sys/types.h>

#include "check.h"

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
extern void __libc_free(void *);

typedef enum way { ERROR, END, HALF, WAYS } way;

static int armed;           /* whether what follows is counted */
static long calls, fail_at; /* of the armed kind; -1: none fails */
static int failing_reads;   /* the armed kind: reads, else allocations */
static way how;
static long alive; /* blocks that are allocated */

/* Whether this call is the one that fails. */
static int fails(int is_read)
{
    return armed && is_read == failing_reads && calls++ == fail_at;
}

static void *counted(void *memory)
{
    alive += memory != NULL;
    return memory;
}

void *malloc(size_t size)
{
    return fails(0) ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    return fails(0) ? NULL : counted(__libc_calloc(count, size));
}

void *realloc(void *memory, size_t size)
{
    if (fails(0))
        return NULL;
    void *moved = __libc_realloc(memory, size);
    alive += !memory && moved;
    return moved;
}

void free(void *memory)
{
    alive -= memory != NULL;
    __libc_free(memory);
}

/* What a failing read gives of `count` bytes that were read. */
static ssize_t spoilt(ssize_t count)
{
    errno = EIO;
    return how == ERROR ? -1 : how == END ? 0 : count / 2;
}

ssize_t pread(int file, void *to, size_t size, off_t offset)
{
    static ssize_t (*next)(int, void *, size_t, off_t);
    if (!next)
        *(void **)&next = dlsym(RTLD_NEXT, "pread");
    const int failing = fails(1);
    const ssize_t count = next(file, to, size, offset);
    return failing ? spoilt(count) : count;
}

ssize_t pread64(int file, void *to, size_t size, off_t offset)
{
    return pread(file, to, size, offset);
}

size_t fread(void *to, size_t size, size_t count, FILE *stream)
{
    static size_t (*next)(void *, size_t, size_t, FILE *);
    if (!next)
        *(void **)&next = dlsym(RTLD_NEXT, "fread");
    const int failing = fails(1);
    const size_t read = next(to, size, count, stream);
    return !failing ? read : how == HALF ? read / 2 : 0;
}

int fseek(FILE *stream, long offset, int whence)
{
    static int (*next)(FILE *, long, int);
    if (!next)
        *(void **)&next = dlsym(RTLD_NEXT, "fseek");
    return fails(1) ? -1 : next(stream, offset, whence);
}

FILE *fopen(const char *path, const char *mode)
{
    static FILE *(*next)(const char *, const char *);
    if (!next)
        *(void **)&next = dlsym(RTLD_NEXT, "fopen");
    return fails(1) ? NULL : next(path, mode);
}

/* One load with call `at` of a kind failed; how many such calls there were. */
static long load_with_fault(const char *directory, int reads, long at, way w, int *loaded)
{
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE];
    const long before = alive;
    memset(message, 'x', sizeof message);
    failing_reads = reads, fail_at = at, how = w, calls = 0, armed = 1;
    const hairlut_result result = hairlut_load_with(directory, NULL, &model, message);
    armed = 0;
    *loaded = result == HAIRLUT_OK;
    REQUIRE((result == HAIRLUT_OK) == (model != NULL));
    REQUIRE(result == HAIRLUT_OK || memchr(message, '\0', sizeof message));
    REQUIRE(reads || result == HAIRLUT_OK || result == HAIRLUT_ERROR_MEMORY || strstr(message, ".exr: "));
    if (model)
        check_model(model);
    hairlut_free(model);
    REQUIRE(alive == before);
    return calls;
}

static void try_all(const char *directory, int reads, way w)
{
    static const char *const ways[] = {"error", "end", "half"};
    int loaded = 0, survived = 0;
    const long count = load_with_fault(directory, reads, -1, w, &loaded);
    REQUIRE(loaded && count > 0);
    for (long at = 0; at < count; ++at) {
        load_with_fault(directory, reads, at, w, &loaded);
        survived += loaded;
    }
    printf("%s: %ld %s failed in turn (%s), %d loads succeeded all the same\n", directory, count,
           reads ? "reads" : "allocations", reads ? ways[w] : "NULL", survived);
}

int main(int argc, char **argv)
{
    int loaded;
    for (int k = 1; k < argc; ++k) {
        load_with_fault(argv[k], 0, -1, ERROR, &loaded); /* what OpenEXR keeps for ever is allocated here */
        try_all(argv[k], 0, ERROR);
        for (int w = 0; w < WAYS; ++w)
            try_all(argv[k], 1, (way)w);
    }
    puts("done");
    return 0;
}
