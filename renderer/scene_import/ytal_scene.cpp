// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene_import/foreign_file.h"
#include "renderer/scene_import/imported_shapes.h"
#include "renderer/scene_import/key_reader.h"

#include <fmt/core.h>

#include <array>

namespace renderer {
namespace {

using core::Json;
using core::Vec3;

/// Part of the wall that the laser scans, from 0 to 1 along its x and y.
struct Aperture {
    std::array<double, 2> start{0.0, 0.0};
    std::array<double, 2> end{1.0, 1.0};

    bool is_whole() const { return start == Aperture{}.start && end == Aperture{}.end; }
};

class YtalImport {
 public:
    YtalImport(const Json& config, const std::string& path)
        : keys_(config, path + ": "), path_(path) {}

    ImportedScene read() {
        read_axis();
        read_geometry();
        read_scan();
        set_bounces({keys_.get("integrator_filter_bounces", -1),
                     keys_.get("integrator_max_depth", -1),
                     keys_.get("integrator_nlos_laser_sampling", true)},
                    scene_);
        keys_.ignore({"name", "mitsuba_variant", "description", "histogram_mode"});
        if (keys_.find("laser_emission") != nullptr) note_laser_power("laser_emission", scene_);
        for (const std::string& key : keys_.unread()) note(key, "is not translated");
        return std::move(scene_);
    }

 private:
    void note(const std::string& key, const std::string& text) {
        scene_.not_translated.push_back(key + ": " + text);
    }

    void read_axis() {
        const std::string mode = keys_.get<std::string>("histogram_mode", "time");
        if (mode != "time") {
            throw core::Error(keys_.where("histogram_mode"), "found " + mode, "must be time");
        }
        SceneTimeAxis& axis = scene_.description.time_axis;
        axis.num_bins = keys_.get("num_bins", 4096);
        axis.bin_width_m = keys_.get("bin_width_opl", 0.003);
        axis.opl_start_m = keys_.get("start_opl", 0.0);
        axis.automatic = keys_.get("auto_detect_bins", false);
    }

    Vec3 point(const std::string& name, const Vec3& otherwise) {
        return {keys_.get(name + "_x", otherwise.x()),
                keys_.get(name + "_y", otherwise.y()),
                keys_.get(name + "_z", otherwise.z())};
    }

    void read_scan() {
        ScanSettings& scan = scene_.description.scan;
        const Vec3 usual(-0.5, 0.0, 0.25);
        scan.laser_m = point("laser", usual);
        scan.detector_m = point("sensor", usual);
        if (keys_.get("account_first_and_last_bounces", false)) {
            scan.opl_origin = core::OplOrigin::Device;
        }
        scan.sensing_points = {keys_.get("sensor_width", 256), keys_.get("sensor_height", 256)};
        const std::string type = keys_.get<std::string>("scan_type", "single");
        const std::array<int, 2> lit{keys_.get("laser_width", 32), keys_.get("laser_height", 32)};
        const Aperture aperture = read_aperture();
        if (type == "single") {
            scan.pattern = core::ScanPattern::Single;
            aim_laser(scan);
        } else if (type == "confocal") {
            scan.pattern = core::ScanPattern::Confocal;
            if (lit != scan.sensing_points) {
                throw core::Error(
                    keys_.where("laser_width"),
                    fmt::format("found {} x {} laser points for {} x {} of the sensor",
                                lit[0],
                                lit[1],
                                scan.sensing_points[0],
                                scan.sensing_points[1]),
                    "must be as many in a confocal scan");
            }
            if (!aperture.is_whole()) shrink_wall(aperture);
        } else if (type == "exhaustive") {
            scan.pattern = core::ScanPattern::Exhaustive;
            scan.illumination_points = lit;
            if (!aperture.is_whole()) light_part(aperture, lit);
        } else {
            throw core::Error(keys_.where("scan_type"),
                              "found " + type.substr(0, 60),
                              "must be single, confocal or exhaustive");
        }
    }

    Aperture read_aperture() {
        Aperture aperture;
        constexpr std::array<const char*, 2> kAxes{"x", "y"};
        for (std::size_t i = 0; i < 2; ++i) {
            const std::string axis = kAxes[i];
            aperture.start[i] = keys_.get("laser_aperture_start_" + axis, 0.0);
            const double end = keys_.get("laser_aperture_end_" + axis, 1.0);
            aperture.end[i] = end == 0.0 ? 1.0 : end;  // y-tal takes 0 for not given
            if (aperture.start[i] < 0.0 || aperture.end[i] > 1.0 ||
                aperture.start[i] >= aperture.end[i]) {
                throw core::Error(
                    keys_.where("laser_aperture_start_" + axis),
                    fmt::format("found {:g} to {:g}", aperture.start[i], aperture.end[i]),
                    "must grow, from 0 to 1");
            }
        }
        return aperture;
    }

    /// A place on the wall, 0 to 1 along its x and y.
    Vec3 on_wall(double u, double v) const {
        const RelayWall& wall = scene_.description.relay_wall;
        const Vec3 y = wall.up * wall.size_m[1];
        return wall.center_m + (u - 0.5) * wall.size_m[0] * wall_x_ + (v - 0.5) * y;
    }

    void aim_laser(ScanSettings& scan) {
        const auto fraction = [&](const char* key, int count) {
            const double pixel = keys_.get(key, 0.0);  // y-tal takes 0 for not given
            return pixel == 0.0 ? 0.5 : pixel / count;
        };
        scan.illumination_m = on_wall(fraction("laser_lookat_x", scan.sensing_points[0]),
                                      fraction("laser_lookat_y", scan.sensing_points[1]));
    }

    /// The grid of a confocal scan covers the wall, which is therefore cut to the scanned part.
    void shrink_wall(const Aperture& aperture) {
        RelayWall& wall = scene_.description.relay_wall;
        wall.center_m = on_wall(0.5 * (aperture.start[0] + aperture.end[0]),
                                0.5 * (aperture.start[1] + aperture.end[1]));
        for (std::size_t i = 0; i < 2; ++i) wall.size_m[i] *= aperture.end[i] - aperture.start[i];
        note("laser_aperture",
             "the relay wall is its scanned part here, and scatters no light beside it");
    }

    void light_part(const Aperture& aperture, const std::array<int, 2>& count) {
        ScanSettings& scan = scene_.description.scan;
        constexpr double kMostPoints = 1e7;
        if (static_cast<double>(count[0]) * count[1] > kMostPoints) {
            throw core::Error(keys_.where("laser_width"),
                              "found too many laser points",
                              "must be at most 1e7 in all");
        }
        const auto along = [&](std::size_t axis, int i) {
            return aperture.start[axis] +
                   (i + 0.5) / count[axis] * (aperture.end[axis] - aperture.start[axis]);
        };
        for (int ix = 0; ix < count[0]; ++ix) {
            for (int iy = 0; iy < count[1]; ++iy) {
                scan.illumination_points_m.push_back(on_wall(along(0, ix), along(1, iy)));
            }
        }
        scan.illumination_normals.assign(scan.illumination_points_m.size(),
                                         scene_.description.relay_wall.normal);
    }

    void read_geometry() {
        const Json* list = keys_.find("geometry");
        if (list == nullptr || !list->is_array()) {
            core::throw_wrong_type(
                keys_.where("geometry"), list == nullptr ? Json() : *list, "a list of objects");
        }
        const std::string wall_name = keys_.get<std::string>("relay_wall", "relay_wall");
        bool has_wall = false;
        for (std::size_t i = 0; i < list->size(); ++i) {
            has_wall =
                read_object((*list)[i], keys_.where(fmt::format("geometry[{}]", i)), wall_name) ||
                has_wall;
        }
        if (has_wall) return;
        throw core::Error(keys_.where("relay_wall"),
                          "found " + wall_name.substr(0, 60),
                          "must be the name of a geometry");
    }

    /// Returns true for the relay wall.
    bool read_object(const Json& json, const std::string& where, const std::string& wall_name) {
        KeyReader keys(json, where);
        ForeignShape shape;
        shape.name = keys.get<std::string>("name", "");
        read_mesh(keys, shape);
        shape.to_world = read_transform(keys);
        shape.material = read_material(keys);
        keys.ignore({"description"});
        const bool is_wall = shape.name == wall_name;
        if (is_wall) {
            require_rectangle(shape, keys.where("mesh"));
            set_relay_wall(shape, where, scene_);
            wall_x_ = shape.to_world.linear().col(0).normalized();
        } else {
            add_shape(shape, path_, where, scene_);
        }
        for (const std::string& key : keys.unread())
            note(shape.name + "." + key, "is not translated");
        return is_wall;
    }

    static void read_mesh(KeyReader& keys, ForeignShape& shape) {
        const Json* mesh = keys.find("mesh");
        KeyReader parts(mesh == nullptr ? Json::object() : *mesh, keys.where("mesh"));
        shape.type = parts.get<std::string>("type", "");
        shape.filename = parts.get<std::string>("filename", "");
    }

    static core::Transform read_transform(KeyReader& keys) {
        const auto three = [&](const std::string& name, double otherwise) {
            std::array<double, 3> values{};
            constexpr std::array<const char*, 3> kAxes{"_x", "_y", "_z"};
            for (std::size_t i = 0; i < 3; ++i) {
                values[i] = keys.get(name + kAxes[i], otherwise);
                if (values[i] == 0.0) values[i] = otherwise;  // y-tal takes 0 for not given
            }
            return values;
        };
        const auto angles = three("rot_degrees", 0.0);
        core::Transform to_world = core::Transform::Identity();
        to_world.matrix() = translation(three("displacement", 0.0)) *
                            rotation({0, 0, 1}, angles[2]) * rotation({0, 1, 0}, angles[1]) *
                            rotation({1, 0, 0}, angles[0]) * scaling(three("scale", 1.0));
        return to_world;
    }

    Material read_material(KeyReader& keys) {
        const Json* json = keys.find("material");
        KeyReader parts(json == nullptr ? Json::object() : *json, keys.where("material"));
        const std::string id = parts.get<std::string>("id", "white");
        Material material;
        if (id == "white") {
            material.albedo = 1.0;
        } else if (id == "copper") {
            material = mitsuba_material({{"type", "roughconductor"},
                                         {"material", "Cu"},
                                         {"alpha", parts.get("alpha", 0.1)}},
                                        Json::object(),
                                        parts.where().substr(path_.size() + 2),
                                        scene_.not_translated);
        } else if (id == "custom") {
            const Json bsdf = parse_mitsuba_xml(
                parts.get<std::string>("text", ""), path_, "geometry material.text");
            material = mitsuba_material(bsdf,
                                        Json::object(),
                                        parts.where("text").substr(path_.size() + 2),
                                        scene_.not_translated);
        } else {
            throw core::Error(
                parts.where("id"), "found " + id.substr(0, 60), "must be white, copper or custom");
        }
        if (material.name.empty()) material.name = id;
        return material;
    }

    KeyReader keys_;
    const std::string& path_;
    ImportedScene scene_;
    Vec3 wall_x_ = Vec3::UnitX();  ///< along which columns of points run
};

}  // namespace

ImportedScene import_ytal(const core::Json& config, const std::string& path) {
    return YtalImport(config, path).read();
}

}  // namespace renderer
