// SPDX-License-Identifier: MIT
#pragma once

namespace nlos {

/// Refuses work that does not fit into memory, before it starts.
///
/// needed_bytes   what the work takes on top of what is held already
/// throws         core::Failure with both numbers when the machine has less to give
void require_memory(double needed_bytes);

}  // namespace nlos
