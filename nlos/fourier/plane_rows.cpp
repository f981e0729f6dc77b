// SPDX-License-Identifier: MIT
#include "nlos/fourier/plane_rows.h"

namespace nlos {
namespace {

constexpr std::size_t kAhead = 8;  // planes
constexpr std::size_t kLine = 8;   // numbers of a cache line

}  // namespace

void PlaneRows::copy_to_planes() const {
    for (std::size_t k = 0; k < num_planes; ++k) {
        ComplexF* const plane = planes + k * plane_stride;
        for (std::size_t i = 0; i < num_rows && k + kAhead < num_planes; i += kLine) {
            __builtin_prefetch(plane + kAhead * plane_stride + i, 1);
        }
        for (std::size_t i = 0; i < num_rows; ++i) plane[i] = rows[i * row_stride + k];
    }
}

void PlaneRows::copy_to_rows() const {
    for (std::size_t k = 0; k < num_planes; ++k) {
        const ComplexF* const plane = planes + k * plane_stride;
        for (std::size_t i = 0; i < num_rows && k + kAhead < num_planes; i += kLine) {
            __builtin_prefetch(plane + kAhead * plane_stride + i, 0);
        }
        for (std::size_t i = 0; i < num_rows; ++i) rows[i * row_stride + k] = plane[i];
    }
}

}  // namespace nlos
