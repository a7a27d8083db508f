/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a fuzz target over files, named as arguments or, after "-", on lines of the standard input: a corpus as a plain
 * test, with any compiler. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void replay(const char *path)
{
    static uint8_t data[1 << 22];
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        exit(1);
    }
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    uint8_t *exact = malloc(size ? size : 1); /* so that a sanitizer sees one byte too many */
    memcpy(exact, data, size);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
}

int main(int argc, char **argv)
{
    char path[4096];
    int count = 0;
    for (int k = 1; k < argc && strcmp(argv[1], "-") != 0; ++k, ++count)
        replay(argv[k]);
    while (argc > 1 && strcmp(argv[1], "-") == 0 && fgets(path, sizeof path, stdin)) {
        path[strcspn(path, "\n")] = '\0';
        replay(path);
        ++count;
    }
    printf("%d inputs\n", count);
    return 0;
}
