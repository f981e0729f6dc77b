// SPDX-License-Identifier: MIT
// All that a fit parameter says of itself, for every row of the list. Their derivatives of the
// whole prediction against differences: tests/calib/forward/forward_model_test.cpp.
#include "calib/fit/solution.h"
#include "calib/fit_file.h"
#include "calib/model/parameter.h"
#include "calib/model/state_vector.h"
#include "renderer/core/random.h"
#include "tests/support/error_message.h"
#include "tests/support/fit_examples.h"

#include <gtest/gtest.h>

#include <set>

namespace {

using calib::Owner;
using calib::Parameter;
using calib::SceneModel;
using calib::SceneState;

std::set<const Parameter*> rows_of(const SceneModel& model) {
    std::set<const Parameter*> rows;
    for (const calib::ParameterBlock& block : model.blocks()) rows.insert(block.row);
    return rows;
}

TEST(Parameters, AllAreFreeAtOnceAndStartAtFiniteNumbers) {
    const SceneModel model(test_support::two_objects(), test_support::all_free());
    EXPECT_EQ(rows_of(model).size(), calib::parameters().size());
    const SceneState start = model.start();
    for (const calib::ParameterBlock& block : model.blocks()) {
        const auto numbers = block.row->numbers(start, block.item);
        EXPECT_GE(numbers.size(), static_cast<std::size_t>(block.columns));
        for (const double number : numbers) EXPECT_TRUE(std::isfinite(number)) << block.row->name;
    }
    const std::vector<std::string> names = model.column_names();
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size());
}

TEST(Parameters, MoveByWhatTheirDifferenceSays) {
    const SceneModel model(test_support::two_objects(), test_support::all_free());
    core::Rng rng(test_support::seed_of("MoveByWhatTheirDifferenceSays"), 0, 0);
    SceneState state = model.start();
    for (int trial = 0; trial < 5; ++trial) {
        Eigen::VectorXd step(model.num_columns());
        for (double& part : step) part = 0.2 * (rng.uniform() - 0.5);
        const SceneState moved = calib::moved_by(model, state, step);
        const Eigen::VectorXd found = calib::difference(model, state, moved);
        for (Eigen::Index c = 0; c < step.size(); ++c) {
            EXPECT_NEAR(found[c], step[c], 1e-12)
                << model.column_names()[static_cast<std::size_t>(c)];
        }
        EXPECT_LT(calib::difference(model, moved, calib::StateVector(model, moved).state()).norm(),
                  1e-12);
        state = moved;
    }
}

TEST(Parameters, AreReadWrittenAndNamedInHelpAndErrors) {
    const std::string help = calib::free_help();
    for (const Parameter* row : calib::parameters()) {
        if (!row->is_setting || row->owner == Owner::Point) continue;
        const std::string name = row->name;
        const std::string key = name.substr(0, name.find('.'));
        EXPECT_NE(help.find(key), std::string::npos) << name;
        core::Json json;
        if (row->owner == Owner::Body) {
            json["target"] = {name};
            EXPECT_NE(help.find(row->group != nullptr ? row->group : name), std::string::npos);
        } else if (key == name) {
            json[name] = true;
        } else {
            json[key] = {name.substr(key.size() + 1)};
        }
        calib::FreeSettings free{{}, 0, {}, {}};
        calib::read_value(json, "free", free);
        if (row->owner == Owner::Body) {
            EXPECT_TRUE(free.objects.at(0).frees(*row)) << name;
            json["target"] = {"elbow"};
            EXPECT_ERROR_WITH(calib::read_value(json, "free", free), name);
        } else {
            EXPECT_TRUE(free.parameters.contains(name)) << name;
            EXPECT_EQ(free.parameters.size(), 1U);
            json[key] = "elbow";
            EXPECT_ERROR_WITH(calib::read_value(json, "free", free), "free." + key);
        }
        calib::FreeSettings again{{}, 0, {}, {}};
        calib::read_value(calib::write_value(free), "free", again);
        EXPECT_EQ(again.parameters, free.parameters);
        EXPECT_EQ(calib::write_value(again), calib::write_value(free));
    }
    calib::FitInput input = test_support::fit_input(
        test_support::expected_capture(
            test_support::two_objects(), test_support::confocal_grid(2), 1e4, 1.0),
        test_support::two_objects());
    input.settings.free.objects = {{"elbow", {"pose"}}};
    for (const std::string& name : calib::free_names(Owner::Scene)) {
        EXPECT_ERROR_WITH(calib::fit_scene(input, {}), name);
    }
    input.settings.free.parameters = {"elbow"};
    EXPECT_ERROR_WITH(calib::fit_scene(input, {}), "elbow");
}

TEST(Parameters, RefuseAResponseThatTheyCannotChange) {
    calib::FitInput input = test_support::fit_input(
        test_support::expected_capture(
            test_support::two_objects(), test_support::confocal_grid(2), 1e4, 1.0),
        test_support::two_objects());
    input.settings.response.tail_ps = 200.0;
    int num_refused = 0;
    for (const Parameter* row : calib::parameters()) {
        if (row->refusal == nullptr) continue;
        ++num_refused;
        core::ResponseSettings gaussian;
        gaussian.jitter_fwhm_ps = 90.0;
        EXPECT_FALSE(row->refusal(gaussian));
        input.settings.free.parameters = {row->name};
        EXPECT_ERROR_WITH(calib::fit_scene(input, {}), std::string("free.") + row->name);
    }
    EXPECT_GT(num_refused, 0);
}

// How many numbers of a JSON are not 0.
int count_nonzero(const core::Json& json) {
    if (json.is_number()) return json.get<double>() != 0.0 ? 1 : 0;
    int count = 0;
    for (const core::Json& item : json) count += count_nonzero(item);
    return count;
}

TEST(Parameters, AreWrittenWithTheirSigma) {
    const core::Capture capture = test_support::expected_capture(
        test_support::two_objects(), test_support::confocal_grid(4), 1e4, 1.0);
    calib::FitInput input = test_support::fit_input(capture, test_support::two_objects());
    input.settings.free = test_support::all_free().free;
    input.settings.residual = calib::ResidualKind::Poisson;
    const core::Progress silent;
    const calib::FitDriver driver(input, silent);
    EXPECT_EQ(rows_of(*driver.model).size(), calib::parameters().size());
    const calib::FitDriver::Stage stage = driver.make_stage(*driver.model, 0.0);
    const SceneState state = driver.model->start();
    for (const calib::ParameterBlock& block : driver.model->blocks()) {
        calib::Uncertainty uncertainty;
        uncertainty.sigma = Eigen::VectorXd::Zero(driver.model->num_columns());
        uncertainty.covariance =
            Eigen::MatrixXd::Zero(driver.model->num_columns(), driver.model->num_columns());
        for (int c = 0; c < block.columns; ++c) uncertainty.sigma[block.first_column + c] = 0.5 + c;
        calib::FitResult result;
        static_cast<calib::FittedValues&>(result) =
            calib::fitted_values(driver, stage, state, uncertainty, 0.0);
        EXPECT_EQ(count_nonzero(calib::fit_json(result).at("sigma")), block.columns)
            << block.row->name;
    }
}

}  // namespace
