// SPDX-License-Identifier: MIT
#include "apps/commands/describe_file.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/light_range.h"
#include "renderer/scene/coincident_faces.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>

namespace apps {
namespace {

std::string describe_material(const renderer::Object& object) {
    const renderer::Material& material = object.material;
    std::string text =
        fmt::format("{}, albedo {:.3f}", core::enum_name(material.model), material.albedo);
    if (renderer::traits_of(material.model).has_lobe) {
        text += fmt::format(", roughness {:.2f}", material.roughness);
    }
    if (material.albedo_texture) text += " (textured)";
    if (!object.vertex_albedo.empty()) text += " (times the colours of vertices)";
    return text;
}

std::string vector_text(const core::Vec3& v) {
    return core::vector_text(v + core::Vec3::Zero());  // no -0
}

void print_object(std::string& out, const renderer::Object& object) {
    Eigen::AlignedBox3d box;
    for (const core::Vec3& vertex : object.mesh.vertices) box.extend(vertex);
    add_line(out,
             "object {}: {} triangles, role {}, {}, x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, "
             "z {:.4g} to {:.4g} m{}{}",
             object.name.empty() ? "(unnamed)" : object.name,
             object.mesh.triangles.size(),
             core::enum_name(object.role),
             describe_material(object),
             box.min().x(),
             box.max().x(),
             box.min().y(),
             box.max().y(),
             box.min().z(),
             box.max().z(),
             object.ellipsoidal_exclude ? ", left out of ellipsoidal connections" : "",
             object.velocity_m_per_s.norm() > 0.0
                 ? fmt::format(", moves by {} m/s", vector_text(object.velocity_m_per_s))
                 : "");
}

void print_camera(std::string& out, const renderer::Camera& camera) {
    add_line(out,
             "camera {}: at {} m, looks along {}, {:.3g} deg high",
             camera.name.empty() ? "(unnamed)" : camera.name,
             vector_text(camera.position),
             vector_text(camera.forward),
             core::kDegreesPerRadian * camera.fov_y_rad);
}

void print_size(std::string& out, const renderer::SceneGeometry& geometry) {
    Eigen::AlignedBox3d box;
    std::size_t triangles = 0;
    for (const renderer::Object& object : geometry.objects) {
        for (const core::Vec3& vertex : object.mesh.vertices) box.extend(vertex);
        triangles += object.mesh.triangles.size();
    }
    const core::Vec3 size = box.sizes();
    add_line(out,
             "size: {} objects, {} triangles, {:.4g} x {:.4g} x {:.4g} m",
             geometry.objects.size(),
             triangles,
             size.x(),
             size.y(),
             size.z());
}

// What of the geometry lies on other parts of it.
void print_coincident(std::string& out, const std::vector<renderer::CoincidentFaces>& faces) {
    if (!faces.empty()) add_line(out, "{}", renderer::describe(faces));
}

void print_warnings(std::string& out, const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) add_line(out, "warning: {}", warning);
}

// "key: value" lines, with the full key, of what differs from `usual`.
void print_differences(std::string& out,
                       const core::Json& json,
                       const core::Json& usual,
                       const std::string& prefix) {
    for (const auto& [key, value] : json.items()) {
        const core::Json other = usual.is_object() ? usual.value(key, core::Json()) : core::Json();
        if (value == other) continue;
        if (value.is_object()) {
            print_differences(out, value, other, prefix + key + ".");
        } else if (value.is_array() && value.flatten().size() > 4) {
            add_line(out, "  {}{}: {} items", prefix, key, value.size());
        } else {
            add_line(out,
                     "  {}{}: {}",
                     prefix,
                     key,
                     value.dump(-1, ' ', false, core::Json::error_handler_t::replace));
        }
    }
}

void print_measurement(std::string& out,
                       const renderer::SceneDescription& description,
                       const core::Scan& scan) {
    scan.visit(
        [&](const core::ImageScan& image) {
            const auto& [width, height] = image.camera.resolution;
            add_line(out, "camera: {} x {} pixels", width, height);
        },
        [&](const core::SensorScan& zones) {
            for (const std::string& line : core::describe_sensor(*zones.setup)) {
                add_line(out, "{}", line);
            }
        },
        [&](const core::WallScan& wall) {
            add_line(out,
                     "scan: {}, {} sensing points, {} illumination points, wall {:.4g} x {:.4g} m",
                     wall.name(),
                     wall.sensing.size(),
                     wall.illumination.size(),
                     description.relay_wall.size_m[0],
                     description.relay_wall.size_m[1]);
            const core::Transform pose = nlos::derive_wall_frame(wall).world_from_wall;
            add_line(out, "wall's frame: {}", nlos::describe_wall_frame(pose));
        });
}

void print_light(std::string& out,
                 const renderer::Scene& scene,
                 const core::Scan& scan,
                 const renderer::SceneDescription& description) {
    const auto range = renderer::find_light_range(scene, scan, description.render);
    core::TimeAxis axis = description.time_axis;
    if (range && !range->is_dark()) {
        const auto [first, last] = range->without_tails(0.001);
        add_line(out, "light: from {:.4g} to {:.4g} m of path length (99.8 % of it)", first, last);
        if (description.time_axis.automatic) {
            axis = renderer::choose_time_axis(range, scene, scan, description);
        }
    }
    add_line(out,
             "time axis: {:.4g} to {:.4g} m, {} bins of {:.4g} m ({:.4g} ps){}",
             axis.opl_start_m,
             axis.opl_end_m(),
             axis.num_bins,
             axis.bin_width_m,
             axis.bin_width_ps(),
             description.time_axis.automatic ? " (auto)" : "");
    if (!range) return;
    print_warnings(out, renderer::axis_warnings(*range, axis, description.frames));
}

}  // namespace

void describe_geometry(std::string& out, const std::string& path) {
    renderer::SceneGeometry geometry = renderer::load_geometry(path);
    add_line(out, "format: {}", renderer::geometry_format(path));
    renderer::SceneDescription alone;
    alone.geometry = path;
    for (const std::string& line : renderer::describe_frame(alone)) add_line(out, "{}", line);
    print_size(out, geometry);
    for (const renderer::Object& object : geometry.objects) print_object(out, object);
    for (const renderer::Camera& camera : geometry.cameras) print_camera(out, camera);
    const renderer::FacePrecedence precedence(geometry.objects);
    const double tolerance_m = renderer::coincidence_m(geometry.objects, {});
    print_coincident(out,
                     renderer::leave_out_covered_faces(geometry.objects, precedence, tolerance_m));
    print_warnings(out, geometry.warnings);
}

void describe_scene(std::string& out, const std::string& path) {
    const renderer::SceneDescription description = renderer::read_scene_description(path, {});
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::load_scene(description, scan);
    add_line(out, "format: scene description\ngeometry: {}", renderer::geometry_name(description));
    for (const std::string& line : renderer::describe_frame(description)) add_line(out, "{}", line);
    for (const renderer::Object& object : scene.objects()) print_object(out, object);
    print_coincident(out, scene.coincident_faces());
    print_warnings(out, scene.warnings());
    print_measurement(out, description, scan);
    print_light(out, scene, scan, description);
    add_line(out, "settings that differ from the defaults (nlos render --help lists all):");
    core::Json settings = core::write_value(description);
    settings.erase("geometry");
    print_differences(out, settings, core::write_value(renderer::SceneDescription{}), "");
}

}  // namespace apps
