// SPDX-License-Identifier: MIT
#include "calib/track/tracker.h"

#include "calib/track/compare_tracks.h"
#include "calib/track/reversed_time.h"
#include "tests/calib/track/track_example.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using calib::FrameEstimate;
using calib::TrackFrame;
using core::Vec3;
using test_support::draw_counts;
using test_support::small_sensor;
using test_support::small_settings;

constexpr double kStrength = 300.0;
constexpr double kBackground = 3.0;

// Ten frames that teach the background, and as many as asked for with what `targets` says.
std::vector<TrackFrame> frames_of(int count,
                                  const std::function<std::vector<Vec3>(int)>& targets,
                                  std::uint64_t seed = 1) {
    const auto sensor = small_sensor();
    const auto response = test_support::response_of(sensor);
    std::vector<TrackFrame> frames;
    for (int f = 0; f < 10 + count; ++f) {
        TrackFrame frame;
        frame.time_s = f * sensor.frame_s;
        frame.counts = draw_counts(response,
                                   f < 10 ? std::vector<Vec3>() : targets(f - 10),
                                   kStrength,
                                   kBackground,
                                   100 * seed + static_cast<std::uint64_t>(f));
        frames.push_back(std::move(frame));
    }
    return frames;
}

std::vector<FrameEstimate> track(const std::vector<TrackFrame>& frames,
                                 const calib::TrackSettings& settings = small_settings()) {
    calib::Tracker tracker(settings, small_sensor());
    std::vector<FrameEstimate> estimates;
    for (const TrackFrame& frame : frames) estimates.push_back(tracker.step(frame));
    return estimates;
}

std::size_t named(const FrameEstimate& estimate) {
    return static_cast<std::size_t>(
        std::ranges::count_if(estimate.targets, &calib::TargetEstimate::is_named));
}

bool warns(const std::vector<FrameEstimate>& estimates, const std::string& part) {
    return std::ranges::any_of(estimates, [&](const FrameEstimate& e) {
        return std::ranges::any_of(
            e.warnings, [&](const std::string& w) { return w.find(part) != std::string::npos; });
    });
}

Vec3 walk(int f) {
    return {-0.4 + 0.02 * f, 0.1, 0.8 + 0.01 * f};
}

TEST(Tracker, FollowsATargetThatComesAndGoes) {
    const auto estimates = track(frames_of(
        40, [](int f) { return f >= 10 && f < 30 ? std::vector{walk(f)} : std::vector<Vec3>(); }));
    EXPECT_TRUE(estimates[9].is_learning);
    for (int f = 0; f < 9; ++f) EXPECT_EQ(named(estimates[static_cast<std::size_t>(10 + f)]), 0U);
    for (int f = 13; f < 30; ++f) {
        const FrameEstimate& estimate = estimates[static_cast<std::size_t>(10 + f)];
        ASSERT_EQ(named(estimate), 1U) << f;
        const calib::Gaussian& state = estimate.targets[0].state;
        EXPECT_LT((state.position_m() - walk(f)).norm(), 0.15) << f;
        const Vec3 sigma = state.position_covariance().diagonal().cwiseSqrt();
        EXPECT_LT(sigma.norm(), 0.1) << f;
    }
    for (int f = 34; f < 40; ++f) EXPECT_EQ(named(estimates[static_cast<std::size_t>(10 + f)]), 0U);
}

TEST(Tracker, NamesNothingInEmptyScenes) {
    std::size_t alarms = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        for (const auto& e : track(frames_of(
                 60, [](int) { return std::vector<Vec3>(); }, seed))) {
            alarms += named(e);
        }
    }
    EXPECT_LE(alarms, 2U);  // of 180 frames
}

TEST(Tracker, FollowsTwoTargets) {
    calib::TrackSettings settings = small_settings();
    settings.max_targets = 2;
    const auto position = [](int f) {
        return std::vector{Vec3(-0.6 + 0.005 * f, 0.0, 0.6), Vec3(0.6, 0.0, 1.3 - 0.005 * f)};
    };
    const auto estimates = track(frames_of(20, position), settings);
    ASSERT_EQ(named(estimates.back()), 2U);
    for (const Vec3& truth : position(19)) {
        double nearest_m = 1.0;
        for (const auto& target : estimates.back().targets) {
            nearest_m = std::min(nearest_m, (target.state.position_m() - truth).norm());
        }
        EXPECT_LT(nearest_m, 0.15);
    }
}

TEST(Tracker, KnowsWhereAMovingSensorStands) {
    const auto sensor = small_sensor();
    calib::Tracker tracker(small_settings(), sensor);
    const Vec3 target(0.2, 0.0, 0.9);
    FrameEstimate last;
    for (int f = 0; f < 30; ++f) {
        core::SensorPose pose = sensor.setup->pose;
        pose.position_m.x() = 0.01 * f;
        auto there = sensor;
        there.setup->pose = pose;
        TrackFrame frame;
        frame.time_s = 0.05 * f;
        frame.pose = pose;
        frame.counts = draw_counts(test_support::response_of(there),
                                   f < 12 ? std::vector<Vec3>() : std::vector{target},
                                   kStrength,
                                   kBackground,
                                   static_cast<std::uint64_t>(f));
        last = tracker.step(frame);
    }
    ASSERT_EQ(named(last), 1U);
    EXPECT_LT((last.targets[0].state.position_m() - target).norm(), 0.1);
}

TEST(Tracker, LeavesOutZonesThatAreDeadOrSaturated) {
    auto frames = frames_of(20, [](int f) { return std::vector{walk(f)}; });
    for (std::size_t f = 12; f < frames.size(); ++f) {
        std::fill_n(frames[f].counts.begin(), 64, 0.0);
        std::fill_n(frames[f].counts.begin() + 64, 30, 1e6);
    }
    calib::TrackSettings settings = small_settings();
    settings.noise.saturation_counts = 1e5;
    const auto estimates = track(frames, settings);
    EXPECT_TRUE(warns(estimates, "zone 0 counted nothing"));
    EXPECT_TRUE(warns(estimates, "zone 1 is saturated"));
    ASSERT_EQ(named(estimates.back()), 1U);
    EXPECT_LT((estimates.back().targets[0].state.position_m() - walk(19)).norm(), 0.15);
}

TEST(Tracker, MovesOnOverMissingFramesAndLeavesOutLateOnes) {
    auto frames = frames_of(20, [](int f) { return std::vector{walk(f)}; });
    for (std::size_t f = 24; f < 27; ++f) frames[f].counts.clear();
    frames[28].time_s = frames[26].time_s;
    const auto estimates = track(frames);
    EXPECT_TRUE(warns(estimates, "missing"));
    EXPECT_TRUE(warns(estimates, "does not follow"));
    EXPECT_FALSE(estimates[28].is_used);
    ASSERT_EQ(named(estimates[26]), 1U);
    const auto spread = [&](std::size_t f) {
        return estimates[f].targets[0].state.position_covariance().trace();
    };
    EXPECT_GT(spread(26), 1.5 * spread(23));
    ASSERT_EQ(named(estimates.back()), 1U);
}

TEST(Tracker, NamesTheSizeOfFramesThatDoNotFit) {
    calib::Tracker tracker(small_settings(), small_sensor());
    TrackFrame frame;
    frame.counts.assign(10, 1.0);
    EXPECT_ERROR_WITH(tracker.step(frame), "must be 9 zones of 64 bins");
}

TEST(Tracker, NamesWhatIsNoCountWithItsZone) {
    for (const double wrong : {-1.0,
                               std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
        calib::Tracker tracker(small_settings(), small_sensor());
        TrackFrame frame;
        frame.name = "line 3";
        frame.counts.assign(9 * 64, 1.0);
        frame.counts[64 + 5] = wrong;
        EXPECT_ERROR_WITH(tracker.step(frame), "line 3, zone 1: found");
        EXPECT_ERROR_WITH(tracker.learn_background({frame}), "in bin 5");
    }
    calib::Tracker tracker(small_settings(), small_sensor());
    TrackFrame frame;
    frame.time_s = std::numeric_limits<double>::infinity();
    EXPECT_ERROR_WITH(tracker.step(frame), "time");
    frame.time_s = 0.0;
    frame.pose = core::SensorPose{Vec3(0, 0, -1), -Vec3::UnitZ(), Vec3::UnitY()};
    EXPECT_ERROR_WITH(tracker.step(frame), "no zone sees the relay wall");
}

TEST(Tracker, TimeThatRunsBackwardsIsNamed) {
    auto frames = frames_of(30, [](int f) { return std::vector{walk(f)}; });
    const auto warning = [&] {
        return calib::reversed_time_warning(
            small_settings(), small_sensor(), frames, {}, track(frames));
    };
    EXPECT_FALSE(warning());
    for (TrackFrame& frame : frames) {
        for (std::size_t zone = 0; zone < 9; ++zone) {
            const auto begin = frame.counts.begin() + static_cast<std::ptrdiff_t>(64 * zone);
            std::reverse(begin, begin + 64);
        }
    }
    const auto text = warning();
    ASSERT_TRUE(text);
    EXPECT_NE(text->find("time looks reversed"), std::string::npos) << *text;
    frames = frames_of(30, [](int) { return std::vector<Vec3>(); });
    EXPECT_FALSE(warning());
}

TEST(TrackSettings, PosesAreCompletedByWhatIsKnown) {
    calib::PoseSettings pose;
    pose.position_m = Vec3(1, 2, 3);
    pose.complete({Vec3(0, 0, 9), Vec3(0.1, 0, -1), Vec3::UnitX()});
    EXPECT_EQ(pose.whole().position_m, Vec3(1, 2, 3));
    EXPECT_EQ(pose.whole().forward, Vec3(0.1, 0, -1));
    EXPECT_EQ(calib::PoseSettings{}.whole().position_m, Vec3::UnitZ().eval());
}

TEST(TrackSettings, SaysWhatIsWrong) {
    calib::TrackSettings settings;
    settings.search.z_range_m = {2.0, 1.0};
    EXPECT_ERROR_WITH(calib::validate(settings, "m.json"), "m.json.search.z_range_m[1]: found 1");
    settings = {};
    settings.free = calib::TrackUnknown::SensorPose;
    EXPECT_ERROR_WITH(calib::validate(settings, "m.json"), "target.position_m");
    settings = {};
    settings.max_targets = 9;
    EXPECT_ERROR_WITH(calib::validate(settings, "m.json"), "max_targets");
}

TEST(WallThrough, FindsThePlaneOfSpots) {
    const std::vector<Vec3> spots{
        {0.0, 0.0, 0.5}, {1.0, 0.0, 0.5}, {0.0, 1.0, 0.5}, {1.0, 1.0, 0.502}};
    const core::RelayWall wall = calib::wall_through(spots, "frames");
    EXPECT_GT(wall.normal.z(), 0.99);
    EXPECT_NEAR(wall.center_m.z(), 0.5, 0.01);
    EXPECT_ERROR_WITH(calib::wall_through({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, "frames"),
                      "3 wall points on a line");
    EXPECT_ERROR_WITH(calib::wall_through({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.8}}, "frames"),
                      "off a plane");
}

TEST(TrackScores, CountWhatTheyShould) {
    const auto frame = [](double time_s, const std::vector<Vec3>& positions) {
        calib::TrackedFrame f;
        f.time_s = time_s;
        for (const Vec3& p : positions) f.targets.push_back({p, 0.01 * core::Mat3::Identity()});
        return f;
    };
    const Vec3 a(0, 0, 1);
    const std::vector truth{
        frame(0, {}), frame(1, {}), frame(2, {a}), frame(3, {a}), frame(4, {a})};
    const std::vector found{frame(0, {}),
                            frame(1, {a}),
                            frame(2, {}),
                            frame(3, {a + Vec3(0.1, 0, 0)}),
                            frame(4, {a + Vec3(0, 0.3, 0)})};
    calib::TrackScorer scorer;
    scorer.add(found, truth, "t");
    const calib::TrackScores scores = scorer.scores();
    EXPECT_NEAR(*scores.rmse_m, std::sqrt(0.05), 1e-12);
    EXPECT_DOUBLE_EQ(*scores.coverage, 0.5);  // 3 standard deviations are outside
    EXPECT_DOUBLE_EQ(*scores.false_alarms, 0.2);
    EXPECT_DOUBLE_EQ(*scores.missed, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(*scores.latency_s, 1.0);
    EXPECT_ERROR_WITH(scorer.add({frame(100, {})}, truth, "t"), "no frame of 1 has the time");
}

}  // namespace
