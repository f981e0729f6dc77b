// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "nlos/formats/capture_file.h"
#include "nlos/preparation/gated_capture.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"
#include "renderer/gltf/gltf.h"
#include "renderer/scene_import/scene_import.h"

#include <filesystem>

namespace apps {
namespace {

constexpr int kMostFiles = 1000000;

struct ConvertArguments {
    std::vector<std::string> files;  ///< inputs, then the output
    bool steady = false;
    std::vector<double> gate_m;
    nlos::CaptureWriteSettings write;
    std::vector<std::string> overrides;
};

/// Translates a scene of another program; the glTF file goes beside the scene.json.
void convert_scene(const std::string& input, const std::string& output) {
    const std::string geometry = with_suffix(output, ".glb");
    core::check_targets({output, geometry}, {input});
    const renderer::ImportedScene scene = renderer::import_scene(input);
    const std::string name = std::filesystem::path(geometry).filename().string();
    renderer::write_gltf(geometry, scene.geometry);
    core::write_text_file(output, core::json_text(renderer::imported_scene_json(scene, name)));
    print_notes("not the same", scene.not_translated);
    note_written({output, geometry});
    outcome()["objects"] = scene.geometry.objects.size();
    print("wrote {} and {} ({} objects)\n", output, geometry, scene.geometry.objects.size());
}

void run(const ConvertArguments& arguments) {
    const std::vector<std::string> inputs(arguments.files.begin(), arguments.files.end() - 1);
    const std::string& output = arguments.files.back();
    ProgressBar bar("convert");
    const core::Progress progress = bar.progress();
    if (std::filesystem::path(output).extension() == ".json") {
        if (inputs.size() > 1)
            throw core::Error(inputs[1], "is a second input", "must be one scene");
        return convert_scene(inputs.front(), output);
    }
    nlos::check_capture_suffix(output, arguments.write);
    core::check_targets({output}, inputs);
    progress.stage(1, 2, "reading", 0.0, 0.0);
    core::Capture capture =
        nlos::read_capture(inputs, capture_options(arguments.overrides).capture);
    const core::TimeAxis axis = capture.time_axis;
    if (arguments.steady) {
        capture = nlos::gated_capture(capture, axis.opl_start_m, axis.num_bins * axis.bin_width_m);
    } else if (!arguments.gate_m.empty()) {
        capture = nlos::gated_capture(capture, arguments.gate_m[0], arguments.gate_m[1]);
    }
    progress.stage(2, 2, "writing", 1.0, 1.0);
    for (const std::string& note : capture.notes) print("read: {}\n", note);
    print_notes("not kept", nlos::write_capture(output, capture, arguments.write));
    note_written({output});
    outcome()["pairs"] = capture.transient.num_pairs();
    outcome()["bins"] = capture.transient.num_bins();
    outcome()["unit"] = std::string(core::enum_name(capture.unit));
    print("wrote {} ({} pairs x {} bins, {})\n",
          output,
          capture.transient.num_pairs(),
          capture.transient.num_bins(),
          core::enum_name(capture.unit));
}

void declare_convert(Command& command) {
    auto& arguments = command.runs<ConvertArguments>(run);
    command.settings = core::settings_help(CaptureOptions{});
    command
        .add_option("FILES",
                    arguments.files,
                    "IN: capture in any readable format, several files: the frames of a sequence; "
                    "or a scene of Mitsuba 3 with mitransient (.xml, .json) or of y-tal (.yaml). "
                    "OUT, the last: .h5 or .hdf5 (y-tal), .npz (NumPy), .exr (a streak image), "
                    ".mat (stanford-2018, or what --out-layout says); or scene.json, with "
                    "scene.glb beside it")
        ->type_name("FILE")
        ->expected(2, kMostFiles)
        ->required();
    command.add_option("--out-layout",
                       arguments.write.layout,
                       "Layout of OUT where its suffix has several: of .mat stanford-2018 "
                       "(MATLAB v5), stanford-fk-2019 (MATLAB v7.3) or conv-nlos (MATLAB v5)");
    CLI::Option* steady =
        command.add_flag("--steady", arguments.steady, "Sum over all bins: a steady-state image");
    command
        .add_option("--gate-m",
                    arguments.gate_m,
                    "Sum over a time gate: its start and width [m of path length]")
        ->type_name("START WIDTH")
        ->expected(2)
        ->excludes(steady);
    command.add_flag("--for-ytal",
                     arguments.write.for_ytal,
                     "HDF5 without the group /nlos, with which y-tal refuses files");
    add_capture_options(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kConvertCommand{
    "convert",
    "Write a capture in another format, or a scene of Mitsuba or y-tal as one of ours",
    "nlos convert data/letter.h5 letter.exr",
    declare_convert};

}  // namespace apps
