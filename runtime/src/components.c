/* A mixture of any lobes of any models, with one density. */
#include "lobes.h"

static float weight_of(const hairlut_component *component)
{
    return component->weight > 0.0f ? component->weight : 0.0f;
}

/* The sum of the weights: in double, where no sum of floats overflows. 0 where no density can be given. */
static double total_weight(const hairlut_component *components, int n)
{
    double total = 0.0;
    for (int k = 0; k < n; ++k) {
        const float weight = weight_of(&components[k]);
        if (!hairlut_is_finite(components[k].weight) || (weight > 0.0f && !hairlut_is_finite(components[k].turn)))
            return 0.0;
        total += weight;
    }
    return total;
}

/* The component whose share of the total holds u; none of weight 0. */
static int choose(const hairlut_component *components, int n, double total, float u)
{
    const double target = (double)hairlut_clamp(u, 0.0f, 1.0f) * total;
    double below = 0.0;
    int chosen = 0;
    for (int k = 0; k < n && !(below > target); ++k) {
        if (weight_of(&components[k]) > 0.0f)
            chosen = k;
        below += weight_of(&components[k]);
    }
    return chosen;
}

static hairlut_sample sample_one(const hairlut_component *component, float theta_r, float phi_r, float u_theta,
                                 float u_phi)
{
    hairlut_sample s = component->lobe == HAIRLUT_LOBE_MULTIPLE
                           ? hairlut_sample_multiple(component->model, theta_r, phi_r, u_theta, u_phi)
                           : hairlut_sample_direct(component->model, theta_r, phi_r, u_theta, u_phi);
    s.phi_i = hairlut_wrap(s.phi_i + component->turn, -hairlut_pi);
    return s;
}

static float pdf_one(const hairlut_component *component, float theta_r, float phi_r, float theta_i, float phi_i)
{
    const float phi = phi_i - component->turn;
    return component->lobe == HAIRLUT_LOBE_MULTIPLE
               ? hairlut_pdf_multiple(component->model, theta_r, phi_r, theta_i, phi)
               : hairlut_pdf_direct(component->model, theta_r, phi_r, theta_i, phi);
}

/* The density of the mixture at (theta_i, phi_i); component `drawn`, if there is one, has the density that is known. */
static float mixed(const hairlut_component *components, int n, double total, float theta_r, float phi_r, float theta_i,
                   float phi_i, int drawn, float known)
{
    float sum = 0.0f;
    for (int k = 0; k < n; ++k) {
        const float share = (float)(weight_of(&components[k]) / total);
        if (share > 0.0f)
            sum += share * (k == drawn ? known : pdf_one(&components[k], theta_r, phi_r, theta_i, phi_i));
    }
    return sum;
}

float hairlut_pdf_components(const hairlut_component *components, int n, float theta_r, float phi_r, float theta_i,
                             float phi_i)
{
    const double total = total_weight(components, n);
    return total > 0.0 ? mixed(components, n, total, theta_r, phi_r, theta_i, phi_i, -1, 0.0f) : 0.0f;
}

hairlut_sample hairlut_sample_components(const hairlut_component *components, int n, float theta_r, float phi_r,
                                         float u_lobe, float u_theta, float u_phi)
{
    const double total = total_weight(components, n);
    if (!(total > 0.0))
        return hairlut_finish(0.0f, 0.0f, 0.0f);
    const int drawn = choose(components, n, total, u_lobe);
    const hairlut_sample s = sample_one(&components[drawn], theta_r, phi_r, u_theta, u_phi);
    const int known = u_lobe == u_lobe && hairlut_known(theta_r, phi_r, u_theta, u_phi);
    const float pdf = mixed(components, n, total, theta_r, phi_r, s.theta_i, s.phi_i, drawn, s.pdf_angle);
    return hairlut_finish(s.theta_i, s.phi_i, known ? pdf : 0.0f);
}
