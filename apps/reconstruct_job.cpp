// SPDX-License-Identifier: MIT
#include "apps/reconstruct_job.h"

#include "apps/arguments.h"
#include "apps/terminal.h"
#include "nlos/formats/picture.h"
#include "nlos/formats/ply_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures.h"
#include "renderer/core/output_file.h"

namespace apps {

nlos::Reconstruction reconstruct_to_file(const std::string& capture_path,
                                         const std::vector<std::string>& overrides,
                                         const std::string& volume_path,
                                         const std::string& ply_path) {
    // A target that cannot be written is found before the work, not after it.
    const core::OutputFile probe(volume_path);
    ReconstructOptions options;
    for (const std::string& text : overrides) core::apply_override(options, text);
    const core::Capture capture = nlos::read_capture(capture_path, options.capture);

    ProgressBar bar("reconstruct");
    nlos::Reconstruction result = nlos::reconstruct(capture, options.reconstruct, bar.progress());
    nlos::write_volume(volume_path, result);
    nlos::write_panels_png(with_suffix(volume_path, ".png"), nlos::volume_panels(result), 2);
    if (!ply_path.empty()) nlos::write_ply(ply_path, result.points);
    return result;
}

}  // namespace apps
