// SPDX-License-Identifier: MIT
#include "calib/statistics/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using Eigen::MatrixXd;

// Rows that depend on each other, in units twelve orders apart.
MatrixXd gram_of_dependent_columns(double unit) {
    MatrixXd rows(4, 3);
    rows << 1.0, 2.0, 3.0, 0.0, 1.0, 1.0, 2.0, -1.0, 1.0, 1.0, 1.0, 2.0;  // third = sum of others
    rows.col(1) *= unit;
    return rows.transpose() * rows;
}

TEST(GeneralizedInverse, OfFullRankIsTheInverse) {
    MatrixXd matrix(2, 2);
    matrix << 4.0, 1e6, 1e6, 1e12;
    const MatrixXd expected = (MatrixXd(2, 2) << 1e12, -1e6, -1e6, 4.0).finished() / 3e12;
    const MatrixXd inverse = calib::generalized_inverse(matrix);
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
            EXPECT_NEAR(inverse(i, j), expected(i, j), 1e-12 * std::abs(expected(i, j)));
        }
    }
}

TEST(GeneralizedInverse, SolvesWhatCanBeSolved) {
    for (const double unit : {1e-6, 1.0, 1e6}) {
        const MatrixXd gram = gram_of_dependent_columns(unit);
        const MatrixXd inverse = calib::generalized_inverse(gram);
        const MatrixXd back = gram * inverse * gram;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                EXPECT_NEAR(back(i, j), gram(i, j), 1e-12 * std::sqrt(gram(i, i) * gram(j, j)));
            }
        }
    }
}

TEST(GeneralizedInverse, LeavesParametersWithoutInformationAlone) {
    MatrixXd matrix = MatrixXd::Zero(2, 2);
    EXPECT_EQ(calib::generalized_inverse(matrix).norm(), 0.0);
    matrix(1, 1) = 4.0;
    const MatrixXd inverse = calib::generalized_inverse(matrix);
    EXPECT_EQ(inverse(0, 0), 0.0);
    EXPECT_DOUBLE_EQ(inverse(1, 1), 0.25);
}

}  // namespace
