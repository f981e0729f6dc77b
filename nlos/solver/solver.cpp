// SPDX-License-Identifier: MIT
#include "nlos/solver/solver.h"

#include "nlos/solver/confocal_solver.h"
#include "nlos/solver/pair_solver.h"

namespace nlos {

Volume solve(const MethodInput& input, const ReconstructSettings& settings, std::size_t num_slabs) {
    return is_confocal_grid(input) ? solve_confocal(input, settings, num_slabs)
                                   : solve_pairs(input, settings, num_slabs);
}

double solve_bytes(const MethodInput& input,
                   const ReconstructSettings& settings,
                   std::size_t num_slabs) {
    return is_confocal_grid(input) ? solve_confocal_bytes(input, settings, num_slabs)
                                   : solve_pairs_bytes(input, settings, num_slabs);
}

}  // namespace nlos
