// SPDX-License-Identifier: MIT
// The Python module `nlos._core`: the program's entry points, with NumPy arrays as views. What
// users see stands in nlos/__init__.py.
#include "apps/arguments.h"
#include "apps/python/bindings.h"
#include "apps/version.h"
#include "renderer/core/system/data_folder.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <filesystem>

namespace nb = nanobind;

namespace {

nb::handle g_error;
nb::handle g_failure;

void raise_error(const core::Error& error) {
    try {
        const nb::object raised = g_error(error.where(), error.found(), error.allowed());
        PyErr_SetObject(g_error.ptr(), raised.ptr());
    } catch (nb::python_error& other) {
        other.restore();
    }
}

void translate(const std::exception_ptr& thrown, void*) {
    try {
        std::rethrow_exception(thrown);
    } catch (const core::Error& error) {
        raise_error(error);
    } catch (const core::Failure& failure) {
        PyErr_SetString(g_failure.ptr(), failure.what());
    } catch (const std::filesystem::filesystem_error& error) {
        raise_error(core::Error(error.path1().string(),
                                "cannot be reached (" + error.code().message() + ")",
                                "must be a file or folder that can be"));
    }
}

}  // namespace

NB_MODULE(_core, module) {
    nb::set_leak_warnings(false);  // objects that live to the end of the process are no leak
    const nb::module_ errors = nb::module_::import_("nlos._errors");
    g_error = errors.attr("Error").inc_ref();  // as long as the process
    g_failure = errors.attr("Failure").inc_ref();
    nb::register_exception_translator(translate);
    module.attr("version") = apps::version_text();
    module.def("data_folder", core::data_folder);
    apps::command_line() = "Python module";
    python::bind_scene(module);
    python::bind_capture(module);
    python::bind_reconstruction(module);
    python::bind_fit(module);
    python::bind_work(module);
    python::bind_operators(module);
    python::bind_gradients(module);
}
