// SPDX-License-Identifier: MIT
// Third bounces of all objects of a scene, and the way back from a loss by H to one by the objects.
#include "apps/python/bindings.h"
#include "apps/python/capture_histograms.h"
#include "calib/third_bounce_vjp.h"
#include "renderer/core/settings/json_file.h"

#include <nanobind/stl/string.h>

#include <memory>
#include <numeric>

namespace python {
namespace {

namespace nb = nanobind;

/// The facets of all hidden objects in one mesh, and where each object's begin.
struct JoinedObjects {
    core::TriangleMesh mesh;
    std::vector<double> albedo;  ///< per facet
    std::vector<std::size_t> first_vertex{0};
    std::vector<std::size_t> first_facet{0};
};

JoinedObjects join(const renderer::SceneGeometry& geometry) {
    JoinedObjects joined;
    for (const renderer::Object& object : geometry.objects) {
        if (!renderer::traits_of(object.material.model).is_constant || !object.has_one_albedo() ||
            object.role == renderer::Role::RelayWall) {
            throw core::Error("scene: object " + object.name,
                              "is textured or has colours of vertices, is no Lambertian surface, "
                              "or the relay wall",
                              "must be Lambertian with one albedo, and hidden");
        }
        core::append_mesh(object.mesh, joined.mesh);
        joined.albedo.resize(joined.mesh.triangles.size(), object.material.albedo);
        joined.first_vertex.push_back(joined.mesh.vertices.size());
        joined.first_facet.push_back(joined.mesh.triangles.size());
    }
    return joined;
}

/// What third_bounce_vjp() returns beside H.
class ThirdBouncePullback {
 public:
    ThirdBouncePullback(JoinedObjects joined,
                        const core::WallScan& scan,
                        std::unique_ptr<const calib::ThirdBounceVjp> vjp)
        : joined_(std::move(joined)), scan_(scan), vjp_(std::move(vjp)) {}

    static Array<const double> histograms(nb::handle self) {
        const auto& all = nb::cast<const ThirdBouncePullback&>(self);
        return histogram_view(all.vjp_->histograms().data(), all.num_bins(), all.scan_, self);
    }

    nb::list pullback(nb::handle gradient) const {
        const auto by_value = values_from(gradient);
        calib::MeshGradients gradients = run_long(nb::none(), 0, [&](const core::Progress& report) {
            return vjp_->pullback(by_value, report);
        });
        nb::list objects;
        for (std::size_t i = 0; i + 1 < joined_.first_vertex.size(); ++i) {
            objects.append(
                nb::make_tuple(vertex_gradients(gradients, i), albedo_gradient(gradients, i)));
        }
        return objects;
    }

 private:
    std::size_t num_bins() const { return vjp_->histograms().size() / scan_.num_pairs(); }

    // dL/dH as [pair][bin].
    std::vector<double> values_from(nb::handle gradient) const {
        const auto array = doubles_from(gradient, "gradient");
        const std::size_t num_pairs = scan_.num_pairs();
        require_shape(shape_of(array), histogram_shape(scan_, num_bins()), "gradient");
        std::vector<double> values(array.size());
        for (std::size_t bin = 0; bin < num_bins(); ++bin) {
            for (std::size_t pair = 0; pair < num_pairs; ++pair) {
                values[pair * num_bins() + bin] = array.data()[bin * num_pairs + pair];
            }
        }
        return values;
    }

    Array<double> vertex_gradients(const calib::MeshGradients& gradients,
                                   std::size_t object) const {
        const core::Vec3* const all = gradients.vertices.data();
        return array_of(std::vector<core::Vec3>(all + joined_.first_vertex[object],
                                                all + joined_.first_vertex[object + 1]));
    }

    double albedo_gradient(const calib::MeshGradients& gradients, std::size_t object) const {
        const double* const all = gradients.albedo.data();
        return std::accumulate(
            all + joined_.first_facet[object], all + joined_.first_facet[object + 1], 0.0);
    }

    JoinedObjects joined_;
    core::WallScan scan_;
    std::unique_ptr<const calib::ThirdBounceVjp> vjp_;
};

ThirdBouncePullback make_pullback(const SceneObject& scene,
                                  const nb::object& scan,
                                  const nb::object& axis,
                                  const nb::dict& keywords) {
    auto settings = settings_from_python<calib::ThirdBounceVjpSettings>(keywords);
    ScannedScene scanned = scan_scene(scene, scan, axis, core::Json::object());
    const core::WallScan& wall_scan = scanned.scan.wall("scene");
    const renderer::SceneDescription& description = scanned.scene.description;
    if (description.time_axis.automatic) {
        throw core::Error("axis", "found auto", "must be opl_start_m, bin_width_m and num_bins");
    }
    settings.wall_albedo = description.relay_wall.albedo;
    JoinedObjects joined = join(scanned.scene.geometry);
    auto vjp = run_long(nb::none(), 0, [&](const core::Progress& report) {
        return std::make_unique<const calib::ThirdBounceVjp>(
            joined.mesh, joined.albedo, wall_scan, description.time_axis, settings, report);
    });
    return {std::move(joined), wall_scan, std::move(vjp)};
}

}  // namespace

void bind_gradients(nb::module_& module) {
    nb::class_<ThirdBouncePullback>(
        module, "ThirdBouncePullback", "From dL/dH to dL/d(vertices, albedo) of every object.")
        .def_prop_ro("H", &ThirdBouncePullback::histograms, "float64, in the shape of Capture.H")
        .def("__call__",
             &ThirdBouncePullback::pullback,
             nb::arg("gradient").none(),
             "dL/dH to a list of (dL/dvertices (N, 3), dL/dalbedo) per object.");
    module.def("third_bounce_pullback",
               &make_pullback,
               nb::arg("scene"),
               nb::arg("scan").none(),
               nb::arg("axis").none(),
               nb::arg("settings"));
}

}  // namespace python
