// SPDX-License-Identifier: MIT
#include "renderer/core/capture/recorded_detector.h"

#include "renderer/core/settings/settings_json.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

namespace {

// One pair, one bin of 8 mm (27 ps), recorded by a detector.
core::Capture recorded_by(const core::Json& detector) {
    core::Capture capture;
    capture.time_axis = {1.0, 0.008, 1};
    capture.transient = core::Transient(1, 1);
    capture.transient.values()[0] = 100.0F;
    capture.scene_info["detector"] = detector;
    return capture;
}

const core::Json kResponse = {{"jitter_fwhm_ps", 60.0}, {"tail_ps", 20.0}, {"curve", ""}};

TEST(RecordedDetector, ResponseIsThatOfTheProvenance) {
    const core::Capture capture = recorded_by({{"response", kResponse}});
    const auto response = core::recorded_response(capture);
    ASSERT_TRUE(response);
    EXPECT_EQ(response->jitter_fwhm_ps, 60.0);
    EXPECT_EQ(response->tail_ps, 20.0);

    core::ResponseSettings asked;
    core::read_value(core::Json("capture"), "response", asked);
    EXPECT_EQ(core::write_value(asked), "capture");
    EXPECT_EQ(core::resolve_response(asked, capture, "response").jitter_fwhm_ps, 60.0);
    core::read_value(core::Json{{"jitter_fwhm_ps", 5.0}}, "response", asked);
    EXPECT_EQ(core::resolve_response(asked, capture, "response").jitter_fwhm_ps, 5.0);
}

TEST(RecordedDetector, SpotIsThatOfTheProvenance) {
    EXPECT_EQ(core::recorded_spot_m(recorded_by({{"spot_m", 0.08}})), 0.08);
    for (const core::Json& none : {core::Json(nullptr), core::Json("wide"), core::Json(-0.1)}) {
        EXPECT_FALSE(core::recorded_spot_m(recorded_by({{"spot_m", none}}))) << none;
    }
}

TEST(RecordedDetector, CapturesThatGiveNoneHaveNone) {
    for (const core::Json& made : {core::Json(nullptr),
                                   core::Json::array({1, 2}),
                                   core::Json{{"detector", "a SPAD"}},
                                   core::Json{{"detector", {{"response", 7}}}},
                                   core::Json{{"detector", {{"response", {{"tail_ps", "x"}}}}}}}) {
        core::Capture capture = recorded_by(nullptr);
        capture.scene_info = made;
        EXPECT_FALSE(core::recorded_response(capture)) << made;
        EXPECT_FALSE(core::detector_warning(capture)) << made;
        core::ResponseSettings asked;
        asked.of_capture = true;
        EXPECT_ERROR_WITH(core::resolve_response(asked, capture, "response"), "gives no response");
    }
}

TEST(RecordedDetector, ItsResponseIsUsedWhereItMattersAndNoneIsAskedFor) {
    const core::Capture capture = recorded_by({{"response", kResponse}});
    core::ResponseSettings asked;
    EXPECT_EQ(core::resolve_response(asked, capture, "response").jitter_fwhm_ps, 60.0);
    core::read_value(core::Json("none"), "response", asked);
    EXPECT_EQ(core::write_value(asked), "none");
    EXPECT_FALSE(core::is_given(core::resolve_response(asked, capture, "response")));
    // A tenth of a bin does not matter.
    const core::Capture narrow = recorded_by({{"response", {{"jitter_fwhm_ps", 6.0}}}});
    EXPECT_FALSE(core::is_given(core::resolve_response({}, narrow, "response")));
}

TEST(RecordedDetector, TheScenesDetectorIsTakenWhereNoneIsAskedFor) {
    core::Capture capture = recorded_by(nullptr);
    EXPECT_FALSE(core::is_given(core::resolve_scene_response({}, capture)));
    capture.scene_info["settings"]["detector"]["jitter_fwhm_ps"] = 60.0;
    EXPECT_EQ(core::resolve_scene_response({}, capture).jitter_fwhm_ps, 60.0);
    core::ResponseSettings asked;
    asked.tail_ps = 5.0;
    EXPECT_EQ(core::resolve_scene_response(asked, capture).jitter_fwhm_ps, 0.0);
    asked = {};
    asked.is_none = true;
    EXPECT_FALSE(core::is_given(core::resolve_scene_response(asked, capture)));
}

TEST(RecordedDetector, PileUpIsNamedWhereItMatters) {
    const auto text = core::detector_warning(recorded_by({{"pulses", 1000}}));
    ASSERT_TRUE(text);
    EXPECT_NE(text->find("0.1 per pulse"), std::string::npos) << *text;
    EXPECT_FALSE(core::detector_warning(recorded_by({{"pulses", 100000}})));
}

}  // namespace
