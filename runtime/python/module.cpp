// SPDX-License-Identifier: BSD-3-Clause
// hairlut._core: the models of hairlut.h as Python objects. precompute/hairlut/sampler.py broadcasts, checks and documents; this file
// walks float arrays of any stride in blocks that stay in the first-level cache, and calls the _n functions on each.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <hairlut.h>

namespace nb = nanobind;
using namespace nb::literals;

namespace {

// A stride may be 0: a number that is broadcast.
using Input = nb::ndarray<const float, nb::ndim<1>, nb::device::cpu>;
using Shares = nb::ndarray<const float, nb::ndim<2>, nb::device::cpu>; // (n, lobes)
using Output = nb::ndarray<float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Grid = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using Nodes = nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t BLOCK = 2048;

// One argument of an array call, block by block.
class Column {
public:
    Column(const float *data, std::int64_t stride) : m_data(data), m_stride(stride)
    {
        if (stride != 1)
            m_copy.resize(BLOCK);
    }
    Column(const Input &input, std::size_t n) : Column(input.data(), input.stride(0))
    {
        if (input.shape(0) != n)
            throw std::invalid_argument("arrays of different lengths");
    }
    // n contiguous floats from sample s on
    const float *block(std::size_t s, std::size_t n)
    {
        const float *from = m_data + static_cast<std::int64_t>(s) * m_stride;
        if (m_stride == 1)
            return from;
        for (std::size_t k = 0; k < n; ++k)
            m_copy[k] = from[static_cast<std::int64_t>(k) * m_stride];
        return m_copy.data();
    }

private:
    const float *m_data;
    std::int64_t m_stride;
    std::vector<float> m_copy;
};

// Shares of a block, lobe by lobe, as hairlut.h wants them; NULL for the model's own.
class ShareBlock {
public:
    ShareBlock(const std::optional<Shares> &shares, int lobes, std::size_t n) : m_lobes(static_cast<std::size_t>(lobes))
    {
        if (!shares)
            return;
        if (shares->shape(0) != n || shares->shape(1) != m_lobes)
            throw std::invalid_argument("shares: expected one number a lobe");
        m_data = shares->data();
        m_stride = shares->stride(0);
        m_lobe_stride = shares->stride(1);
        m_copy.resize(BLOCK * m_lobes);
    }
    const float *block(std::size_t s, std::size_t n)
    {
        if (!m_data)
            return nullptr;
        for (std::size_t k = 0; k < m_lobes; ++k)
            for (std::size_t i = 0; i < n; ++i)
                m_copy[k * n + i] =
                    m_data[static_cast<std::int64_t>(s + i) * m_stride + static_cast<std::int64_t>(k) * m_lobe_stride];
        return m_copy.data();
    }

private:
    std::size_t m_lobes;
    const float *m_data = nullptr;
    std::int64_t m_stride = 0, m_lobe_stride = 0;
    std::vector<float> m_copy;
};

// Parameters of a block, one after the other, as hairlut.h wants them; NULL for the standard values.
class ParameterBlock {
public:
    ParameterBlock(const std::vector<Input> &parameters, int count, std::size_t n)
    {
        if (!parameters.empty() && parameters.size() != static_cast<std::size_t>(count))
            throw std::invalid_argument("parameters: expected one array for each of the model's, or none");
        for (const Input &each : parameters)
            m_columns.emplace_back(each, n);
        m_copy.resize(BLOCK * m_columns.size());
    }
    const float *block(std::size_t s, std::size_t n)
    {
        for (std::size_t k = 0; k < m_columns.size(); ++k)
            std::copy_n(m_columns[k].block(s, n), n, m_copy.data() + k * n);
        return m_columns.empty() ? nullptr : m_copy.data();
    }

private:
    std::vector<Column> m_columns;
    std::vector<float> m_copy;
};

template <typename Call> void in_blocks(std::size_t n, const Call &call)
{
    const nb::gil_scoped_release released;
    for (std::size_t s = 0; s < n; s += BLOCK)
        call(s, std::min(BLOCK, n - s));
}

hairlut_samples outputs(const std::vector<Output> &out, std::size_t n)
{
    for (const Output &each : out)
        if (out.size() != 4 || each.shape(0) != n)
            throw std::invalid_argument("outputs: expected four arrays of one length");
    return {out[0].data(), out[1].data(), out[2].data(), out[3].data()};
}

hairlut_samples from(const hairlut_samples &out, std::size_t s)
{
    return {out.theta_i + s, out.phi_i + s, out.pdf_angle + s, out.pdf_solid_angle + s};
}

class Model {
public:
    explicit Model(const hairlut_model *shipped) : m_model(shipped) {}
    explicit Model(hairlut_model *made) : m_model(made), m_made(made) {}
    Model(const Model &) = delete;
    Model &operator=(const Model &) = delete;
    ~Model() { hairlut_free(m_made); }

    std::vector<std::string> lobes() const
    {
        std::vector<std::string> names;
        for (int k = 0; k < hairlut_lobe_count(m_model); ++k)
            names.emplace_back(hairlut_lobe_name(m_model, k));
        return names;
    }

    void sample(const std::vector<Input> &parameters, const std::optional<Shares> &shares, const Input &theta_r,
                const Input &phi_r, const Input &offset, const Input &u_lobe, const Input &u_theta, const Input &u_phi,
                const std::vector<Output> &results) const
    {
        const std::size_t n = theta_r.shape(0);
        ParameterBlock strand(parameters, hairlut_parameter_count(m_model), n);
        ShareBlock mix(shares, hairlut_lobe_count(m_model), n);
        Column r(theta_r, n), p(phi_r, n), h(offset, n), l(u_lobe, n), t(u_theta, n), f(u_phi, n);
        const hairlut_samples out = outputs(results, n);
        in_blocks(n, [&](std::size_t s, std::size_t m) {
            hairlut_sample_strand_n(m_model, m, strand.block(s, m), mix.block(s, m), r.block(s, m), p.block(s, m),
                                    h.block(s, m), l.block(s, m), t.block(s, m), f.block(s, m), from(out, s));
        });
    }

    void pdf(const std::vector<Input> &parameters, const std::optional<Shares> &shares, const Input &theta_r,
             const Input &phi_r, const Input &offset, const Input &theta_i, const Input &phi_i, const Output &result) const
    {
        const std::size_t n = theta_r.shape(0);
        ParameterBlock strand(parameters, hairlut_parameter_count(m_model), n);
        ShareBlock mix(shares, hairlut_lobe_count(m_model), n);
        Column r(theta_r, n), p(phi_r, n), h(offset, n), t(theta_i, n), f(phi_i, n);
        float *out = result.data();
        in_blocks(n, [&](std::size_t s, std::size_t m) {
            hairlut_pdf_strand_n(m_model, m, strand.block(s, m), mix.block(s, m), r.block(s, m), p.block(s, m),
                                 h.block(s, m), t.block(s, m), f.block(s, m), out + s);
        });
    }

    void sample_lobe(int lobe, const Input &theta_r, const Input &phi_r, const Input &u_theta, const Input &u_phi,
                     const std::vector<Output> &results) const
    {
        const std::size_t n = theta_r.shape(0);
        Column r(theta_r, n), p(phi_r, n), t(u_theta, n), f(u_phi, n);
        const hairlut_samples out = outputs(results, n);
        in_blocks(n, [&](std::size_t s, std::size_t m) {
            hairlut_sample_lobe_n(m_model, lobe, m, r.block(s, m), p.block(s, m), t.block(s, m), f.block(s, m),
                                  from(out, s));
        });
    }

    void pdf_lobe(int lobe, const Input &theta_r, const Input &phi_r, const Input &theta_i, const Input &phi_i,
                  const Output &result) const
    {
        const std::size_t n = theta_r.shape(0);
        Column r(theta_r, n), p(phi_r, n), t(theta_i, n), f(phi_i, n);
        float *out = result.data();
        in_blocks(n, [&](std::size_t s, std::size_t m) {
            hairlut_pdf_lobe_n(m_model, lobe, m, r.block(s, m), p.block(s, m), t.block(s, m), f.block(s, m), out + s);
        });
    }

    void invert_lobe(int lobe, const Input &theta_r, const Input &phi_r, const Input &theta_i, const Input &phi_i,
                     const Output &u_theta, const Output &u_phi) const
    {
        const std::size_t n = theta_r.shape(0);
        Column r(theta_r, n), p(phi_r, n), t(theta_i, n), f(phi_i, n);
        float *first = u_theta.data(), *second = u_phi.data();
        in_blocks(n, [&](std::size_t s, std::size_t m) {
            const float *rs = r.block(s, m), *ps = p.block(s, m), *ts = t.block(s, m), *fs = f.block(s, m);
            for (std::size_t k = 0; k < m; ++k) {
                float u[2];
                hairlut_invert_lobe(m_model, lobe, rs[k], ps[k], ts[k], fs[k], u);
                first[s + k] = u[0];
                second[s + k] = u[1];
            }
        });
    }

private:
    const hairlut_model *m_model;
    hairlut_model *m_made = nullptr;
};

// number of a parameter, its nodes
using AxisData = std::tuple<int, Nodes>;
// texels (rows of every node, width, 2), theta_r's range, the domain, whether the warp is octaves, its e, the axes of parameters
using TableData = std::tuple<Grid, float, float, float, float, bool, float, std::vector<AxisData>>;
// name, least, most, standard
using ParameterData = std::tuple<std::string, float, float, float>;
// name, number of the theta table, number of the phi table or -1, whether phi is a sum
using LobeData = std::tuple<std::string, int, int, bool>;

std::vector<hairlut_parameter_nodes> described(const std::vector<AxisData> &axes)
{
    std::vector<hairlut_parameter_nodes> nodes;
    for (const auto &[parameter, values] : axes)
        nodes.push_back({sizeof(hairlut_parameter_nodes), parameter, static_cast<int>(values.shape(0)), values.data()});
    return nodes;
}

// How many nodes the axes have together: so many blocks of rows
std::size_t blocks(const std::vector<AxisData> &axes)
{
    std::size_t count = 1;
    for (const auto &[parameter, values] : axes)
        count *= values.shape(0);
    return count;
}

Model *create(const std::vector<ParameterData> &parameters, const std::vector<TableData> &tables,
              const std::vector<LobeData> &lobes, const std::vector<AxisData> &axes, const Nodes &theta_r,
              const Nodes &offset, const Grid &share, const Grid &turn, bool mirrored)
{
    std::vector<hairlut_parameter> ranges;
    for (const auto &[name, least, most, standard] : parameters)
        ranges.push_back({sizeof(hairlut_parameter), name.c_str(), least, most, standard});
    std::vector<std::vector<hairlut_parameter_nodes>> nodes;
    for (const TableData &table : tables)
        nodes.push_back(described(std::get<7>(table)));
    std::vector<hairlut_table> descriptors;
    for (const auto &[texels, theta_r_min, theta_r_max, low, high, octaves, e, over] : tables) {
        const std::vector<hairlut_parameter_nodes> &own = nodes[descriptors.size()];
        const std::size_t count = blocks(over);
        if (count == 0 || texels.shape(0) % count != 0 || texels.shape(2) != 2)
            throw std::invalid_argument("texels: expected (nodes of parameters * theta_r, width, 2)");
        descriptors.push_back({sizeof(hairlut_table), texels.data(), static_cast<int>(texels.shape(1)),
                               static_cast<int>(texels.shape(0) / count), theta_r_min, theta_r_max, low, high,
                               octaves ? HAIRLUT_WARP_OCTAVES : HAIRLUT_WARP_UNIFORM, e, static_cast<int>(own.size()),
                               own.data()});
    }
    std::vector<hairlut_lobe_desc> named;
    for (const auto &[name, theta, phi, sum] : lobes)
        named.push_back({sizeof(hairlut_lobe_desc), name.c_str(), &descriptors.at(static_cast<std::size_t>(theta)),
                         phi < 0 ? nullptr : &descriptors.at(static_cast<std::size_t>(phi)),
                         sum ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE});
    for (const Grid *grid : {&share, &turn})
        if (grid->shape(0) != lobes.size() || grid->shape(1) != blocks(axes) * theta_r.shape(0) ||
            grid->shape(2) != offset.shape(0))
            throw std::invalid_argument("share, turn: expected (lobes, nodes of parameters * theta_r, offset)");
    const std::vector<hairlut_parameter_nodes> own = described(axes);
    const hairlut_mixture_desc mixture = {sizeof(hairlut_mixture_desc),
                                          static_cast<int>(theta_r.shape(0)),
                                          static_cast<int>(offset.shape(0)),
                                          theta_r.data(),
                                          offset.data(),
                                          share.data(),
                                          turn.data(),
                                          mirrored ? 1 : 0,
                                          static_cast<int>(own.size()),
                                          own.data()};
    const hairlut_model_desc desc = {sizeof(hairlut_model_desc),
                                     static_cast<int>(lobes.size()),
                                     named.data(),
                                     &mixture,
                                     static_cast<int>(ranges.size()),
                                     ranges.data()};
    hairlut_model *made = nullptr;
    char message[HAIRLUT_MESSAGE_SIZE];
    if (hairlut_model_create(&desc, nullptr, &made, message) != HAIRLUT_OK)
        throw std::invalid_argument(message);
    return new Model(made);
}

} // namespace

NB_MODULE(_core, module)
{
    module.doc() = "The C library behind hairlut.Model: use that.";
    nb::class_<Model>(module, "Model")
        .def_prop_ro("lobes", &Model::lobes)
        .def("sample", &Model::sample, "parameters"_a, "shares"_a.none(), "theta_r"_a, "phi_r"_a, "offset"_a, "u_lobe"_a,
             "u_theta"_a, "u_phi"_a, "out"_a)
        .def("pdf", &Model::pdf, "parameters"_a, "shares"_a.none(), "theta_r"_a, "phi_r"_a, "offset"_a, "theta_i"_a,
             "phi_i"_a, "out"_a)
        .def("sample_lobe", &Model::sample_lobe, "lobe"_a, "theta_r"_a, "phi_r"_a, "u_theta"_a, "u_phi"_a, "out"_a)
        .def("pdf_lobe", &Model::pdf_lobe, "lobe"_a, "theta_r"_a, "phi_r"_a, "theta_i"_a, "phi_i"_a, "out"_a)
        .def("invert_lobe", &Model::invert_lobe, "lobe"_a, "theta_r"_a, "phi_r"_a, "theta_i"_a, "phi_i"_a, "u_theta"_a,
             "u_phi"_a);
    module.def("create", &create, "parameters"_a, "tables"_a, "lobes"_a, "axes"_a, "theta_r"_a, "offset"_a, "share"_a,
               "turn"_a, "mirrored"_a);
    module.def(
        "builtin",
        [](const std::string &name) -> Model * {
            const hairlut_model *shipped = hairlut_builtin(name.c_str());
            return shipped ? new Model(shipped) : nullptr;
        },
        "name"_a);
}
