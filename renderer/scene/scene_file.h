// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/relay_wall.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/scene/object_table.h"
#include "renderer/settings/render_settings.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

using core::RelayWall;

/// How points pair up, or the text `sensor`, which leaves points and pairs to a sensor's zones.
struct ScanPatternSetting {
    core::ScanPattern pattern = core::ScanPattern::Confocal;
    bool of_sensor = false;

    ScanPatternSetting() = default;
    ScanPatternSetting(core::ScanPattern points) : pattern(points) {}
    operator core::ScanPattern() const { return pattern; }
};

/// A sensor: an object, or as text the name of one that comes with the program or of a file.
struct SensorSettings : core::SensorModel {
    std::string source;  ///< the text, until it has been read
};

/// Which wall points are illuminated and sensed. Explicit points replace the grids, and a sensor
/// replaces both.
struct ScanSettings {
    ScanPatternSetting pattern;
    std::array<int, 2> sensing_points{64, 64};
    std::optional<core::Vec3> illumination_m;
    std::array<int, 2> illumination_points{16, 16};
    core::OplOrigin opl_origin = core::OplOrigin::RelayWall;
    std::optional<core::Vec3> laser_m;
    std::optional<core::Vec3> detector_m;
    std::vector<core::Vec3> sensing_points_m;
    std::vector<core::Vec3> sensing_normals;
    std::vector<core::Vec3> illumination_points_m;
    std::vector<core::Vec3> illumination_normals;
    std::optional<SensorSettings> sensor;
    std::optional<core::SensorPose> pose;
    std::vector<core::SensorPose> poses;
    int subsamples = 3;
};

/// The camera that takes the place of relay wall and scan: an object, or as text the name alone.
struct CameraSettings : core::PinholeCamera {
    std::string name;  ///< of a glTF camera, which then gives pose and angle of view; or empty
};

/// A sequence: the gate moves by a step and the objects by their velocities from frame to frame.
struct FrameSettings {
    int count = 1;
    double gate_step_m = 0.0;
    double frame_s = 0.0;
};

/// The bins of path length: an object, or the text `auto`, which leaves the choice to geometry and
/// scan. A bin width in picoseconds, or one in metres of what was `auto`, leaves the choice of what
/// is not reported beside it.
struct SceneTimeAxis : core::TimeAxis {
    bool automatic = false;  ///< what is not reported is still to be chosen; see choose_time_axis()
    struct Stated {
        bool bin_width = false;
        bool opl_start = false;
        bool num_bins = false;
    };
    Stated stated{};  ///< of an automatic axis

    std::optional<double> bin_width_ps{};  ///< as read, before it becomes metres; likewise
    std::optional<double> opl_start_ps{};
};

/// What is known of the detector that will count the light.
struct SceneDetector {
    double jitter_fwhm_ps = 0.0;
};

struct GroundTruthSettings {
    std::array<int, 2> depth_resolution{256, 256};
};

/// What scene.json says.
struct SceneDescription {
    std::string folder;    ///< of scene.json; no key of it
    std::string geometry;  ///< glTF, OBJ, PLY or STL file; empty: the meshes of objects are all
    std::optional<double> geometry_unit_m;  ///< of OBJ, PLY and STL; nothing: metres are assumed
    std::optional<FileAxis> geometry_up;    ///< of OBJ, PLY and STL; nothing: y is assumed
    ObjectTable objects;
    RelayWall relay_wall;
    ScanSettings scan;
    std::optional<CameraSettings> camera;  ///< replaces relay_wall and scan
    SceneTimeAxis time_axis;
    std::optional<SceneDetector> detector;            ///< nothing: not known
    std::optional<core::VelocityAxis> velocity_axis;  ///< nothing: velocities are not resolved
    std::optional<FrameSettings> frames;              ///< nothing: one frame
    RenderSettings render;
    GroundTruthSettings ground_truth;
};

/// A pattern is a text.
void read_value(const core::Json& json, const std::string& where, ScanPatternSetting& pattern);
core::Json write_value(const ScanPatternSetting& pattern);

template <class Visitor>
void for_each_field(SensorSettings& sensor, Visitor&& visit) {
    for_each_field(static_cast<core::SensorModel&>(sensor), visit);
}

/// A sensor is an object with fields, or a name.
void read_value(const core::Json& json, const std::string& where, SensorSettings& sensor);
core::Json write_value(const SensorSettings& sensor);

template <class Visitor>
void for_each_field(ScanSettings& scan, Visitor&& visit) {
    visit("pattern",
          scan.pattern,
          "how illumination and sensing points pair up (single|confocal|exhaustive), or sensor");
    visit("sensing_points",
          scan.sensing_points,
          core::at_least(1, "grid of sensing points at cell centres, along wall x by wall y"));
    visit("illumination_m", scan.illumination_m, "single: the laser spot, world [m]");
    visit("illumination_points",
          scan.illumination_points,
          core::at_least(1, "exhaustive: grid of laser spots"));
    visit("opl_origin", scan.opl_origin, "where path lengths start and end");
    visit("laser_m", scan.laser_m, "laser position, world [m]; needed for opl_origin device");
    visit("detector_m", scan.detector_m, "detector position, world [m]; likewise");
    visit("sensing_points_m", scan.sensing_points_m, "explicit sensing points, world [m]");
    visit("sensing_normals", scan.sensing_normals, "their normals, towards the hidden side");
    visit("illumination_points_m", scan.illumination_points_m, "explicit laser spots, world [m]");
    visit("illumination_normals", scan.illumination_normals, "their normals");
    visit("sensor",
          scan.sensor,
          "sensor: vl53l8, tmf8828, tmf8829, a .json file, or an object such as these hold");
    visit("pose", scan.pose, "sensor: where it is and looks; position_m, forward, up");
    visit("poses", scan.poses, "sensor: a pose per frame instead");
    visit("subsamples",
          scan.subsamples,
          core::Ranged{"sensor: points per zone and axis that are lit and sensed",
                       {1, true, 64, true}});
}

template <class Visitor>
void for_each_field(CameraSettings& camera, Visitor&& visit) {
    visit("name", camera.name, "glTF camera that gives position, view and fov_y_deg");
    for_each_field(static_cast<core::PinholeCamera&>(camera), visit);
}

/// A camera is an object with fields or the name of a glTF camera.
void read_value(const core::Json& json, const std::string& where, CameraSettings& camera);

template <class Visitor>
void for_each_field(SceneTimeAxis& axis, Visitor&& visit) {
    for_each_field(static_cast<core::TimeAxis&>(axis), visit);
    visit("bin_width_ps",
          axis.bin_width_ps,
          core::above(0,
                      "instead of bin_width_m: width of a bin in time [ps]; start and number of "
                      "bins are automatic where they are not given beside it"));
    visit("opl_start_ps",
          axis.opl_start_ps,
          core::Ranged{"instead of opl_start_m: time at the start of bin 0 [ps]", {}});
}

template <class Visitor>
void for_each_field(SceneDetector& detector, Visitor&& visit) {
    visit("jitter_fwhm_ps",
          detector.jitter_fwhm_ps,
          core::at_least(0,
                         "full width at half maximum of pulse and jitter: bins of an automatic "
                         "time axis are fine enough for it, and simulate-noise takes it [ps]"));
}

/// A time axis is an object with fields or the text `auto`.
void read_value(const core::Json& json, const std::string& where, SceneTimeAxis& axis);
core::Json write_value(const SceneTimeAxis& axis);

template <class Visitor>
void for_each_field(FrameSettings& frames, Visitor&& visit) {
    visit("count", frames.count, core::at_least(1, "number of frames"));
    visit("gate_step_m", frames.gate_step_m, "by which the time axis moves per frame [m]");
    visit("frame_s", frames.frame_s, core::at_least(0, "in which objects move on per frame [s]"));
}

template <class Visitor>
void for_each_field(GroundTruthSettings& truth, Visitor&& visit) {
    visit("depth_resolution",
          truth.depth_resolution,
          core::at_least(1, "columns of the true depth map, along wall x by wall y"));
}

template <class Visitor>
void for_each_field(SceneDescription& scene, Visitor&& visit) {
    visit("geometry", scene.geometry, "glTF 2.0 file (.glb or .gltf), .obj, .ply or .stl");
    visit("geometry_unit_m",
          scene.geometry_unit_m,
          core::above(0, "unit of an .obj, .ply or .stl file [m]; null: metres are assumed"));
    visit("geometry_up",
          scene.geometry_up,
          "axis of such a file that is the world's y; null: y is assumed");
    visit("objects",
          scene.objects,
          "more meshes, placed (mesh, scale, up, rotation_deg, translation_m, material), and, by "
          "name, in place of what the file says: material, role (hidden|relay_wall|back_wall), "
          "albedo, velocity_m_per_s, retroreflective, ellipsoidal_exclude");
    visit("relay_wall", scene.relay_wall, "the wall that laser and detector see");
    visit("scan", scene.scan, "points on the wall");
    visit("camera",
          scene.camera,
          "instead of relay_wall and scan: an image; position_m, look_at_m, up, fov_y_deg, "
          "resolution, light_m, light_spot_m, or the name of a glTF camera");
    visit("time_axis", scene.time_axis, "bins of optical path length, or auto");
    visit("detector", scene.detector, "what is known of the detector that will count the light");
    visit("velocity_axis",
          scene.velocity_axis,
          "Doppler: bins of path velocity; start_m_per_s, bin_width_m_per_s, num_bins, with_time, "
          "carrier_hz");
    visit("frames", scene.frames, "a sequence: count, gate_step_m, frame_s; seconds are per frame");
    visit("render", scene.render, "estimator and effort");
    visit("ground_truth", scene.ground_truth, "what compare uses as truth");
}

/// Reads scene.json and applies `--set key.path=value` texts to it. A camera that is named gets its
/// pose from the glTF file.
/// throws   core::Error naming file, key, what was found and what is allowed
SceneDescription read_scene_description(const std::string& path,
                                        std::vector<std::string> overrides);

/// Changes a description, valid or of defaults, by keys of scene.json with new values.
/// throws   core::Error naming key, what was found and what is allowed
void change_description(SceneDescription& scene, const core::Json& changes);

/// Throws core::Error naming the key that is out of range.
void validate(const SceneDescription& scene, const std::string& where);

/// The wall points, with unit normals, or the camera that the description asks for.
/// scene   a validated description
core::Scan make_scan(const SceneDescription& scene);

/// The inverse for a scan of wall points, which are given one by one.
void describe_scan(const core::WallScan& scan, ScanSettings& settings);

/// Makes a description refer to a glTF file that holds its objects as they are.
void refer_to_gltf(const std::string& file_name, SceneDescription& scene);

/// True when the scan's points all lie on the description's rectangle, which is then a surface of
/// the scene; explicit points may lie elsewhere, on a curved wall for instance.
bool rectangle_carries_scan(const RelayWall& wall, const core::WallScan& scan);

}  // namespace renderer
