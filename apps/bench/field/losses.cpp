// SPDX-License-Identifier: MIT
#include "apps/bench/field/losses.h"

#include <fmt/core.h>

#include <array>

namespace apps {
namespace {

const std::string kOurs = "nlos";
constexpr double kAlike = 0.02;  // fractions by which figures may differ and still be called level

struct ComparedFigure {
    const char* name;
    std::optional<double> ReconstructionSummary::*value;
    bool larger_is_better;

    bool is_better(double a, double b) const { return larger_is_better ? a > b : a < b; }
    bool is_clearly_better(double a, double b) const {
        return larger_is_better ? a > (1.0 + kAlike) * b : a < (1.0 - kAlike) * b;
    }
};

constexpr std::array kComparedFigures{
    ComparedFigure{"clean_mae_mm", &ReconstructionSummary::clean_mae_mm, false},
    ComparedFigure{"mae_mm_100", &ReconstructionSummary::mae_mm_100, false},
    ComparedFigure{"mae_mm_20", &ReconstructionSummary::mae_mm_20, false},
    ComparedFigure{"mae_mm_3", &ReconstructionSummary::mae_mm_3, false},
    ComparedFigure{"clean_iou_best", &ReconstructionSummary::clean_iou_best, true},
    ComparedFigure{"iou_best_3", &ReconstructionSummary::iou_best_3, true},
    ComparedFigure{"cpu_s", &ReconstructionSummary::cpu_s, false},
    ComparedFigure{"peak_mb", &ReconstructionSummary::peak_mb, false},
};

}  // namespace

std::vector<Loss> find_losses(const std::vector<ReconstructionSummary>& summaries) {
    std::vector<Loss> losses;
    for (const ReconstructionSummary& peer : summaries) {
        if (peer.program == kOurs) continue;
        for (const ComparedFigure& figure : kComparedFigures) {
            const std::optional<double> theirs = peer.*figure.value;
            if (!theirs) continue;
            Loss loss{fmt::format("{}, {} points", peer.pattern, peer.points),
                      figure.name,
                      peer.program,
                      peer.method,
                      *theirs};
            for (const ReconstructionSummary& ours : summaries) {
                const std::optional<double> value = ours.*figure.value;
                if (ours.program != kOurs || ours.pattern != peer.pattern ||
                    ours.points != peer.points || !value) {
                    continue;
                }
                if (ours.method == peer.method) loss.ours_alike = value;
                if (!loss.ours_best || figure.is_better(*value, *loss.ours_best)) {
                    loss.ours_best = value;
                    loss.our_best = ours.method;
                }
            }
            const bool beats_alike =
                loss.ours_alike && figure.is_clearly_better(*theirs, *loss.ours_alike);
            const bool beats_all = loss.ours_best && figure.is_better(*theirs, *loss.ours_best);
            if (beats_alike || beats_all) losses.push_back(std::move(loss));
        }
    }
    return losses;
}

std::vector<Loss> find_losses(const std::vector<RenderingSummary>& summaries) {
    std::vector<Loss> losses;
    for (const RenderingSummary& peer : summaries) {
        if (peer.program == kOurs || !peer.times_ours || *peer.times_ours >= 1.0) continue;
        Loss loss{fmt::format("{}, order {}", peer.scene, peer.max_bounces),
                  "cpu_s_at_1_percent",
                  peer.program,
                  peer.method,
                  *peer.cpu_s_at_1_percent};
        for (const RenderingSummary& ours : summaries) {
            if (ours.program == kOurs && ours.scene == peer.scene &&
                ours.max_bounces == peer.max_bounces && ours.times_ours == 1.0) {
                loss.ours_best = ours.cpu_s_at_1_percent;
                loss.our_best = ours.method;
            }
        }
        losses.push_back(std::move(loss));
    }
    return losses;
}

}  // namespace apps
