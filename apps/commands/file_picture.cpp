// SPDX-License-Identifier: MIT
#include "apps/commands/file_picture.h"

#include "apps/file_kind.h"
#include "apps/scene_truth.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"

namespace apps {

void write_picture(const std::vector<std::string>& paths,
                   const std::string& picture_path,
                   const nlos::CaptureReadSettings& settings) {
    const std::string& path = paths.front();
    const FileKind kind = kind_of_file(path);
    if (kind == FileKind::Scene) {
        return nlos::write_panels(
            picture_path, nlos::truth_panels(SceneTruth(path).depth_map()), 3);
    }
    if (kind == FileKind::Volume) {
        return nlos::write_panels(picture_path, nlos::volume_panels(nlos::read_volume(path)), 2);
    }
    if (kind == FileKind::Capture) {
        return nlos::write_panels(
            picture_path, nlos::capture_panels(nlos::read_capture(paths, settings)), 3);
    }
    throw core::Error(path, "has no picture", "must be a scene.json, a capture or a volume");
}

}  // namespace apps
