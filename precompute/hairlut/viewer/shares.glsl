// SPDX-License-Identifier: BSD-3-Clause
in vec2 place;  // offset, lobe
out vec3 share; // of the lobe, its turn, side

void main()
{
    hairlut_mixture mixture = hairlut_mixture_at(hair(), viewer.x, place.x);
    int k = int(place.y);
    share = vec3(mixture.share[k], mixture.turn[k], mixture.side);
}
