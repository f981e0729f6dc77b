// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/baselines.h"
#include "apps/bench/output.h"
#include "nlos/pictures/panel.h"
#include "nlos/reconstruction/volume.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/depth_map.h"
#include "renderer/core/progress.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A method and whose it is.
struct ReconstructionMethod {
    std::string program{};  ///< "nlos" or the name of an adapter's peer
    std::string adapter{};  ///< empty: this program's
    std::string method{};
};

/// Ours and y-tal's.
const std::vector<ReconstructionMethod>& reconstruction_methods();

/// One method on one capture.
struct ReconstructionRow {
    std::string scene{};
    std::string pattern{};                   ///< confocal or single
    int points = 0;                          ///< along a side of the wall
    std::string light{};                     ///< counts per point, or "clean"
    std::string program{};                   ///< whose method
    std::string method{};                    ///< its name there
    std::optional<double> depth_mae_mm{};    ///< over columns above a fifth of the brightest voxel
    std::optional<double> depth_coverage{};  ///< fraction of the true columns that these are
    std::optional<double> iou{};             ///< of their mask
    std::optional<double> iou_best{};        ///< of the mask at the best threshold
    std::optional<double> stated_mae_mm{};   ///< over columns that the method itself gives a depth
    std::optional<double> cpu_s{};           ///< of the calculation
    std::optional<double> process_cpu_s{};   ///< of the whole process
    std::optional<double> peak_mb{};         ///< memory of the whole process
    std::string reason{};                    ///< why there is no result
};
NLOS_FIGURES(ReconstructionRow,
             scene,
             pattern,
             points,
             light,
             program,
             method,
             depth_mae_mm,
             depth_coverage,
             iou,
             iou_best,
             stated_mae_mm,
             cpu_s,
             process_cpu_s,
             peak_mb,
             reason);

/// A method over all scenes: medians of what it does on them.
struct ReconstructionSummary {
    std::string pattern{};
    int points = 0;
    std::string program{};
    std::string method{};
    std::optional<double> clean_mae_mm{};
    std::optional<double> mae_mm_100{};  ///< at 100 counts per point
    std::optional<double> mae_mm_20{};
    std::optional<double> mae_mm_3{};
    std::optional<double> clean_iou_best{};
    std::optional<double> iou_best_3{};
    std::optional<double> cpu_s{};
    std::optional<double> process_cpu_s{};
    std::optional<double> peak_mb{};
    int done = 0;          ///< captures that it reconstructed
    int of = 0;            ///< captures that it was given
    std::string reason{};  ///< of the first that it did not
};
NLOS_FIGURES(ReconstructionSummary,
             pattern,
             points,
             program,
             method,
             clean_mae_mm,
             mae_mm_100,
             mae_mm_20,
             mae_mm_3,
             clean_iou_best,
             iou_best_3,
             cpu_s,
             process_cpu_s,
             peak_mb,
             done,
             of,
             reason);

/// The distance of neighbouring wall points [m].
double point_distance_m(const core::WallScan& scan);

/// Depths that a volume is made at.
struct DepthPlanes {
    double begin_m = 0.3;
    double end_m = 1.3;
    std::optional<int> count = 128;  ///< nothing: voxels as our methods choose them
};

/// A method's volume of a capture file, with what it took.
struct MethodVolume {
    FieldRun run;
    nlos::Volume volume;      ///< empty where the run failed
    core::DepthMap reported;  ///< depths that the method itself reports; empty for peers
};

/// A capture for all methods: the file, the same for y-tal, and the voxels they are to fill.
class SharedCapture {
 public:
    /// kind     names runs that take alike
    SharedCapture(Baselines& baselines,
                  const std::string& name,
                  std::string kind,
                  const core::Capture& capture,
                  const DepthPlanes& planes);

    /// Runs a method. Our backprojection, which the axes and the wavelength of peers are taken
    /// from, has to be the first.
    MethodVolume run(const ReconstructionMethod& method);

 private:
    MethodVolume run_own(const ReconstructionMethod& method);
    MethodVolume run_peer(const ReconstructionMethod& method);

    Baselines& baselines_;
    std::string stem_;
    std::string kind_;
    DepthPlanes planes_;
    int columns_ = 0;  ///< along either side; 0: as the scan's points
    double wavelength_m_ = 0.0;
    std::optional<nlos::VolumeAxes> axes_;
};

/// What an eye at the wall sees of a volume.
nlos::Panel projection_panel(const ReconstructionMethod& method, const nlos::Volume& volume);

/// Reconstructs every scene by every method: confocal and from a single laser, without noise and at
/// 100, 20 and 3 counts per point; the letter without noise also with twice the points either way.
///
/// points    along either side of the wall
/// quick     the letter alone: confocal without noise and at 20 counts, single without noise
/// pictures  gets maximum projections side by side, by the end of their files' names
std::vector<ReconstructionRow> measure_reconstructions(
    Baselines& baselines,
    int points,
    bool quick,
    const core::Progress& progress,
    std::map<std::string, BenchPicture>& pictures);

/// A row per method, pattern and size.
std::vector<ReconstructionSummary> summarise(const std::vector<ReconstructionRow>& rows);

}  // namespace apps
