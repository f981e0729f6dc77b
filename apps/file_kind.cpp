// SPDX-License-Identifier: MIT
#include "apps/file_kind.h"

#include "calib/fit_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/error.h"

#include <filesystem>

namespace apps {

FileKind kind_of_file(const std::string& path) {
    if (!std::filesystem::exists(path)) {
        throw core::Error(
            path, "does not exist", "must be a capture, volume, fit, scene.json, glTF or PLY file");
    }
    const std::string suffix = std::filesystem::path(path).extension().string();
    if (suffix == ".json") return calib::is_fit_file(path) ? FileKind::Fit : FileKind::Scene;
    if (suffix == ".glb" || suffix == ".gltf") return FileKind::Geometry;
    if (suffix == ".ply") return FileKind::PointCloud;
    return nlos::is_volume_file(path) ? FileKind::Volume : FileKind::Capture;
}

}  // namespace apps
