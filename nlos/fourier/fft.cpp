// SPDX-License-Identifier: MIT
#include "nlos/fourier/fft.h"

#include "renderer/core/error.h"

#include <fftw3.h>

#include <algorithm>
#include <cstdlib>
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

fftwf_iodim dimension(std::size_t length, std::size_t in_stride, std::size_t out_stride) {
    return {static_cast<int>(length), static_cast<int>(in_stride), static_cast<int>(out_stride)};
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

FftBuffer::FftBuffer(std::size_t num_floats) : num_floats_(num_floats) {
    constexpr std::size_t kAlignment = 64;
    const std::size_t num_bytes = num_floats * sizeof(float);
    std::size_t space = num_bytes + kAlignment;
    memory_.reset(std::calloc(space, 1));
    if (!memory_) throw std::bad_alloc();
    void* first = memory_.get();
    data_ = static_cast<float*>(std::align(kAlignment, num_bytes, first, space));
}

void FftBuffer::Free::operator()(void* memory) const {
    std::free(memory);
}

Fft Fft::real_to_complex(std::size_t length, std::size_t count) {
    FftBuffer buffer((length + 2) * count);
    float* data = buffer.data();
    const fftwf_iodim row = dimension(length, 1, 1);
    const fftwf_iodim rows = dimension(count, length + 2, length / 2 + 1);
    const std::lock_guard lock(planner_mutex);
    return Fft(
        Kind::RealToComplex,
        checked(fftwf_plan_guru_dft_r2c(1, &row, 1, &rows, data, as_fftw(data), FFTW_ESTIMATE)));
}

Fft Fft::complex_to_real(std::size_t length, std::size_t count) {
    FftBuffer buffer((length + 2) * count);
    float* data = buffer.data();
    const fftwf_iodim row = dimension(length, 1, 1);
    const fftwf_iodim rows = dimension(count, length / 2 + 1, length + 2);
    const std::lock_guard lock(planner_mutex);
    return Fft(
        Kind::ComplexToReal,
        checked(fftwf_plan_guru_dft_c2r(1, &row, 1, &rows, as_fftw(data), data, FFTW_ESTIMATE)));
}

Fft Fft::complex_batch(const Layout& layout, Direction direction) {
    FftBuffer buffer(
        2 * ((layout.length - 1) * layout.stride + (layout.count - 1) * layout.distance + 1));
    fftwf_complex* data = as_fftw(buffer.data());
    const fftwf_iodim each = dimension(layout.length, layout.stride, layout.stride);
    const fftwf_iodim all = dimension(layout.count, layout.distance, layout.distance);
    const int sign = direction == Direction::Forward ? FFTW_FORWARD : FFTW_BACKWARD;
    const std::lock_guard lock(planner_mutex);
    return Fft(Kind::Complex,
               checked(fftwf_plan_guru_dft(1, &each, 1, &all, data, data, sign, FFTW_ESTIMATE)));
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
    }
}

void Fft::Destroy::operator()(void* plan) const {
    const std::lock_guard lock(planner_mutex);
    fftwf_destroy_plan(static_cast<fftwf_plan>(plan));
}

}  // namespace nlos
