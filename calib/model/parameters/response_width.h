// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

/// Width of the response, relative to the model's.
inline const Parameter kResponseWidth{
    .name = "response_fwhm",
    .owner = Owner::Scene,
    .effect = Effect::WidensResponse,
    .is_logarithm = true,
    .key = "response_fwhm_ps",
    .misfit = {"the response's width", 100.0, "%"},
    .refusal = [](const core::ResponseSettings& response)
        -> std::optional<std::pair<const char*, const char*>> {
        if (response.jitter_fwhm_ps > 0.0 && response.tail_ps == 0.0 && response.curve.empty()) {
            return std::nullopt;
        }
        return std::pair("found a response without a width to scale",
                         "needs response.jitter_fwhm_ps alone");
    },
    .unit = [](const FitSettings& settings) { return settings.response.jitter_fwhm_ps; }};

}  // namespace calib
