// SPDX-License-Identifier: MIT
// What must hold for every row of the list of methods.
#include "nlos/methods/methods.h"

#include "tests/nlos/every_method.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/file_bytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace nlos {
namespace {

using core::ScanPattern;
using nlos_test::every_method;
using nlos_test::MethodCase;

/// A point before scans of all kinds: grids, a list of points, few points.
std::map<std::string, core::Capture> every_scan() {
    std::map<std::string, core::Capture> captures;
    const auto add = [&](const std::string& name, ScanPattern pattern, std::size_t columns) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({columns, columns}, {0.06, 0.06}), {0.0, 0.02, 64});
        capture.scan.wall().pattern = pattern;
        if (pattern != ScanPattern::Confocal) {
            const std::size_t lit = pattern == ScanPattern::Single ? 1 : 2;
            capture.scan.wall().illumination = nlos_test::wall_grid({lit, lit}, {0.3, 0.3});
        }
        capture.transient = core::Transient(capture.scan.num_pairs(), 64);
        nlos_test::add_scatterer(capture, core::Vec3(0.03, 0.03, 0.4), 4.0);
        return &captures.emplace(name, std::move(capture)).first->second;
    };
    add("confocal grid", ScanPattern::Confocal, 8);
    add("single", ScanPattern::Single, 8);
    add("exhaustive", ScanPattern::Exhaustive, 8);
    add("list", ScanPattern::Confocal, 8)->scan.wall().sensing.grid.reset();
    add("two points", ScanPattern::Confocal, 1);
    core::Capture& two = captures.at("two points");
    for (core::WallPoints* points : {&two.scan.wall().sensing, &two.scan.wall().illumination}) {
        points->grid.reset();
        points->positions.emplace_back(0.2, 0.1, 0.0);
        points->normals.push_back(core::Vec3::UnitZ());
    }
    two.transient = core::Transient(2, 64);
    nlos_test::add_scatterer(two, core::Vec3(0.03, 0.03, 0.4), 4.0);
    return captures;
}

TEST(Methods, HaveTheirRowsInTheOrderOfTheirNames) {
    ASSERT_EQ(kMethods.size() + 1, core::EnumNames<Method>::value.size());
    std::set<std::string_view> meanings;
    for (const MethodTraits* method : kMethods) {
        EXPECT_EQ(&traits_of(method->method), method);
        EXPECT_TRUE(meanings.insert(method->meaning).second) << method->meaning;
        EXPECT_FALSE(method->captures.empty()) << method->meaning;
    }
    EXPECT_EQ(kPreferredMethods.back()->needs, nullptr);
    EXPECT_TRUE(kStatisticalMethod.explains_response && kStatisticalMethod.explains_background &&
                kStatisticalMethod.explains_gaps);
}

TEST(Methods, HaveErrorsOfTheirOwn) {
    std::set<std::array<double, 4>> known;
    for (const MethodTraits* method : kMethods) {
        const VolumeErrors& noisy = method->errors.noisy;
        EXPECT_TRUE(
            known
                .insert(
                    {noisy.model_fraction, noisy.noise_fraction, noisy.doubt, noisy.near_fraction})
                .second)
            << core::enum_name(method->method);
        EXPECT_GT(noisy.model_fraction, 0.0) << core::enum_name(method->method);
        EXPECT_EQ(noisy.scale == VolumeScale::Magnitude, method->propagates_wave);
    }
}

TEST(Methods, ServeEveryScanOrNameOneThatDoes) {
    const std::string works = "works for this capture";
    for (const auto& [scan, capture] : every_scan()) {
        for (const MethodCase& method : every_method()) {
            SCOPED_TRACE(method.name + " of " + scan);
            ReconstructSettings settings = method.settings({"volume.z_range_m=[0.2,0.6]"});
            if (scan == "two points") settings.volume.voxels = {8, 8, 8};
            std::string other;
            try {
                const Reconstruction result = reconstruct(capture, settings, {});
                EXPECT_EQ(result.method, core::enum_name(method.traits->method));
                EXPECT_GT(*std::ranges::max_element(result.volume.values), 0.0F);
            } catch (const core::Error& error) {
                const std::string text = error.what();
                const std::size_t end = text.find(" " + works);
                ASSERT_NE(end, std::string::npos) << text;
                const std::size_t begin = text.rfind("method=", end);
                other = text.substr(begin, end - begin);
            }
            EXPECT_TRUE(other.empty() || method.traits->needs) << "without needs it must serve";
            if (other.empty()) continue;
            core::apply_override(settings, other);
            EXPECT_NO_THROW(reconstruct(capture, settings, {})) << other;
        }
    }
}

// What bench holds the time of a method against.
TEST(Methods, ReportTheWorkThatTheyCannotDoWithout) {
    const core::Capture capture = every_scan().at("confocal grid");
    for (const MethodCase& method : every_method()) {
        if (method.iterates()) continue;
        const Reconstruction done = reconstruct(capture, method.settings(), {});
        const WallFrame wall = derive_wall_frame(capture.scan.wall());
        const core::Progress progress;
        const LeastWork work = method.traits->least_work({capture.scan.wall(),
                                                          capture.time_axis,
                                                          capture.transient,
                                                          wall,
                                                          done.volume.axes,
                                                          *done.settings.volume.z_range_m,
                                                          progress},
                                                         done.settings);
        EXPECT_GT(static_cast<double>(work.planes_inverse) + work.multiply_adds, 0.0)
            << method.name;
        EXPECT_EQ(work.row_length > 0, work.rows_forward > 0) << method.name;
    }
}

TEST(Methods, StandInTheReadme) {
    const std::string readme = test_support::file_bytes(NLOS_SOURCE_DIR "/README.md");
    for (const MethodTraits* method : kMethods) {
        const std::string row = fmt::format("| `{}` | {} | {} |\n",
                                            core::enum_name(method->method),
                                            method->meaning,
                                            method->captures);
        EXPECT_NE(readme.find(row), std::string::npos) << "README.md needs the row " << row;
    }
}

}  // namespace
}  // namespace nlos
