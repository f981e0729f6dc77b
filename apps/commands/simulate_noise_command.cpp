// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "nlos/detector/detector.h"
#include "nlos/detector/sensor_counts.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace apps {
namespace {

struct NoiseArguments {
    std::string capture;
    std::string output;
    std::vector<std::string> overrides;
    bool of_sensor = false;
    int threads = 0;
};

/// What `--set` of simulate-noise reaches.
using NoiseOptions = WithCapture<nlos::DetectorSettings>;

constexpr std::array kNoiseShorthands{
    Shorthand{"--photons", "photons", "N", "Expected signal photons in the whole capture"},
    Shorthand{
        "--photons-per-point", "photons_per_point", "N", "... per measurement pair, on average"},
    Shorthand{"--exposure-s", "exposure_s", "T", "Time per pair [s]"},
    Shorthand{"--jitter-fwhm-ps", "response.jitter_fwhm_ps", "J", "Width of pulse and jitter [ps]"},
    Shorthand{"--tail-ps", "response.tail_ps", "T", "Mean of an exponential tail [ps]"},
    Shorthand{"--response-curve", "response.curve", "FILE", "Measured response instead"},
    Shorthand{"--dark-counts-hz", "dark_counts_hz", "R", "Dark counts [1/s]"},
    Shorthand{"--ambient", "ambient", "N", "Expected ambient counts in every bin"},
    Shorthand{"--dead-time-ns", "dead_time_ns", "T", "Blind time after a detection [ns]"},
    Shorthand{"--repetition-hz", "repetition_hz", "R", "Laser pulses per second [1/s]"},
    Shorthand{"--pile-up", "pile_up", "", "Record only the first photon of a pulse"},
    Shorthand{"--expected", "expected", "", "Write expected counts instead of random ones"},
    Shorthand{"--seed", "seed", "N", "Seed of the random numbers"}};

/// The sensor whose detector is asked for; one that is there and ignored is named.
std::optional<core::SensorSetup> sensor_of(const NoiseArguments& arguments,
                                           const core::Capture& capture) {
    std::optional<core::SensorSetup> setup = core::recorded_sensor(capture);
    if (arguments.of_sensor && !setup) {
        throw core::Error(arguments.capture,
                          "gives no sensor that --sensor could take the detector of",
                          "must come from a scan of pattern sensor");
    }
    if (setup && !arguments.of_sensor) {
        print("the capture is of the sensor {}; --sensor takes its detector\n", setup->model.title);
        setup.reset();
    }
    return setup;
}

void run(const NoiseArguments& arguments) {
    const core::ThreadLimit threads(arguments.threads);
    nlos::check_capture_suffix(arguments.output);
    core::check_targets({arguments.output}, {arguments.capture});
    NoiseOptions options;
    for (const std::string& text : arguments.overrides) core::apply_override(options, text);
    ProgressBar bar("simulate-noise");
    const core::Progress progress = bar.progress();
    progress.stage(1, 3, "reading", 0.0, 0.0);
    core::Capture capture = nlos::read_capture(arguments.capture, options.capture);
    const std::optional<core::SensorSetup> sensor = sensor_of(arguments, capture);
    if (sensor) {
        options.settings = nlos::detector_of(*sensor);
        for (const std::string& text : arguments.overrides) core::apply_override(options, text);
    }
    options.settings.response = core::resolve_scene_response(options.settings.response, capture);
    if (const auto warning = nlos::coarse_bins_warning(capture, options.settings)) {
        warn(*warning);
    }
    progress.stage(2, 3, "detecting", 0.0, 1.0);
    core::Capture noisy =
        sensor ? nlos::detect_by_sensor(*sensor, std::move(capture), options.settings)
               : nlos::detect(capture, options.settings);
    progress.stage(3, 3, "writing", 1.0, 1.0);
    noisy.scene_info["detector"]["program"] = version_text();
    noisy.scene_info["detector"]["command"] = command_line();
    print_notes("not kept", nlos::write_capture(arguments.output, noisy));

    const auto values = noisy.transient.values();
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    const double most = *std::max_element(values.begin(), values.end());
    note_written({arguments.output});
    outcome()["pairs"] = noisy.transient.num_pairs();
    outcome()["bins"] = noisy.transient.num_bins();
    outcome()["counts"] = sum;
    outcome()["most_in_a_bin"] = most;
    print("wrote {} ({} pairs x {} bins, {:.6g} {}counts, at most {:.6g} in a bin)\n",
          arguments.output,
          noisy.transient.num_pairs(),
          noisy.transient.num_bins(),
          sum,
          options.settings.expected ? "expected " : "",
          most);
}

void declare_simulate_noise(Command& command) {
    auto& arguments = command.runs<NoiseArguments>(run);
    command.settings = core::settings_help(NoiseOptions{});
    add_file_option(command, "CAPTURE", arguments.capture, "Capture in any readable format")
        ->required();
    add_output_option(command, arguments.output, "Capture to write (.h5, .npz, .exr, .mat)")
        ->required();
    add_shorthands(command, kNoiseShorthands, arguments.overrides);
    command.add_flag("--sensor",
                     arguments.of_sensor,
                     "Start from the detector of the capture's sensor, its crosstalk and what its "
                     "firmware cuts included");
    add_threads_option(command, arguments.threads);
    add_capture_options(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kSimulateNoiseCommand{"simulate-noise",
                                              "Turn a capture into what a detector counts",
                                              "nlos simulate-noise data/letter.h5 -o noisy.h5 "
                                              "--photons-per-point 1000 --jitter-fwhm-ps 60",
                                              declare_simulate_noise};

}  // namespace apps
