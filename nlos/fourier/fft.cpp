// SPDX-License-Identifier: MIT
#include "nlos/fourier/fft.h"

#include "renderer/core/error.h"
#include "renderer/core/system/large_memory.h"

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

FftBuffer room_for(std::size_t length, std::size_t count, const Fft::Layout& layout) {
    return FftBuffer(2 * ((length - 1) * layout.stride + (count - 1) * layout.distance + 1));
}

void* plan_complex(std::size_t length,
                   std::size_t count,
                   const Fft::Layout& from,
                   const Fft::Layout& to,
                   Fft::Direction direction,
                   FftBuffer& in,
                   FftBuffer& out) {
    const fftwf_iodim each = dimension(length, from.stride, to.stride);
    const fftwf_iodim all = dimension(count, from.distance, to.distance);
    const int sign = direction == Fft::Direction::Forward ? FFTW_FORWARD : FFTW_BACKWARD;
    const std::lock_guard lock(planner_mutex);
    return checked(fftwf_plan_guru_dft(
        1, &each, 1, &all, as_fftw(in.data()), as_fftw(out.data()), sign, FFTW_ESTIMATE));
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
    core::use_huge_pages(data_, num_bytes);
}

void FftBuffer::Free::operator()(void* memory) const {
    std::free(memory);
}

Fft Fft::real_to_complex(std::size_t length, std::size_t count) {
    FftBuffer in(row_floats(length) * count);
    FftBuffer out(row_floats(length) * count);
    const fftwf_iodim row = dimension(length, 1, 1);
    const fftwf_iodim rows = dimension(count, row_floats(length), row_floats(length) / 2);
    const std::lock_guard lock(planner_mutex);
    return Fft(Kind::RealToComplex,
               checked(fftwf_plan_guru_dft_r2c(
                   1, &row, 1, &rows, in.data(), as_fftw(out.data()), FFTW_ESTIMATE)));
}

Fft Fft::complex_to_real(std::size_t length, std::size_t count) {
    FftBuffer in(row_floats(length) * count);
    FftBuffer out(row_floats(length) * count);
    const fftwf_iodim row = dimension(length, 1, 1);
    const fftwf_iodim rows = dimension(count, row_floats(length) / 2, row_floats(length));
    const std::lock_guard lock(planner_mutex);
    return Fft(Kind::ComplexToReal,
               checked(fftwf_plan_guru_dft_c2r(
                   1, &row, 1, &rows, as_fftw(in.data()), out.data(), FFTW_ESTIMATE)));
}

Fft Fft::complex_batch(std::size_t length,
                       std::size_t count,
                       const Layout& layout,
                       Direction direction) {
    FftBuffer buffer = room_for(length, count, layout);
    return Fft(Kind::Complex,
               plan_complex(length, count, layout, layout, direction, buffer, buffer));
}

Fft Fft::complex_batch(std::size_t length,
                       std::size_t count,
                       const Layout& from,
                       const Layout& to,
                       Direction direction) {
    FftBuffer in = room_for(length, count, from);
    FftBuffer out = room_for(length, count, to);
    return Fft(Kind::Complex, plan_complex(length, count, from, to, direction, in, out));
}

void Fft::run(FftBuffer& from, FftBuffer& to) const {
    const auto plan = static_cast<fftwf_plan>(plan_.get());
    switch (kind_) {
        case Kind::RealToComplex:
            fftwf_execute_dft_r2c(plan, from.data(), as_fftw(to.data()));
            return;
        case Kind::ComplexToReal:
            fftwf_execute_dft_c2r(plan, as_fftw(from.data()), to.data());
            return;
        case Kind::Complex:
            fftwf_execute_dft(plan, as_fftw(from.data()), as_fftw(to.data()));
            return;
    }
}

void Fft::Destroy::operator()(void* plan) const {
    const std::lock_guard lock(planner_mutex);
    fftwf_destroy_plan(static_cast<fftwf_plan>(plan));
}

}  // namespace nlos
