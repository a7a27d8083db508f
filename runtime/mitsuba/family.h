/* A family of models over the offset at which a fibre is hit: read from a directory with a family.txt
 * (precompute/hairlut/familyfiles.py has the format), and mixed for a viewer direction.
 *
 * The offset is sin(phi_r): phi_r is measured from the surface normal, and a ray that hits a round fibre at the
 * distance h from its axis, in radii, meets the normal at the angle asin(h). Viewers behind the surface, which
 * curves do not have, are taken as their mirror image in front of it. */
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <locale>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tables.h"

NAMESPACE_BEGIN(mitsuba)

class HairlutFamily {
public:
    explicit HairlutFamily(const std::string &directory) : m_directory(directory) {
        const std::string path = directory + "/family.txt";
        std::ifstream file(path);
        if (!file)
            Throw("hairlut: %s cannot be read: family expects a directory that `hairlut bake` made from what "
                  "`hairlut fit` wrote for a grid with offsets", path);
        std::string line;
        for (int number = 1; std::getline(file, line); ++number)
            if (const std::string wrong = read(line); !wrong.empty())
                Throw("hairlut: %s, line %d: %s", path, number, wrong);
        if (m_nodes.empty() || m_nodes.back().empty())
            Throw("hairlut: %s ends too early: expected lines \"offset\", each followed by lines \"lobe\"", path);
        for (size_t o = 0; o < m_nodes.size(); ++o)
            for (size_t k = 0; k < m_theta_r.size(); ++k)
                if (std::none_of(m_nodes[o].begin(), m_nodes[o].end(), [k](const Lobe &l) { return l.weights[k] > 0.f; }))
                    Throw("hairlut: %s: at offset %f no lobe has a weight above 0 at theta_r number %d: nothing could be "
                          "drawn there", path, std::sin(m_angles[o]), k + 1);
    }

    hairlut_sample sample(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi) const {
        const Mixture m = at(theta_r, phi_r);
        hairlut_sample s =
            hairlut_sample_components(m.parts, m.count, theta_r, m.side * phi_r, u_lobe, u_theta, u_phi);
        s.phi_i *= m.side;
        return s;
    }

    /// Density of what sample() draws, per rad^2.
    float pdf(float theta_r, float phi_r, float theta_i, float phi_i) const {
        const Mixture m = at(theta_r, phi_r);
        return hairlut_pdf_components(m.parts, m.count, theta_r, m.side * phi_r, theta_i, m.side * phi_i);
    }

private:
    static constexpr size_t MAX_LOBES = 8; // at one offset

    struct Lobe {
        std::unique_ptr<HairlutTables> tables;
        std::vector<float> weights; // for each theta_r
    };
    using Node = std::vector<Lobe>; // the lobes of one offset
    /// The lobes of two offsets; side is -1 where their azimuth is to be mirrored.
    struct Mixture {
        hairlut_component parts[2 * MAX_LOBES];
        int count = 0;
        float side = 1.f;
    };

    /// Where x lies among increasing values: from `first` with weight 1 - t and from the next with weight t.
    struct Place {
        size_t first;
        float t;
    };
    static Place place(const std::vector<float> &values, float x) {
        if (values.size() < 2)
            return { 0, 0.f };
        const auto next = std::upper_bound(values.begin() + 1, values.end() - 1, x);
        const float low = *(next - 1);
        return { static_cast<size_t>(next - values.begin()) - 1, std::clamp((x - low) / (*next - low), 0.f, 1.f) };
    }

    Mixture at(float theta_r, float phi_r) const {
        Mixture m;
        float angle = std::asin(std::clamp(std::sin(phi_r), -1.f, 1.f));
        if (m_mirrored && angle < 0.f) {
            angle = -angle;
            m.side = -1.f;
        }
        const Place row = place(m_theta_r, theta_r), node = place(m_angles, angle);
        add(m, m_nodes[node.first], 1.f - node.t, row);
        if (node.t > 0.f)
            add(m, m_nodes[node.first + 1], node.t, row);
        return m;
    }

    static void add(Mixture &m, const Node &node, float share, const Place &row) {
        for (const Lobe &lobe : node) {
            const float first = lobe.weights[row.first];
            const float next = row.t > 0.f ? lobe.weights[row.first + 1] : first;
            m.parts[m.count++] = { lobe.tables->get(), HAIRLUT_LOBE_DIRECT, share * (first + row.t * (next - first)) };
        }
    }

    /// Takes one line in; what is wrong with it, or nothing.
    std::string read(const std::string &line) {
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        std::string key;
        words >> key;
        if (key.empty())
            return "";
        if (m_version == 0 && key != "hairlut-family")
            return "expected \"hairlut-family 1\" first";
        if (key == "hairlut-family")
            return (words >> m_version) && m_version == 1 ? "" : "expected version 1: this plugin reads no other";
        if (key == "mirrored")
            return (words >> m_mirrored) ? "" : "expected \"mirrored 0\" or \"mirrored 1\"";
        if (key == "theta_r")
            return read_theta_r(words);
        if (key == "offset")
            return read_offset(words);
        if (key == "lobe")
            return read_lobe(words);
        return "expected theta_r, mirrored, offset or lobe, found \"" + key + "\"";
    }

    static std::vector<float> numbers(std::istream &words) {
        std::vector<float> values;
        for (float value; words >> value;)
            values.push_back(value);
        return words.eof() ? values : std::vector<float>();
    }

    std::string read_theta_r(std::istream &words) {
        m_theta_r = numbers(words);
        const auto end = m_theta_r.end();
        const bool increasing = std::adjacent_find(m_theta_r.begin(), end, std::greater_equal<float>()) == end;
        return !m_theta_r.empty() && increasing && m_nodes.empty() ? "" : "expected increasing angles in radians, once";
    }

    std::string read_offset(std::istream &words) {
        float h;
        if (m_theta_r.empty())
            return "expected a line theta_r before the first offset";
        if (!(words >> h) || !(std::fabs(h) <= 1.f))
            return "expected an offset in [-1, 1]";
        const float angle = std::asin(h);
        if (!m_nodes.empty() && (m_nodes.back().empty() || !(angle > m_angles.back())))
            return "expected offsets to increase, with at least one lobe each";
        m_nodes.emplace_back();
        m_angles.push_back(angle);
        return "";
    }

    std::string read_lobe(std::istream &words) {
        std::string name;
        words >> name;
        std::vector<float> weights = numbers(words);
        if (m_nodes.empty())
            return "expected a line offset before the first lobe";
        if (m_nodes.back().size() == MAX_LOBES)
            return "expected at most " + std::to_string(MAX_LOBES) + " lobes for each offset";
        const bool valid = std::all_of(weights.begin(), weights.end(), [](float w) { return w >= 0.f && w <= 1.f; });
        if (weights.size() != m_theta_r.size() || !valid)
            return "expected a model's name and " + std::to_string(m_theta_r.size()) +
                   " weights in [0, 1], one for each theta_r";
        auto tables = std::make_unique<HairlutTables>(m_directory + "/" + name);
        m_nodes.back().push_back({ std::move(tables), std::move(weights) });
        return "";
    }

    std::string m_directory;
    int m_version = 0;
    bool m_mirrored = false;
    std::vector<float> m_theta_r;
    std::vector<Node> m_nodes;
    std::vector<float> m_angles; // asin(offset) of each node
};

NAMESPACE_END(mitsuba)
