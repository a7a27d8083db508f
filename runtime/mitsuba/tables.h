/* A model of hairlut, compiled in or from a directory of textures. */
#pragma once

#include <memory>
#include <string>

#include <mitsuba/core/logger.h>

#include <hairlut.h>

NAMESPACE_BEGIN(mitsuba)

/// Compiled-in tables need no release, loaded ones do.
class HairlutTables {
public:
    explicit HairlutTables(const std::string &model) : m_model(hairlut_builtin(model.c_str())) {
        if (!m_model)
            load(model);
    }
    const hairlut_model *get() const { return m_model; }

private:
    struct Release {
        void operator()(hairlut_model *model) const { hairlut_free(model); }
    };
    void load(const std::string &directory) {
        hairlut_model *loaded = nullptr;
        char message[HAIRLUT_MESSAGE_SIZE] = "";
#ifdef HAIRLUT_WITHOUT_EXR
        const hairlut_result result = HAIRLUT_ERROR_UNSUPPORTED;
#else
        const hairlut_result result = hairlut_load_with(directory.c_str(), nullptr, &loaded, message);
#endif
        if (result != HAIRLUT_OK)
            Throw("hairlut: model \"%s\" is neither \"printed\" nor \"fitted\" nor a directory of tables: %s (%s)",
                  directory, message, hairlut_result_string(result));
        m_loaded.reset(loaded);
        m_model = loaded;
    }

    std::unique_ptr<hairlut_model, Release> m_loaded;
    const hairlut_model *m_model;
};

NAMESPACE_END(mitsuba)
