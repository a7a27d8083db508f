/* SPDX-License-Identifier: BSD-3-Clause */
/* BSDF plugin "hairlut" for Mitsuba 3, variant scalar_rgb: values from a nested hair BSDF, directions from hairlut.
 *
 *   model          string  a compiled-in model, such as "fitted" (default), or a directory of textures (luts/FORMAT.md)
 *   mix            float   probability of the nested BSDF's own sampling, in [0,1] (default 0)
 *   uniform        boolean draw uniformly from the sphere in place of the tables, for comparison (default false)
 *   light_sampling boolean false claims Dirac samples, so that integrators find light by this BSDF's sampling alone, for
 *                          comparison (default true)
 *   (nested)       bsdf    one BSDF without Dirac components that gives the values
 *   (name)         float or texture   a parameter of the model by its name, such as beta_m, in the model's unit (default its
 *                          standard value); values beyond its range count as the nearer end
 *
 * A texture of a parameter may differ from strand to strand. What it gives should be what the nested BSDF uses; where it is not,
 * there is more noise, and no bias.
 *
 * Conventions. On a curve the shading frame's t, local +y, is the fibre: sin(theta) = w.y. Azimuths run from the surface
 * normal, local +z, towards local +x. Mitsuba's si.wi is the viewer direction (theta_r, phi_r), its wo the incident one
 * (theta_i, phi_i). The density is per steradian over the whole sphere; both sides of the surface are sampled.
 *
 * The offset is h = sin(phi_r): a ray that passes a round fibre's axis at the distance h, in radii, meets the surface normal at
 * asin(h), measured around the fibre. The surface mirrors it to phi_i = -phi_r, the relative azimuth -2 asin(h), which is the
 * sign that hairlut.h expects. A viewer behind the surface, which curves do not have, counts as its mirror image in front.
 *
 * Only scalar_rgb is registered: the C library samples one direction a call and is not traced by Dr.Jit. */
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <mitsuba/core/fresolver.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/string.h>
#include <mitsuba/core/warp.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/texture.h>

#include <hairlut.h>

NAMESPACE_BEGIN(mitsuba)

namespace {

const hairlut_frame local_frame = {{0.f, 1.f, 0.f}, {0.f, 0.f, 1.f}, {1.f, 0.f, 0.f}};

struct Angles {
    float theta, phi;
};

template <typename Vector> Angles angles_of(const Vector &w)
{
    const float direction[3] = {w.x(), w.y(), w.z()};
    Angles a;
    hairlut_angles(&local_frame, direction, &a.theta, &a.phi);
    return a;
}

/// Where the viewer's ray passes the fibre, in radii from its axis: sin(phi_r).
template <typename Vector> float offset_of(const Vector &wi)
{
    const float across = std::hypot(wi.x(), wi.z());
    return across > 0.f ? wi.x() / across : 0.f;
}

/// A compiled-in model, which is never released, or that of a directory.
std::shared_ptr<const hairlut_model> load_model(const std::string &name)
{
    if (const hairlut_model *builtin = hairlut_builtin(name.c_str()))
        return {builtin, [](const hairlut_model *) {}};
    hairlut_model *loaded = nullptr;
    char message[HAIRLUT_MESSAGE_SIZE] = "the plugin was built without OpenEXR";
#ifdef HAIRLUT_WITHOUT_EXR
    const hairlut_result result = HAIRLUT_ERROR_UNSUPPORTED;
#else
    const hairlut_result result =
        hairlut_load_with(file_resolver()->resolve(name).string().c_str(), nullptr, &loaded, message);
#endif
    if (result != HAIRLUT_OK)
        Throw("hairlut: model \"%s\" is neither compiled in, as \"printed\", \"fitted\" and \"brown\" are, nor a "
              "directory of textures: %s (%s)",
              name, message, hairlut_result_string(result));
    return {loaded, hairlut_free};
}

/// The names of a model's parameters, for an error.
std::string parameter_names(const hairlut_model *model)
{
    std::string names;
    for (int p = 0; p < hairlut_parameter_count(model); ++p)
        names += (p ? ", " : "") + std::string(hairlut_parameter_name(model, p));
    return names.empty() ? "no parameters" : names;
}

} // namespace

template <typename Float, typename Spectrum> class HairlutBSDF final : public BSDF<Float, Spectrum> {
public:
    MI_IMPORT_BASE(BSDF, m_flags, m_components)
    MI_IMPORT_TYPES(Texture)

    explicit HairlutBSDF(const Properties &props) : Base(props)
    {
        m_name = props.get<std::string>("model", "fitted");
        m_model = load_model(m_name);
        m_mix = props.get<ScalarFloat>("mix", 0.f);
        if (!(m_mix >= 0.f && m_mix <= 1.f))
            Throw("hairlut: mix is %f: expected a probability, 0 to 1", m_mix);
        m_uniform = props.get<bool>("uniform", false);
        for (auto &prop : props.objects())
            if (Base *bsdf = prop.template try_get<Base>()) {
                if (m_nested)
                    Throw("hairlut: expected one nested BSDF, found a second one, \"%s\"", prop.name());
                m_nested = bsdf;
            }
        if (!m_nested)
            Throw("hairlut: expected a nested BSDF, which gives the values; add one, such as {'type': 'hair'}");
        if (has_flag(m_nested->flags(), BSDFFlags::DeltaReflection) ||
            has_flag(m_nested->flags(), BSDFFlags::DeltaTransmission))
            Throw("hairlut: the nested BSDF has a Dirac component, which no table samples; nest a rough one");
        for (int p = 0; p < hairlut_parameter_count(m_model.get()); ++p) {
            float standard = 0.f;
            hairlut_parameter_range(m_model.get(), p, nullptr, nullptr, &standard);
            m_strand.push_back(props.get_unbounded_texture<Texture>(hairlut_parameter_name(m_model.get(), p), standard));
        }
        const bool light_sampling = props.get<bool>("light_sampling", true);
        m_sampled_type = light_sampling ? +BSDFFlags::Glossy : +BSDFFlags::DeltaReflection;
        for (size_t i = 0; i < m_nested->component_count(); ++i)
            m_components.push_back(light_sampling ? m_nested->flags(i) : DIRAC);
        m_flags = light_sampling ? m_nested->flags() : DIRAC;
        for (const std::string &name : props.unqueried())
            Throw("hairlut: parameter \"%s\": the model \"%s\" has %s", name, m_name, parameter_names(m_model.get()));
    }

    std::pair<BSDFSample3f, Spectrum> sample(const BSDFContext &ctx, const SurfaceInteraction3f &si, Float sample1,
                                             const Point2f &sample2, Mask active) const override
    {
        MI_MASKED_FUNCTION(ProfilerPhase::BSDFSample, active);
        BSDFSample3f bs = dr::zeros<BSDFSample3f>();
        if (sample1 < m_mix) {
            Spectrum weight;
            std::tie(bs, weight) = m_nested->sample(ctx, si, sample1 / m_mix, sample2, active);
            bs.sampled_type = m_sampled_type;
            if (m_mix >= 1.f || !(bs.pdf > 0.f))
                return {bs, weight};
            auto [value, density] = eval_pdf(ctx, si, bs.wo, active);
            bs.pdf = density;
            return {bs, density > 0.f ? value / density : Spectrum(0.f)};
        }
        const Proposal drawn = propose(si, (sample1 - m_mix) / (1.f - m_mix), sample2);
        bs.wo = drawn.wo;
        bs.eta = 1.f;
        bs.sampled_type = m_sampled_type;
        bs.sampled_component = 0;
        auto [value, nested_pdf] = eval_nested(ctx, si, bs.wo, active);
        bs.pdf = mixed(nested_pdf, drawn.pdf);
        return {bs, bs.pdf > 0.f ? value / bs.pdf : Spectrum(0.f)};
    }

    Spectrum eval(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo, Mask active) const override
    {
        return m_nested->eval(ctx, si, wo, active);
    }

    Float pdf(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo, Mask active) const override
    {
        MI_MASKED_FUNCTION(ProfilerPhase::BSDFEvaluate, active);
        return mixed(m_mix > 0.f ? m_nested->pdf(ctx, si, wo, active) : Float(0.f), si, wo);
    }

    std::pair<Spectrum, Float> eval_pdf(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo,
                                        Mask active) const override
    {
        MI_MASKED_FUNCTION(ProfilerPhase::BSDFEvaluate, active);
        auto [value, nested_pdf] = eval_nested(ctx, si, wo, active);
        return {value, mixed(nested_pdf, si, wo)};
    }

    Spectrum eval_diffuse_reflectance(const SurfaceInteraction3f &si, Mask active) const override
    {
        return m_nested->eval_diffuse_reflectance(si, active);
    }

    void traverse(TraversalCallback *callback) override
    {
        callback->put("nested", m_nested, ParamFlags::NonDifferentiable);
        for (size_t p = 0; p < m_strand.size(); ++p)
            callback->put(hairlut_parameter_name(m_model.get(), int(p)), m_strand[p], ParamFlags::NonDifferentiable);
    }

    std::string to_string() const override
    {
        std::ostringstream oss;
        oss << "HairlutBSDF[" << std::endl
            << "  model = " << m_name << "," << std::endl
            << "  mix = " << m_mix << "," << std::endl
            << "  uniform = " << m_uniform << "," << std::endl;
        for (size_t p = 0; p < m_strand.size(); ++p)
            oss << "  " << hairlut_parameter_name(m_model.get(), int(p)) << " = " << string::indent(m_strand[p]) << ","
                << std::endl;
        oss << "  nested = " << string::indent(m_nested) << std::endl << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(HairlutBSDF)

private:
    static constexpr uint32_t DIRAC = BSDFFlags::DeltaReflection | BSDFFlags::FrontSide | BSDFFlags::BackSide;

    struct Proposal {
        Vector3f wo;
        Float pdf; // per steradian
    };

    using Strand = std::array<float, HAIRLUT_MAX_PARAMETERS>;

    /// The model's parameters where the ray hits.
    Strand strand(const SurfaceInteraction3f &si) const
    {
        Strand values{};
        for (size_t p = 0; p < m_strand.size(); ++p)
            values[p] = m_strand[p]->eval_1(si);
        return values;
    }

    /// A direction from the tables, or from the whole sphere.
    Proposal propose(const SurfaceInteraction3f &si, Float u_lobe, const Point2f &u) const
    {
        if (m_uniform) {
            const Vector3f wo = warp::square_to_uniform_sphere(u);
            return {wo, warp::square_to_uniform_sphere_pdf(wo)};
        }
        const Angles r = angles_of(si.wi);
        const hairlut_sample s = hairlut_sample_strand(m_model.get(), strand(si).data(), nullptr, r.theta, r.phi,
                                                       offset_of(si.wi), u_lobe, u.x(), u.y());
        float wo[3];
        hairlut_direction(&local_frame, s.theta_i, s.phi_i, wo);
        return {{wo[0], wo[1], wo[2]}, s.pdf_solid_angle};
    }

    /// Density of what propose() draws, per steradian.
    Float proposal_pdf(const SurfaceInteraction3f &si, const Vector3f &wo) const
    {
        if (m_uniform)
            return warp::square_to_uniform_sphere_pdf(wo);
        const Angles r = angles_of(si.wi), i = angles_of(wo);
        return hairlut_pdf_to_solid_angle(
            hairlut_pdf_strand(m_model.get(), strand(si).data(), nullptr, r.theta, r.phi, offset_of(si.wi), i.theta, i.phi),
            i.theta);
    }

    /// The nested value, and its density where it counts.
    std::pair<Spectrum, Float> eval_nested(const BSDFContext &ctx, const SurfaceInteraction3f &si, const Vector3f &wo,
                                           Mask active) const
    {
        if (m_mix > 0.f)
            return m_nested->eval_pdf(ctx, si, wo, active);
        return {m_nested->eval(ctx, si, wo, active), 0.f};
    }

    Float mixed(Float nested_pdf, const SurfaceInteraction3f &si, const Vector3f &wo) const
    {
        return m_mix >= 1.f ? nested_pdf : mixed(nested_pdf, proposal_pdf(si, wo));
    }

    Float mixed(Float nested_pdf, Float proposal_pdf) const { return m_mix * nested_pdf + (1.f - m_mix) * proposal_pdf; }

    std::string m_name;
    std::shared_ptr<const hairlut_model> m_model;
    float m_mix;
    bool m_uniform;
    uint32_t m_sampled_type;
    ref<Base> m_nested;
    std::vector<ref<Texture>> m_strand;

    MI_TRAVERSE_CB(Base, m_nested, m_strand)
};

using Plugin = HairlutBSDF<float, Color<float, 3>>;

extern "C" MI_EXPORT void init_plugin(std::string_view name, PluginRegisterFn register_plugin)
{
    register_plugin(name, Plugin::Variant, Plugin::Type,
                    [](void *, const Properties &props) -> ref<Object> { return new Plugin(props); });
}

NAMESPACE_END(mitsuba)
