// SPDX-License-Identifier: MIT
// Slips in describing captures of rendered scenes: are they seen, named, and not seen where there
// are none? Prints the table of slips and scenes.
#include "apps/bench/scene.h"
#include "nlos/preparation/capture_check.h"
#include "renderer/core/random.h"
#include "renderer/core/scan_extent.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

namespace apps {
namespace {

using core::Capture;

const std::vector<std::string> kScenes{"letter", "animal", "bars", "corner", "curved"};
const std::vector<std::string> kAxis{"time_axis.bin_width_m=0.012", "time_axis.num_bins=256"};
const std::vector<std::string> kConfocal{"scan.sensing_points=[16,16]"};
const std::vector<std::string> kOblong{"scan.sensing_points=[18,12]",
                                       "relay_wall.size_m=[1.2,0.8]"};
const std::vector<std::string> kSingle{
    "scan.sensing_points=[16,16]", "scan.pattern=single", "scan.illumination_m=[-0.35,0.2,0]"};
const std::vector<std::string> kDevices{"scan.sensing_points=[16,16]",
                                        "scan.opl_origin=device",
                                        "scan.laser_m=[-0.6,-0.3,-1.2]",
                                        "scan.detector_m=[0.4,0.2,-1.0]",
                                        "time_axis.opl_start_m=1.8",
                                        "time_axis.bin_width_m=0.016"};

/// The capture of a scene, without noise. The curved wall has points of its own.
Capture render(const std::string& scene, std::vector<std::string> overrides) {
    overrides.insert(overrides.begin(), kAxis.begin(), kAxis.end());
    if (scene == "curved") {
        std::erase_if(overrides, [](const std::string& text) {
            return text.starts_with("scan.sensing_points=") || text.starts_with("relay_wall.");
        });
    }
    overrides.emplace_back("render.method=third_bounce");
    overrides.emplace_back("render.max_bounces=3");
    overrides.emplace_back("render.by_order=false");
    const BenchScene bench(NLOS_SOURCE_DIR "/scenes/" + scene + "/scene.json", overrides);
    return bench.render(bench.settings());
}

/// Poisson counts, `peak` in the brightest bin over an ambient light of 1 % of that.
Capture counted(const Capture& capture, double peak) {
    Capture counts = capture;
    counts.unit = core::TransientUnit::Counts;
    const double most = *std::ranges::max_element(capture.transient.values());
    std::mt19937 random(7);
    for (float& value : counts.transient.values()) {
        const double mean = peak * (static_cast<double>(value) / most + 0.01);
        value = static_cast<float>(std::poisson_distribution<int>(mean)(random));
    }
    return counts;
}

void scale_lengths(Capture& capture, double factor) {
    capture.time_axis.bin_width_m *= factor;
    capture.time_axis.opl_start_m *= factor;
}

void scale_wall(Capture& capture, double factor) {
    const core::ScanExtent extent = core::scan_extent(capture.scan);
    for (core::WallPoints* points : {&capture.scan.sensing, &capture.scan.illumination}) {
        if (points->size() < 2) continue;
        for (core::Vec3& position : points->positions) {
            for (int i = 0; i < 2; ++i) {
                const double offset = extent.axes[i].dot(position) - extent.middle_m[i];
                position += (factor - 1.0) * offset * extent.axes[i];
            }
        }
    }
}

void swap_axes(Capture& capture) {
    const auto [nx, ny] = *capture.scan.sensing.grid;
    const core::Transient right = capture.transient;
    for (std::size_t x = 0; x < nx; ++x) {
        for (std::size_t y = 0; y < ny; ++y) {
            std::ranges::copy(right.histogram(x * ny + y),
                              capture.transient.histogram(y * nx + x).begin());
        }
    }
}

void reverse_time(Capture& capture) {
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        std::ranges::reverse(capture.transient.histogram(pair));
    }
}

/// Leaves the direct return in, twenty times as bright as all else, and time zero off by it.
void add_direct_return(Capture& capture, double offset_m) {
    const core::Scan& scan = capture.scan;
    const float most = *std::ranges::max_element(capture.transient.values());
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const double opl = (scan.illumination.positions[scan.illumination_index(pair)] -
                            scan.sensing.positions[scan.sensing_index(pair)])
                               .norm();
        const auto bin = capture.time_axis.bin_of(opl);
        if (bin) capture.transient.histogram(pair)[static_cast<std::size_t>(*bin)] += 20.0F * most;
    }
    capture.time_axis.opl_start_m += offset_m;
}

/// A slip, the scan that it is tried on, and how its remedy reads.
struct Slip {
    std::string name;
    std::vector<std::string> scan;
    std::function<void(Capture&)> make;
    std::function<std::string(const Capture& right)> remedy;
};

std::string bins_of(const Capture& right) {
    return fmt::format("capture.bin_width_m={:.6g}", right.time_axis.bin_width_m);
}

std::string wall_of(const Capture& right) {
    const core::ScanExtent extent = core::scan_extent(right.scan);
    return fmt::format("capture.wall_size_m=[{:.6g},{:.6g}]", extent.size_m[0], extent.size_m[1]);
}

std::function<std::string(const Capture&)> text(const std::string& remedy) {
    return [remedy](const Capture&) { return remedy; };
}

std::vector<Slip> all_slips() {
    const auto lengths = [](double factor) {
        return [factor](Capture& capture) { scale_lengths(capture, factor); };
    };
    const auto wall = [](double factor) {
        return [factor](Capture& capture) { scale_wall(capture, factor); };
    };
    const auto origin = [](core::OplOrigin stated) {
        return [stated](Capture& capture) { capture.scan.opl_origin = stated; };
    };
    return {
        {"ps taken for ns", kConfocal, lengths(1e3), bins_of},
        {"ns taken for ps", kConfocal, lengths(1e-3), bins_of},
        {"ps taken for s", kConfocal, lengths(1e12), bins_of},
        {"s taken for m", kConfocal, lengths(1.0 / core::kSpeedOfLight), bins_of},
        {"lengths doubled", kConfocal, lengths(2.0), bins_of},
        {"lengths doubled, single", kSingle, lengths(2.0), bins_of},
        {"lengths halved", kConfocal, lengths(0.5), bins_of},
        {"lengths halved, single", kSingle, lengths(0.5), bins_of},
        {"half width for width", kConfocal, wall(0.5), wall_of},
        {"width for half width", kConfocal, wall(2.0), wall_of},
        {"half width, single", kSingle, wall(0.5), wall_of},
        {"legs in, said out",
         kDevices,
         origin(core::OplOrigin::RelayWall),
         text("capture.opl_origin=device")},
        {"x and y swapped", kOblong, swap_axes, text("capture.swap_xy=true")},
        {"time reversed", kConfocal, reverse_time, text("capture.flip_t=true")},
        {"time reversed, single", kSingle, reverse_time, text("capture.flip_t=true")},
        {"direct return 1.3 m late",
         kConfocal,
         [](Capture& capture) { add_direct_return(capture, 1.3); },
         text("capture.opl_shift_m=-1.3")},
    };
}

/// Whether nothing in the data speaks against a slip, for a reason that geometry gives.
bool cannot_be_told(const std::string& slip, const std::string& scene) {
    // Points of the curved wall are a list: there are no axes to swap.
    return scene == "curved" && slip.starts_with("x and y");
}

/// Captures by scan, each scene rendered once per scan.
const Capture& right_capture(const std::string& scene, const std::vector<std::string>& scan) {
    static std::map<std::string, Capture> rendered;
    const std::string key = fmt::format("{} {}", scene, fmt::join(scan, " "));
    if (!rendered.contains(key)) rendered.emplace(key, render(scene, scan));
    return rendered.at(key);
}

std::string warnings_of(const Capture& capture) {
    return fmt::format("{}", fmt::join(nlos::capture_warnings(capture), " | "));
}

TEST(Slips, AreRecognisedAndRightlyNamed) {
    int tried = 0;
    int named = 0;
    fmt::print("{:<26}", "");
    for (const std::string& scene : kScenes) fmt::print("{:<14}", scene);
    fmt::print("\n");
    for (const Slip& slip : all_slips()) {
        fmt::print("{:<26}", slip.name);
        for (const std::string& scene : kScenes) {
            std::string cell;
            if (!cannot_be_told(slip.name, scene)) {
                const Capture& right = right_capture(scene, slip.scan);
                for (const double peak : {0.0, 100.0, 20.0}) {
                    Capture capture = right;
                    slip.make(capture);
                    if (peak > 0.0) capture = counted(capture, peak);
                    const bool is_named =
                        warnings_of(capture).find(slip.remedy(right)) != std::string::npos;
                    ++tried;
                    named += is_named ? 1 : 0;
                    cell += is_named ? "yes " : "no ";
                }
            }
            fmt::print("{:<14}", cell.empty() ? "-" : cell);
        }
        fmt::print("\n");
    }
    fmt::print("{} of {} named\n", named, tried);
    EXPECT_GE(named, 0.8 * tried);  // the aim is 0.95
}

TEST(Slips, AreNotSeenInCapturesThatAreRight) {
    const std::vector<std::vector<std::string>> scans{
        kConfocal,
        kOblong,
        kSingle,
        kDevices,
        {"scan.sensing_points=[16,16]", "relay_wall.size_m=[2,2]"},
        {"scan.sensing_points=[12,12]", "relay_wall.size_m=[0.5,0.5]"},
        {"scan.sensing_points=[5,5]"},
        {"scan.sensing_points=[16,16]",
         "relay_wall.normal=[0.2,0.1,1]",
         "relay_wall.center_m=[0.1,-0.1,0]"},
        {"scan.sensing_points=[16,16]", "time_axis.opl_start_m=1.0", "time_axis.num_bins=100"},
        {"scan.pattern=exhaustive", "scan.sensing_points=[6,6]", "scan.illumination_points=[4,4]"}};
    int tried = 0;
    int alarms = 0;
    for (const std::string& scene : kScenes) {
        for (const std::vector<std::string>& scan : scans) {
            if (scene == "curved" && &scan != &scans.front() && scan != kDevices) continue;
            for (const double peak : {0.0, 100.0, 20.0}) {
                const Capture& right = right_capture(scene, scan);
                const std::string warnings = warnings_of(peak > 0.0 ? counted(right, peak) : right);
                ++tried;
                if (warnings.empty()) continue;
                ++alarms;
                fmt::print("{} {} {}: {}\n", scene, fmt::join(scan, " "), peak, warnings);
            }
        }
    }
    fmt::print("{} of {} false alarms\n", alarms, tried);
    EXPECT_LE(alarms, 0.05 * tried);  // the aim is 0.02
}

TEST(Slips, OfUnitsAreSeenInEveryScene) {
    for (const std::string& scene : kScenes) {
        const Capture& right = right_capture(scene, kConfocal);
        Capture counts = counted(right, 20.0);
        counts.unit = core::TransientUnit::Radiance;
        EXPECT_NE(warnings_of(counts).find("capture.unit=counts"), std::string::npos) << scene;
        Capture radiance = right;
        radiance.unit = core::TransientUnit::Counts;
        EXPECT_NE(warnings_of(radiance).find("capture.unit=radiance"), std::string::npos) << scene;
    }
}

}  // namespace
}  // namespace apps
