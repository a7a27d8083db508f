/* Runs a fuzz target over the files named: the corpus as a plain test, with any compiler. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int main(int argc, char **argv)
{
    static uint8_t data[1 << 22];
    for (int k = 1; k < argc; ++k) {
        FILE *file = fopen(argv[k], "rb");
        if (!file) {
            perror(argv[k]);
            return 1;
        }
        const size_t size = fread(data, 1, sizeof data, file);
        fclose(file);
        uint8_t *exact = malloc(size ? size : 1); /* so that a sanitizer sees one byte too many */
        for (size_t i = 0; i < size; ++i)
            exact[i] = data[i];
        LLVMFuzzerTestOneInput(exact, size);
        free(exact);
    }
    printf("%d inputs\n", argc - 1);
    return 0;
}
