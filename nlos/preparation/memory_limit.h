// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

namespace nlos {

/// What work may take on top of what is held already [bytes]: what the machine has to give, and no
/// more than a limit [GB] if there is one.
double memory_budget(std::optional<double> limit_gb = {});

/// Refuses work that does not fit into memory, before it starts.
///
/// needed_bytes   what the work takes on top of what is held already
/// throws         core::Failure with both numbers when the budget is smaller
void require_memory(double needed_bytes, std::optional<double> limit_gb = {});

}  // namespace nlos
