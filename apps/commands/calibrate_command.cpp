// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/estimate_text.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "calib/calibrate.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"

namespace apps {
namespace {

struct CalibrateArguments {
    std::string setup;
    std::string output;
    std::vector<std::string> overrides;
};

void run(const CalibrateArguments& arguments) {
    require_suffix(arguments.output, {".json"});
    core::check_targets({arguments.output}, {arguments.setup});
    std::vector<std::string> overrides = arguments.overrides;
    const auto reading = capture_options(take_capture_overrides(overrides)).capture;
    const calib::SetupSettings settings = calib::read_setup(arguments.setup, overrides);
    const ProgressBar bar("calibrate");
    const core::Capture capture = nlos::read_capture(settings.direct_returns, reading);
    const calib::Calibration calibration = calib::calibrate(settings, capture);
    core::Json json = calib::calibration_json(calibration);
    json["program"] = version_text();
    json["command"] = command_line();
    json["settings"] = core::write_value(settings);
    core::write_text_file(arguments.output, core::json_text(json));

    for (const std::string& text : calibration.warnings()) warn(text);
    const calib::SetupGeometry& setup = calibration.setup;
    for (std::size_t i = 0; i < setup.values.size(); ++i) {
        if (setup.sigma[i] == 0.0) continue;
        outcome()["values"][calib::kSetupNames[i]] = {{"value", setup.values[i]},
                                                      {"sigma", setup.sigma[i]}};
        print("{:<18} {}\n", calib::kSetupNames[i], estimate_text(setup.values[i], setup.sigma[i]));
    }
    const auto response = json["response"];
    print("{:<18} {:>11.6g} ps\n", "response FWHM", response["jitter_fwhm_ps"].get<double>());
    outcome()["response_fwhm_ps"] = response["jitter_fwhm_ps"];
    outcome()["points"] = setup.points_m.size();
    outcome()["condition_number"] = setup.uncertainty.condition_number;
    outcome()["range_rms_m"] = setup.verdict.fit.length_rms_m;
    note_written({arguments.output});
    print("wrote {} ({} points, condition number {:.3g}, path lengths off by {:.3g} mm rms)\n",
          arguments.output,
          setup.points_m.size(),
          setup.uncertainty.condition_number,
          1e3 * setup.verdict.fit.length_rms_m);
}

void declare_calibrate(Command& command) {
    auto& arguments = command.runs<CalibrateArguments>(run);
    command.settings = core::settings_help(WithCapture<calib::SetupSettings>{});
    add_file_option(command, "SETUP", arguments.setup, "Description of the measurements (.json)")
        ->required();
    add_output_option(command, arguments.output, "Calibration to write (.json)")->required();
    add_capture_options(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kCalibrateCommand{
    "calibrate",
    "Calibrate wall, spots, time zero and response of a set-up",
    "nlos calibrate data/setup.json -o calibration.json",
    declare_calibrate};

}  // namespace apps
