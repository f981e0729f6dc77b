// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/nearest_name.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene_import/foreign_file.h"
#include "renderer/scene_import/imported_shapes.h"
#include "renderer/scene_import/key_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace renderer {
namespace {

using core::Json;
using core::Vec3;

constexpr std::array<const char*, 20> kShapes{
    "rectangle",    "cube",        "sphere",   "disk",       "cylinder",       "obj",    "ply",
    "stl",          "serialized",  "instance", "shapegroup", "linearcurve",    "hair",   "sdfgrid",
    "bsplinecurve", "heightfield", "merge",    "ellipsoids", "ellipsoidsmesh", "blender"};
constexpr const char* kSensor = "nlos_capture_meter";
constexpr std::array<const char*, 6> kLasers{
    "projector", "spot", "point", "directional", "collimated", "angulararea"};
constexpr std::array<const char*, 3> kIntegrators{
    "transient_nlos_path", "transientnlospath", "transientpath"};
template <class List>
bool is_one_of(const List& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

// From the unit cylinder to one from p0 to p1.
void stretch_cylinder(KeyReader& keys, core::Transform& to_world) {
    const Vec3 p0 = keys.get("p0", Vec3(Vec3::Zero()));
    const Vec3 axis = keys.get("p1", Vec3(Vec3::UnitZ())) - p0;
    const double radius = keys.get("radius", 1.0);
    if (!(axis.norm() > 0.0)) {
        throw core::Error(keys.where("p1"), "is p0", "must be another point");
    }
    const Vec3 hint = std::abs(axis.normalized().x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    to_world.translate(p0);
    to_world.rotate(core::frame_from_normal(axis.normalized(), hint));
    to_world.scale(Vec3(radius, radius, axis.norm()));
}

// True for a plugin that is a shape, by its type.
bool is_mitsuba_shape(const Json& plugin) {
    return is_one_of(kShapes, type_of(plugin));
}

// Takes type, file and place of a shape out of its keys, of which `key` names it when it has no id;
// its material stays to be read.
ForeignShape mitsuba_shape(KeyReader& keys, const std::string& key) {
    ForeignShape shape;
    shape.type = keys.get<std::string>("type", "");
    shape.name = keys.get<std::string>("id", key);
    shape.filename = keys.get<std::string>("filename", "");
    if (const Json* matrix = keys.find("to_world")) {
        shape.to_world = read_transform(*matrix, keys.where("to_world"));
    }
    if (shape.type == "sphere") {
        const Vec3 center = keys.get("center", Vec3(Vec3::Zero()));
        shape.to_world.translate(center).scale(keys.get("radius", 1.0));
    }
    if (shape.type == "cylinder") stretch_cylinder(keys, shape.to_world);
    keys.ignore({"flip_normals", "face_normals", "flip_tex_coords"});
    return shape;
}

/// A child of an object with this type, and its key.
std::pair<std::string, const Json*> child_of_type(const Json& object, const std::string& type) {
    for (const auto& [key, value] : object.items()) {
        if (type_of(value) == type) return {key, &value};
    }
    return {"", nullptr};
}

class MitsubaImport {
 public:
    MitsubaImport(const Json& root, const std::string& path) : root_(root), path_(path) {}

    ImportedScene read() {
        for (const auto& [key, value] : root_.items()) {
            if (is_mitsuba_shape(value) && child_of_type(value, kSensor).second != nullptr) {
                read_wall(key, value);
            }
        }
        if (!has_wall_) {
            throw core::Error(path_,
                              "has no shape with the sensor nlos_capture_meter",
                              "must be a scan of a relay wall, as mitransient has it");
        }
        for (const auto& [key, value] : root_.items()) read_child(key, value);
        aim_laser();
        return std::move(scene_);
    }

 private:
    std::string where(const std::string& key) const { return path_ + ": " + key; }

    void note(const std::string& key, const std::string& text) {
        scene_.not_translated.push_back(key + ": " + text);
    }

    void note_unread(const KeyReader& keys, const std::string& name) {
        for (const std::string& key : keys.unread()) {
            note(name.empty() ? key : name + "." + key, "is not translated");
        }
    }

    void read_child(const std::string& key, const Json& value) {
        const std::string type = type_of(value);
        if (key == "type" || key == "id" || key == wall_key_ || is_bsdf(value)) return;
        if (is_mitsuba_shape(value)) {
            read_shape(key, value);
        } else if (is_one_of(kIntegrators, type)) {
            read_integrator(key, value);
        } else if (is_one_of(kLasers, type) && !laser_) {
            read_laser(key, value);
        } else {
            note(key,
                 (type.empty() ? "a value" : "a plugin of type " + type) + " is not translated");
        }
    }

    /// The BSDF of a shape; Mitsuba's own where it has none.
    Material material_of(KeyReader& keys, const Json& value) {
        for (const auto& [key, child] : value.items()) {
            if (!leads_to_bsdf(child, root_)) continue;
            keys.find(key);
            return mitsuba_material(
                child, root_, keys.where(key).substr(path_.size() + 2), scene_.not_translated);
        }
        Material material;
        material.albedo = 0.5;
        return material;
    }

    void read_shape(const std::string& key, const Json& value) {
        KeyReader keys(value, where(key));
        ForeignShape shape = mitsuba_shape(keys, key);
        shape.material = material_of(keys, value);
        add_shape(shape, path_, where(key), scene_);
        note_unread(keys, key);
    }

    void read_wall(const std::string& key, const Json& value) {
        if (has_wall_) {
            throw core::Error(where(key), "is a second relay wall", "must be the only one");
        }
        KeyReader keys(value, where(key));
        ForeignShape shape = mitsuba_shape(keys, key);
        require_rectangle(shape, where(key));
        shape.material = material_of(keys, value);
        set_relay_wall(shape, where(key), scene_);
        const auto [sensor_key, sensor] = child_of_type(value, kSensor);
        keys.find(sensor_key);
        read_sensor(key + "." + sensor_key, *sensor);
        note_unread(keys, key);
        wall_key_ = key;
        has_wall_ = true;
    }

    void read_sensor(const std::string& key, const Json& value) {
        KeyReader keys(value, where(key));
        ScanSettings& scan = scene_.description.scan;
        scan.detector_m = keys.get("sensor_origin", Vec3(Vec3::Zero()));
        if (const Json* segments = keys.find("account_first_and_last_bounces")) {
            bool is_counted = false;
            core::read_value(*segments, keys.where("account_first_and_last_bounces"), is_counted);
            if (is_counted) scan.opl_origin = core::OplOrigin::Device;
            note(key,
                 "account_first_and_last_bounces is obeyed; newer versions of mitransient obey "
                 "the integrator's alone");
        }
        bool has_film = false;
        for (const auto& [film_key, film] : value.items()) {
            if (type_of(film) == "transient_hdr_film") {
                keys.find(film_key);
                read_film(key + "." + film_key, film);
                has_film = true;
            } else if (type_of(film).ends_with("film")) {
                throw core::Error(where(key + "." + film_key),
                                  "is a film of type " + type_of(film),
                                  "must be a transient_hdr_film");
            }
        }
        if (!has_film)
            throw core::Error(where(key), "has no film", "must have a transient_hdr_film");
        // Old scenes of one pixel, rendered again for every point.
        scan.sensing_points = {keys.get("original_film_width", scan.sensing_points[0]),
                               keys.get("original_film_height", scan.sensing_points[1])};
        const bool is_confocal = value.contains("original_film_width");
        scan.pattern = is_confocal ? core::ScanPattern::Confocal : core::ScanPattern::Single;
        keys.ignore({"type", "id"});
        note_unread(keys, key);
    }

    void read_film(const std::string& key, const Json& value) {
        KeyReader keys(value, where(key));
        ScanSettings& scan = scene_.description.scan;
        scan.sensing_points = {keys.get("width", 768), keys.get("height", 576)};
        scan.illumination_points = {keys.get("laser_scan_width", scan.sensing_points[0]),
                                    keys.get("laser_scan_height", scan.sensing_points[1])};
        SceneTimeAxis& axis = scene_.description.time_axis;
        axis.num_bins = keys.get("temporal_bins", 2048);
        axis.bin_width_m = keys.get("bin_width_opl", 0.003);
        axis.opl_start_m = keys.get("start_opl", 0.0);
        keys.ignore({"type", "id", "exhaustive_scan"});
        note_unread(keys, key);
    }

    void read_integrator(const std::string& key, const Json& value) {
        KeyReader keys(value, where(key));
        read_pattern(keys);
        ScanSettings& scan = scene_.description.scan;
        if (keys.get("account_first_and_last_bounces", false)) {
            scan.opl_origin = core::OplOrigin::Device;
        }
        ForeignBounces bounces;
        bounces.filter = keys.get("filter_bounces", keys.get("filter_depth", 0) - 1);
        bounces.max_depth = keys.get("max_depth", 6);
        bounces.laser_sampling = keys.get("nlos_laser_sampling", false);
        set_bounces(bounces, scene_);
        keys.ignore({"type", "id"});
        note_unread(keys, key);
    }

    void read_pattern(KeyReader& keys) {
        ScanSettings& scan = scene_.description.scan;
        const Json* value = keys.find("capture_type");
        if (value != nullptr) {
            const std::string name =
                core::lower_case(value->is_string() ? value->get<std::string>() : value->dump());
            if (name == "confocal" || name == "2") {
                scan.pattern = core::ScanPattern::Confocal;
            } else if (name == "exhaustive" || name == "3") {
                scan.pattern = core::ScanPattern::Exhaustive;
            } else if (name != "single" && name != "1") {
                core::throw_wrong_type(
                    keys.where("capture_type"), *value, "Single, Confocal or Exhaustive");
            }
        }
        if (scan.pattern == core::ScanPattern::Exhaustive &&
            !keys.get("force_equal_illumination_scanning", true)) {
            note(keys.where("force_equal_illumination_scanning").substr(path_.size() + 2),
                 "the laser's grid covers the whole wall here, whatever its field of view");
        }
    }

    void read_laser(const std::string& key, const Json& value) {
        KeyReader keys(value, where(key));
        laser_ = core::Transform::Identity();
        if (const Json* matrix = keys.find("to_world")) {
            laser_ = read_transform(*matrix, keys.where("to_world"));
        }
        laser_key_ = key;
        scene_.description.scan.laser_m = laser_->translation();
        if (keys.find("irradiance") != nullptr || keys.find("intensity") != nullptr) {
            note_laser_power(key, scene_);
        }
        keys.ignore({"type", "id", "fov", "cutoff_angle", "beam_width"});
        note_unread(keys, key);
    }

    /// A laser lights what lies along its z axis; programs that aim it by code leave no trace.
    void aim_laser() {
        ScanSettings& scan = scene_.description.scan;
        if (scan.pattern != core::ScanPattern::Single) return;
        const RelayWall& wall = scene_.description.relay_wall;
        scan.illumination_m = wall.center_m;
        if (!laser_) {
            note("emitter", "there is no laser; the wall's centre is lit");
            return;
        }
        const core::Transform wall_from_world = wall.world_from_wall().inverse();
        const Vec3 from = wall_from_world * Vec3(laser_->translation());
        const Vec3 along = wall_from_world.linear() * laser_->linear().col(2);
        const Vec3 spot = from - from.z() / along.z() * along;
        if (along.z() * from.z() < 0.0 && std::abs(spot.x()) <= 0.5 * wall.size_m[0] &&
            std::abs(spot.y()) <= 0.5 * wall.size_m[1]) {
            scan.illumination_m = wall.world_from_wall() * Vec3(spot.x(), spot.y(), 0.0);
            return;
        }
        note(laser_key_, "does not aim at the wall (code may have aimed it): its centre is lit");
    }

    const Json& root_;
    const std::string& path_;
    ImportedScene scene_;
    std::string wall_key_;
    bool has_wall_ = false;
    std::optional<core::Transform> laser_;
    std::string laser_key_;
};

}  // namespace

ImportedScene import_mitsuba(const core::Json& scene, const std::string& path) {
    return MitsubaImport(scene, path).read();
}

}  // namespace renderer
