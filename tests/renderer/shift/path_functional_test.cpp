// SPDX-License-Identifier: MIT
#include "renderer/shift/path_functional.h"

#include "renderer/core/random.h"
#include "tests/support/shift_cases.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace {

using core::Mat3;
using core::Vec3;

constexpr int kCases = 200;
constexpr double kStep = 1e-3;

// Fourth-order central differences of `f` at p, one column per coordinate.
template <class F>
auto differences(const F& f, const Vec3& p) {
    Eigen::Matrix<double, decltype(f(p))::RowsAtCompileTime, 3> result;
    for (int k = 0; k < 3; ++k) {
        const Vec3 h = kStep * Vec3::Unit(k);
        result.col(k) =
            (8.0 * (f(p + h) - f(p - h)) - (f(p + 2.0 * h) - f(p - 2.0 * h))) / (12.0 * kStep);
    }
    return result;
}

template <class Functional>
double value_error(const Functional& functional, const Vec3& p, const Vec3& v) {
    const auto value = [&](const Vec3& x) {
        return Eigen::Matrix<double, 1, 1>(functional.expand(x, v).value);
    };
    return (differences(value, p).transpose() - functional.expand(p, v).gradient).norm();
}

template <class Functional>
Mat3 hessian_of(const Functional& functional, const Vec3& p, const Vec3& v) {
    const auto e = functional.expand(p, v);
    Mat3 hessian;
    for (int k = 0; k < 3; ++k) hessian.col(k) = e.hessian_times(Vec3::Unit(k));
    return hessian;
}

template <class Functional>
Mat3 hessian_by_differences(const Functional& functional, const Vec3& p, const Vec3& v) {
    return differences([&](const Vec3& x) { return functional.expand(x, v).gradient; }, p);
}

// Foci between 0.5 and 2 m from p, velocities up to 1 m/s.
struct Draw {
    explicit Draw(std::uint64_t i) : rng(test_support::seed_of("PathFunctional"), i, 0) {}

    Vec3 away() { return (0.5 + 1.5 * rng.uniform()) * test_support::random_direction(rng); }
    Vec3 slow() { return rng.uniform() * test_support::random_direction(rng); }
    core::Rng rng;
};

TEST(OpticalLength, DerivativesMatchCentralDifferences) {
    for (std::uint64_t i = 0; i < kCases; ++i) {
        Draw draw(i);
        const Vec3 p = draw.away();
        const renderer::OpticalLength length{p + draw.away(), p + draw.away()};
        EXPECT_LE(value_error(length, p, Vec3::Zero()), 1e-9);
        const Mat3 hessian = hessian_of(length, p, Vec3::Zero());
        EXPECT_LE((hessian - hessian_by_differences(length, p, Vec3::Zero())).norm(), 1e-8);
    }
}

TEST(PathVelocity, DerivativesMatchCentralDifferences) {
    for (std::uint64_t i = 0; i < kCases; ++i) {
        Draw draw(i);
        const Vec3 p = draw.away();
        const renderer::PathVelocity velocity{
            p + draw.away(), p + draw.away(), draw.slow(), draw.slow()};
        const Vec3 v = draw.slow();
        EXPECT_LE(value_error(velocity, p, v), 1e-8);
        const Mat3 hessian = hessian_of(velocity, p, v);
        EXPECT_LE((hessian - hessian_by_differences(velocity, p, v)).norm(), 1e-7);
    }
}

TEST(PathVelocity, IsTheTimeDerivativeOfTheLength) {
    for (std::uint64_t i = 0; i < kCases; ++i) {
        Draw draw(i);
        const Vec3 p = draw.away();
        const renderer::PathVelocity velocity{
            p + draw.away(), p + draw.away(), draw.slow(), draw.slow()};
        const Vec3 v = draw.slow();
        const auto length_at = [&](double t) {
            return renderer::OpticalLength{velocity.focus_a + t * velocity.velocity_a,
                                           velocity.focus_y + t * velocity.velocity_y}
                .expand(p + t * v, v)
                .value;
        };
        const double h = 1e-4;
        EXPECT_NEAR(velocity.expand(p, v).value, (length_at(h) - length_at(-h)) / (2.0 * h), 1e-7);
    }
}

// Equations (10) and (11) of the supplement, word for word: u_i are the relative velocities, d_i
// the directions. (10) is a matrix; read as one to be applied to the velocity, and as one to be
// applied to the direction.
struct Printed {
    Vec3 gradient_on_velocity = Vec3::Zero();
    Vec3 gradient_on_direction = Vec3::Zero();
    Mat3 hessian = Mat3::Zero();

    Printed(const renderer::PathVelocity& path, const Vec3& p, const Vec3& v) {
        for (const auto& [focus, focus_velocity] :
             {std::pair{path.focus_a, path.velocity_a}, {path.focus_y, path.velocity_y}}) {
            const Vec3 r = focus - p;
            const double distance = r.norm();
            const Vec3 d = r / distance;
            const Vec3 u = focus_velocity - v;
            const double c = d.dot(u);
            const Mat3 as_printed = -(Mat3::Identity() - u * u.transpose()) / distance;
            gradient_on_velocity += as_printed * u;
            gradient_on_direction += as_printed * d;
            hessian -= (d * u.transpose() + u * d.transpose() - 2.0 * c * d * d.transpose() -
                        c * Mat3::Identity()) /
                       (distance * distance);
        }
    }
};

TEST(PathVelocity, FormulasAsPrintedInTheSupplementAreNotItsDerivatives) {
    for (std::uint64_t i = 0; i < kCases; ++i) {
        Draw draw(i);
        const Vec3 p = draw.away();
        const renderer::PathVelocity velocity{
            p + draw.away(), p + draw.away(), draw.slow(), draw.slow()};
        const Vec3 v = draw.slow();
        const Vec3 gradient =
            differences(
                [&](const Vec3& x) {
                    return Eigen::Matrix<double, 1, 1>(velocity.expand(x, v).value);
                },
                p)
                .transpose();
        const Printed printed(velocity, p, v);
        EXPECT_GE((printed.gradient_on_velocity - gradient).norm(), 1e-3);
        EXPECT_GE((printed.gradient_on_direction - gradient).norm(), 1e-3);
        EXPECT_GE((printed.hessian - hessian_by_differences(velocity, p, v)).norm(), 1e-3);
    }
}

}  // namespace
