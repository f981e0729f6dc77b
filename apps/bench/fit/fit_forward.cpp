// SPDX-License-Identifier: MIT
#include "apps/bench/fit/fit.h"
#include "apps/bench/fit/fit_trials.h"
#include "calib/forward/forward_model.h"
#include "renderer/core/system/process.h"

#include <fmt/core.h>

#include <algorithm>

namespace apps {
namespace {

// The rectangle's forward model, without fitting anything.
struct Bare {
    renderer::SceneGeometry geometry;
    core::WallScan scan = trial_scan();
    std::unique_ptr<calib::SceneModel> model;
    std::unique_ptr<calib::ForwardModel> light;

    explicit Bare(bool is_filtered) {
        constexpr double kNoFurtherCut = 1e9;
        geometry.objects = {trial_rectangle(standard_pose(), 4, 3)};
        calib::FitSettings settings;
        settings.free.objects = {{"target", {"pose", "albedo"}}};
        settings.free.parameters = {"ambient", "scale"};
        model = std::make_unique<calib::SceneModel>(geometry, settings);
        calib::ForwardSettings forward;
        forward.axis = trial_axis();
        forward.axis.num_bins = 288;
        forward.sigma_m = core::sigma_m_from_fwhm_ps(kTrialFwhm_ps);
        if (is_filtered) forward.measured = core::GaussianResponse{forward.sigma_m};
        forward.offset_m.assign(scan.num_pairs(), 0.0);
        forward.tolerance = kNoFurtherCut;
        light =
            std::make_unique<calib::ForwardModel>(*model, scan, calib::WallMotion(scan), forward);
        light->refresh(start());
    }

    calib::SceneState start() const { return calib::without_added_light(model->start()); }

    double milliseconds(renderer::Gradients gradients) const {
        constexpr int kRepeats = 7;
        std::vector<double> times;
        calib::PairModel pair;
        for (int i = 0; i < kRepeats; ++i) {
            const double begin = core::cpu_seconds();
            light->update(start(), gradients);
            for (std::size_t p = 0; p < scan.num_pairs(); ++p) light->evaluate(p, pair);
            times.push_back(1e3 * (core::cpu_seconds() - begin));
        }
        return *std::min_element(times.begin(), times.end());
    }
};

}  // namespace

void bench_forward(FitBench& bench) {
    const Bare bare(false);
    const Bare filtered(true);
    const double plain = bare.milliseconds(renderer::Gradients::Without);
    const double gradients = bare.milliseconds(renderer::Gradients::With);
    const double fir = filtered.milliseconds(renderer::Gradients::Without);
    bench.rows.push_back(
        {"forward / with Jacobian / filtered, 24 triangles x 256 points x 288 bins [ms]",
         "12 / 20 / 3",
         fmt::format("{:.1f} / {:.1f} / {:.1f}", plain, gradients, fir),
         plain < 12.0 && gradients < 20.0 && fir < 3.0});
}

}  // namespace apps
