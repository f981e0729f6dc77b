// SPDX-License-Identifier: MIT
#include "nlos/fourier/fft.h"

#include "renderer/core/error.h"

#include <fftw3.h>

#include <algorithm>
#include <mutex>
#include <new>

namespace nlos {
namespace {

std::mutex planner_mutex;  // FFTW's planner is not thread-safe; its transforms are

fftwf_complex* as_fftw(float* data) {
    return reinterpret_cast<fftwf_complex*>(data);
}

void* checked(fftwf_plan plan) {
    if (plan == nullptr) throw core::Failure("fft", "FFTW could not plan the transform");
    return plan;
}

int to_int(std::size_t n) {
    return static_cast<int>(n);
}

}  // namespace

std::size_t good_fft_size(std::size_t n) {
    for (std::size_t candidate = std::max<std::size_t>(1, n);; ++candidate) {
        std::size_t rest = candidate;
        for (const std::size_t factor : {2, 3, 5, 7}) {
            while (rest % factor == 0) rest /= factor;
        }
        if (rest == 1) return candidate;
    }
}

FftBuffer::FftBuffer(std::size_t num_floats)
    : num_floats_(num_floats), memory_(fftwf_alloc_real(num_floats)) {
    if (!memory_) throw std::bad_alloc();
    std::fill_n(memory_.get(), num_floats, 0.0F);
}

void FftBuffer::Free::operator()(float* memory) const {
    fftwf_free(memory);
}

Fft Fft::real_to_complex(std::size_t length, std::size_t count) {
    FftBuffer buffer((length + 2) * count);
    const int n = to_int(length);
    const std::lock_guard lock(planner_mutex);
    return Fft(Kind::RealToComplex,
               checked(fftwf_plan_many_dft_r2c(1,
                                               &n,
                                               to_int(count),
                                               buffer.data(),
                                               nullptr,
                                               1,
                                               n + 2,
                                               as_fftw(buffer.data()),
                                               nullptr,
                                               1,
                                               n / 2 + 1,
                                               FFTW_ESTIMATE)));
}

Fft Fft::complex_to_real(std::size_t length, std::size_t count) {
    FftBuffer buffer((length + 2) * count);
    const int n = to_int(length);
    const std::lock_guard lock(planner_mutex);
    return Fft(Kind::ComplexToReal,
               checked(fftwf_plan_many_dft_c2r(1,
                                               &n,
                                               to_int(count),
                                               as_fftw(buffer.data()),
                                               nullptr,
                                               1,
                                               n / 2 + 1,
                                               buffer.data(),
                                               nullptr,
                                               1,
                                               n + 2,
                                               FFTW_ESTIMATE)));
}

Fft Fft::complex_batch(const Layout& layout, Direction direction) {
    FftBuffer buffer(
        2 * ((layout.length - 1) * layout.stride + (layout.count - 1) * layout.distance + 1));
    const int n = to_int(layout.length);
    const std::lock_guard lock(planner_mutex);
    return Fft(
        Kind::Complex,
        checked(fftwf_plan_many_dft(1,
                                    &n,
                                    to_int(layout.count),
                                    as_fftw(buffer.data()),
                                    nullptr,
                                    to_int(layout.stride),
                                    to_int(layout.distance),
                                    as_fftw(buffer.data()),
                                    nullptr,
                                    to_int(layout.stride),
                                    to_int(layout.distance),
                                    direction == Direction::Forward ? FFTW_FORWARD : FFTW_BACKWARD,
                                    FFTW_ESTIMATE)));
}

Fft Fft::real_3d(const std::array<std::size_t, 3>& size, Direction direction) {
    FftBuffer buffer(size[0] * size[1] * (size[2] + 2));
    const int n[3] = {to_int(size[0]), to_int(size[1]), to_int(size[2])};
    const std::lock_guard lock(planner_mutex);
    if (direction == Direction::Forward) {
        return Fft(Kind::RealToComplex,
                   checked(fftwf_plan_dft_r2c(
                       3, n, buffer.data(), as_fftw(buffer.data()), FFTW_ESTIMATE)));
    }
    return Fft(
        Kind::ComplexToReal,
        checked(fftwf_plan_dft_c2r(3, n, as_fftw(buffer.data()), buffer.data(), FFTW_ESTIMATE)));
}

Fft Fft::even_2d(std::size_t nx, std::size_t ny) {
    FftBuffer buffer(2 * nx * ny);
    const int n[2] = {to_int(nx), to_int(ny)};
    const fftw_r2r_kind kinds[2] = {FFTW_REDFT00, FFTW_REDFT00};
    const std::lock_guard lock(planner_mutex);
    return Fft(Kind::Real,
               checked(fftwf_plan_many_r2r(2,
                                           n,
                                           2,
                                           buffer.data(),
                                           nullptr,
                                           2,
                                           1,
                                           buffer.data(),
                                           nullptr,
                                           2,
                                           1,
                                           kinds,
                                           FFTW_ESTIMATE)));
}

void Fft::run(FftBuffer& buffer) const {
    const auto plan = static_cast<fftwf_plan>(plan_.get());
    float* data = buffer.data();
    switch (kind_) {
        case Kind::RealToComplex:
            fftwf_execute_dft_r2c(plan, data, as_fftw(data));
            return;
        case Kind::ComplexToReal:
            fftwf_execute_dft_c2r(plan, as_fftw(data), data);
            return;
        case Kind::Complex:
            fftwf_execute_dft(plan, as_fftw(data), as_fftw(data));
            return;
        case Kind::Real:
            fftwf_execute_r2r(plan, data, data);
            return;
    }
}

void Fft::Destroy::operator()(void* plan) const {
    const std::lock_guard lock(planner_mutex);
    fftwf_destroy_plan(static_cast<fftwf_plan>(plan));
}

}  // namespace nlos
