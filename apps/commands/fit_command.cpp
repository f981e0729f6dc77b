// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands/fit_job.h"
#include "apps/estimate_text.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

namespace apps {
namespace {

struct FitArguments {
    FitRequest request;
    int threads = 0;
};

std::string position_text(const core::Vec3& position_m, const core::Vec3& sigma_m) {
    return fmt::format("at ({}, {}, {}) m",
                       estimate_text(position_m.x(), sigma_m.x()),
                       estimate_text(position_m.y(), sigma_m.y()),
                       estimate_text(position_m.z(), sigma_m.z()));
}

void print_object(const calib::FittedObject& object) {
    print("{:<14} {}, turned +- {:.2g} deg",
          object.name,
          position_text(object.position_m, object.position_sigma_m),
          object.rotation_sigma_deg.norm());
    for (const auto& [name, estimate] : object.numbers) {
        print(", {} {}", name, estimate_text(estimate.value, estimate.sigma));
    }
    print("\n");
}

void note(const calib::FitResult& result) {
    core::Json& fields = outcome();
    for (const calib::FittedObject& object : result.objects) {
        core::Json json{{"name", object.name},
                        {"position_m", core::write_value(object.position_m)},
                        {"position_sigma_m", core::write_value(object.position_sigma_m)},
                        {"rotation_sigma_deg", core::write_value(object.rotation_sigma_deg)}};
        for (const auto& [name, estimate] : object.numbers) {
            json[name] = estimate.value;
            json[name + "_sigma"] = estimate.sigma;
        }
        fields["objects"].push_back(std::move(json));
    }
    for (const calib::FittedPoint& point : result.points) {
        fields["points"].push_back(
            {{"position_m", core::write_value(point.position_m)},
             {"position_sigma_m", core::write_value(point.position_sigma_m)}});
    }
    fields["converged"] = result.converged;
    fields["residual"] = result.residual;
    fields["deviance"] = result.deviance;
    fields["expected_deviance"] = result.expected_deviance;
    fields["iterations"] = result.iterations;
    fields["seconds_fit"] = result.seconds;
    fields["unidentifiable"] = result.unidentifiable;
}

void run(const FitArguments& arguments) {
    const core::ThreadLimit threads(arguments.threads);
    const FitRequest& request = arguments.request;
    const calib::FitResult result = fit_to_file(request);
    const std::string written = note_written({request.fit,
                                              with_suffix(request.fit, ".scene.json"),
                                              with_suffix(request.fit, ".glb"),
                                              with_suffix(request.fit, ".png"),
                                              request.picture});
    note(result);
    for (const calib::FittedObject& object : result.objects) print_object(object);
    for (const calib::FittedPoint& point : result.points) {
        print("point          {}\n", position_text(point.position_m, point.position_sigma_m));
    }
    print("wrote {} ({}, deviance {:.4g} of {:.4g} expected, {} iterations, {:.2f} s)\n",
          written,
          result.residual,
          result.deviance,
          result.expected_deviance,
          result.iterations,
          result.seconds);
    if (!result.converged) {
        // One line, as for every failure; the warnings stand in the file.
        throw core::Failure("fit",
                            fmt::format("not converged after {} iterations ({}); {} holds the "
                                        "state reached",
                                        result.iterations,
                                        result.message,
                                        request.fit));
    }
    for (const std::string& text : result.unidentifiable) {
        print_error("unidentifiable: {}\n", text);
    }
    for (const std::string& text : result.warnings) warn(text);
}

void declare_fit(Command& command) {
    auto& arguments = command.runs<FitArguments>(run);
    command.settings = core::settings_help(WithCapture<calib::FitSettings>{});
    add_file_option(command, "CAPTURE", arguments.request.capture, "Capture in any readable format")
        ->required();
    add_file_option(
        command, "MODEL", arguments.request.model, "What is fitted and from where (.json)")
        ->required();
    add_output_option(command,
                      arguments.request.fit,
                      "Fit to write (.json); the fitted scene and a picture go beside it")
        ->required();
    add_picture_option(command, arguments.request.picture);
    add_file_option(command,
                    "--calibration",
                    arguments.request.calibration,
                    "Calibration of the set-up (.json)");
    add_threads_option(command, arguments.threads);
    add_capture_options(command, arguments.request.overrides);
}

}  // namespace

extern const CommandRow kFitCommand{"fit",
                                    "Fit a hidden scene to a capture",
                                    "nlos fit data/letter.h5 scenes/letter/model.json -o fit.json",
                                    declare_fit};

}  // namespace apps
