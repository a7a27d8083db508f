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
#include <map>
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
        if (m_angles.empty() || !whole())
            Throw("hairlut: %s ends too early: expected lines \"offset\", each followed by as many pairs of lines "
                  "\"lobe\" and \"turn\" as the first", path);
        for (size_t o = 0; o < m_angles.size(); ++o)
            for (size_t j = 0; j < m_theta_r.size(); ++j)
                if (dark(o, j))
                    Throw("hairlut: %s: at offset %f no lobe has a weight above 0 at theta_r number %d: nothing could be "
                          "drawn there", path, std::sin(m_angles[o]), j + 1);
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
    static constexpr float HALF_PI = 1.57079633f;

    /// Of one lobe at one offset and theta_r.
    struct Part {
        float weight, turn;
    };
    /// The lobes at an offset; side is -1 where their azimuth is to be mirrored.
    struct Mixture {
        hairlut_component parts[MAX_LOBES];
        int count;
        float side;
    };

    /// Where x lies among increasing values: from `first` with weight 1 - t and from `next` with weight t.
    struct Place {
        size_t first, next;
        float t;
        float blend(float a, float b) const { return a + t * (b - a); }
    };
    static Place place(const std::vector<float> &values, float x) {
        if (values.size() < 2)
            return { 0, 0, 0.f };
        const auto next = std::upper_bound(values.begin() + 1, values.end() - 1, x);
        const float low = *(next - 1);
        const size_t k = static_cast<size_t>(next - values.begin());
        return { k - 1, k, std::clamp((x - low) / (*next - low), 0.f, 1.f) };
    }

    /// Of a lobe at an offset, for all theta_r.
    const Part *parts(size_t offset, size_t lobe) const {
        return m_parts.data() + (offset * m_lobes + lobe) * m_theta_r.size();
    }

    bool dark(size_t offset, size_t theta_r) const {
        for (size_t k = 0; k < m_lobes; ++k)
            if (parts(offset, k)[theta_r].weight > 0.f)
                return false;
        return true;
    }

    Mixture at(float theta_r, float phi_r) const {
        Mixture m;
        float angle = std::fabs(phi_r) <= HALF_PI ? phi_r : std::copysign(2.f * HALF_PI, phi_r) - phi_r;
        const bool mirrored = m_mirrored && angle < 0.f;
        m.side = mirrored ? -1.f : 1.f;
        angle *= m.side;
        const Place o = place(m_angles, angle), j = place(m_theta_r, theta_r);
        const hairlut_model *const *models = m_models.data() + (o.t > .5f ? o.next : o.first) * m_lobes;
        m.count = static_cast<int>(m_lobes);
        for (size_t k = 0; k < m_lobes; ++k) {
            const Part *low = parts(o.first, k), *high = parts(o.next, k);
            const auto blend = [&](float Part::*of) {
                return o.blend(j.blend(low[j.first].*of, low[j.next].*of), j.blend(high[j.first].*of, high[j.next].*of));
            };
            m.parts[k] = { models[k], HAIRLUT_LOBE_DIRECT, blend(&Part::weight), blend(&Part::turn) };
        }
        return m;
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
            return "expected \"hairlut-family 2\" first";
        if (key == "hairlut-family")
            return (words >> m_version) && m_version == 2 ? "" : "expected version 2: this plugin reads no other";
        if (key == "mirrored")
            return (words >> m_mirrored) ? "" : "expected \"mirrored 0\" or \"mirrored 1\"";
        if (key == "theta_r")
            return read_theta_r(words);
        if (key == "offset")
            return read_offset(words);
        if (key == "lobe")
            return read_lobe(words);
        if (key == "turn")
            return read_turn(words);
        return "expected theta_r, mirrored, offset, lobe or turn, found \"" + key + "\"";
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
        return !m_theta_r.empty() && increasing && m_angles.empty() ? "" : "expected increasing angles in radians, once";
    }

    std::string read_offset(std::istream &words) {
        float h;
        if (m_theta_r.empty())
            return "expected a line theta_r before the first offset";
        if (!(words >> h) || !(std::fabs(h) <= 1.f))
            return "expected an offset in [-1, 1]";
        const float angle = std::asin(h);
        if (!m_angles.empty() && (!whole() || !(angle > m_angles.back())))
            return "expected offsets to increase, with a line lobe and a line turn for each lobe of the first";
        m_angles.push_back(angle);
        return "";
    }

    /// Whether the last offset has its lobes, as many as the first, and each its turn. It sets how many that is.
    bool whole() {
        if (m_angles.size() == 1)
            m_lobes = m_models.size();
        return m_lobes > 0 && m_turns == m_models.size() && m_models.size() == m_lobes * m_angles.size();
    }

    std::string read_lobe(std::istream &words) {
        std::string name;
        words >> name;
        const std::vector<float> weights = numbers(words);
        if (m_angles.empty())
            return "expected a line offset before the first lobe";
        if (m_turns != m_models.size())
            return "expected a line turn after each line lobe";
        if (m_models.size() == MAX_LOBES * m_angles.size())
            return "expected at most " + std::to_string(MAX_LOBES) + " lobes for each offset";
        const bool valid = std::all_of(weights.begin(), weights.end(), [](float w) { return w >= 0.f && w <= 1.f; });
        if (weights.size() != m_theta_r.size() || !valid)
            return "expected a model's name and " + std::to_string(m_theta_r.size()) +
                   " weights in [0, 1], one for each theta_r";
        std::unique_ptr<HairlutTables> &tables = m_tables[name];
        if (!tables)
            tables = std::make_unique<HairlutTables>(m_directory + "/" + name);
        m_models.push_back(tables->get());
        for (const float weight : weights)
            m_parts.push_back({ weight, 0.f });
        return "";
    }

    std::string read_turn(std::istream &words) {
        const std::vector<float> turns = numbers(words);
        if (m_turns == m_models.size())
            return "expected a line lobe before each line turn";
        if (turns.size() != m_theta_r.size())
            return "expected " + std::to_string(m_theta_r.size()) + " angles in radians, one for each theta_r";
        Part *lobe = m_parts.data() + m_turns++ * m_theta_r.size();
        for (const float turn : turns)
            (lobe++)->turn = turn;
        return "";
    }

    std::string m_directory;
    int m_version = 0;
    bool m_mirrored = false;
    size_t m_lobes = 0; // of each offset, once the first is whole
    std::vector<float> m_theta_r;
    std::vector<float> m_angles; // asin of each offset
    std::map<std::string, std::unique_ptr<HairlutTables>> m_tables; // by name
    std::vector<const hairlut_model *> m_models; // of each offset's lobes
    std::vector<Part> m_parts; // of each offset's lobes, for each theta_r
    size_t m_turns = 0; // lines read
};

NAMESPACE_END(mitsuba)
