// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"

#include <array>

namespace nlos {

struct MethodTraits;  // nlos/methods/methods.h

// The list of reconstruction methods. What a method is stands in its row, in a file of its own;
// here it has an enumerator, that row and its name in settings, in the same order.

enum class Method { Auto, Lct, Bp, Fbp, Fk, Phasor, Dlct, Solver };

extern const MethodTraits kLct, kBp, kFbp, kFk, kPhasor, kDlct, kSolver;

inline constexpr std::array kMethods{&kLct, &kBp, &kFbp, &kFk, &kPhasor, &kDlct, &kSolver};

/// Of these `auto` takes the first that serves; the last serves every capture.
inline constexpr std::array kPreferredMethods{&kLct, &kPhasor, &kBp};

/// What `auto` takes in place of the first of them where there is noise, a response or a gap to
/// explain, and what prior=tv stands for.
inline constexpr const MethodTraits& kStatisticalMethod = kSolver;

}  // namespace nlos

template <>
struct core::EnumNames<nlos::Method> {
    static constexpr auto value =
        names_from_zero<nlos::Method>("auto", "lct", "bp", "fbp", "fk", "phasor", "dlct", "solver");
};
