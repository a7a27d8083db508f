/* SPDX-License-Identifier: BSD-3-Clause */
/* libFuzzer target: the input is the numbers of a model in memory, then a direction. */
#include "describe.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static described d;
    reader r = {data, size};
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    const uint8_t flags = take_byte(&r);
    describe(&r, &d, flags);
    d.desc.mixture = flags & 64 ? NULL : d.desc.mixture;
    const hairlut_result valid = hairlut_validate(d.lobes[0].theta, message),
                         result = hairlut_model_create(&d.desc, NULL, &model, message);
    REQUIRE(valid == HAIRLUT_OK || result != HAIRLUT_OK); /* which error comes first depends on what else is wrong */
    REQUIRE((result == HAIRLUT_OK) == (model != NULL));
    if (!model)
        return 0;
    const query q = take_query(&r);
    check_model(model);
    check_query(model, &q);
    hairlut_free(model);
    return 0;
}
