// SPDX-License-Identifier: MIT
// However much lies in a folder, its page takes what it may, says what it leaves out, and is UTF-8.
#include "apps/report/report.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "tests/apps/page/page_text.h"
#include "tests/apps/report/example_scores.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_volume.h"
#include "tests/support/temporary_folder.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace apps {
namespace {

using page_test::contains;
using page_test::count_of;
using test_support::TemporaryFolder;

constexpr int kCaptures = 8;
constexpr int kVolumes = 5;
constexpr int kOthers = 16;
constexpr std::size_t kSkeleton = 500;  // bytes of a page's head

/// A page without the style sheet and the scripts that all pages have.
std::string without_what_all_have(std::string html) {
    for (const std::string element : {"style>", "script>"}) {
        for (std::size_t at = html.find('<' + element); at != std::string::npos;
             at = html.find('<' + element)) {
            html.erase(at, html.find("</" + element, at) - at);
        }
    }
    return html;
}

/// Captures, volumes with scores and their pictures, drawings, long JSON, damaged files.
void fill_with_many(const TemporaryFolder& folder) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    capture.scene_info["command"] = std::string(3000, 'c');
    for (int i = 0; i < kCaptures; ++i) {
        nlos::write_capture(folder.file(fmt::format("c{}.h5", i)), capture);
    }
    for (int i = 0; i < kOthers; ++i) {
        core::write_text_file(folder.file(fmt::format("other_{}.json", i)),
                              core::Json{{"text", std::string(20'000, 't')}}.dump());
        core::write_text_file(folder.file(fmt::format("damaged_{}.h5", i)), "no HDF5");
        core::write_text_file(folder.file(fmt::format("drawing_{}.svg", i)),
                              "<svg>" + std::string(5000, ' ') + "</svg>");
    }
    const auto volume = test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71});
    core::Json scores = core::write_value(report_test::scores(0.002, 0.75));
    for (int i = 0; i < kVolumes; ++i) {
        const std::string file = fmt::format("v{}.h5", i);
        nlos::write_volume(folder.file(file), volume);
        nlos::write_panels(folder.file(fmt::format("m{}.png", i)), nlos::volume_panels(volume), 2);
        scores["result"] = file;
        core::write_text_file(folder.file(fmt::format("m{}.json", i)), scores.dump());
    }
}

/// These, read once for all tests.
const ResultsFolder& many_results() {
    static const ResultsFolder results = [] {
        const TemporaryFolder folder;
        fill_with_many(folder);
        return read_results_folder(folder.path().string());
    }();
    return results;
}

TEST(PageRoom, EverythingTogetherStaysWithinTheLimit) {
    const ResultsFolder& results = many_results();
    std::size_t last = 0;
    for (const double limit : {0.03e6, 0.1e6, 0.4e6}) {
        const auto [html, reductions] = render_report(results, limit);
        const std::size_t bytes = without_what_all_have(html).size();
        EXPECT_LE(bytes, static_cast<std::size_t>(limit) + kSkeleton);
        EXPECT_GT(bytes, last) << "more room is used";
        last = bytes;
        EXPECT_TRUE(contains(html, "8 captures, 5 reconstructions, 5 comparisons"));
        EXPECT_TRUE(contains(html, "16 unreadable files"));
        EXPECT_TRUE(contains(html, "<p class=\"reduced\">" + reductions + "</p>"));
        EXPECT_TRUE(contains(reductions, fmt::format("within {:.4g} MB", 1e-6 * limit)));
        for (const std::string file : {"c7.h5", "v4.h5", "damaged_15.h5", "drawing_9.svg"}) {
            EXPECT_TRUE(contains(html, file)) << file << " is at least named";
        }
    }
    const std::string small = render_report(results, 0.03e6).reductions;
    EXPECT_TRUE(contains(small, "there are no interactive views")) << small;
    EXPECT_TRUE(contains(small, "pictures are left out")) << small;
    EXPECT_TRUE(contains(small, "settings and other JSON are left out")) << small;
    EXPECT_TRUE(contains(small, "names the others")) << small;
}

TEST(PageRoom, WithTheRoomThatThePageAsksForItShowsEverything) {
    const ResultsFolder& results = many_results();
    const std::string reductions = render_report(results, 0.1e6).reductions;
    const std::string option = "--data-mb ";
    const double asked = std::stod(reductions.substr(reductions.find(option) + option.size()));
    const Report report = render_report(results, 1e6 * asked);
    EXPECT_EQ(report.reductions, "");
    const std::string html = without_what_all_have(report.html);
    EXPECT_FALSE(contains(html, "class=\"reduced\""));
    EXPECT_FALSE(contains(html, "left out"));
    EXPECT_FALSE(contains(html, "image/jpeg"));
    EXPECT_EQ(count_of(html, "data-view=\"animation\""), static_cast<std::size_t>(kCaptures));
    EXPECT_LE(static_cast<double>(html.size()), 1e6 * asked);
    EXPECT_NE(render_report(results, 1e6 * (asked - 1.1)).reductions, "") << "no less is enough";
}

TEST(PageRoom, FilesWhoseNamesAreNoUtf8AreShownByPagesThatAre) {
    const TemporaryFolder folder;
    const auto volume = test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71});
    nlos::write_capture(folder.file("c\xff.h5"),
                        test_support::example_capture(core::ScanPattern::Confocal));
    nlos::write_volume(folder.file("v\xff.h5"), volume);
    nlos::write_volume(folder.file("v\xfe.h5"), volume);
    core::Json scores = core::write_value(report_test::scores(0.002, 0.75));
    scores["result"] = core::printable(folder.file("v\xff.h5"));  // as nlos compare says it
    core::write_text_file(folder.file("m\xff.json"), scores.dump());
    nlos::write_panels(folder.file("m\xff.png"), nlos::volume_panels(volume), 2);
    core::write_text_file(folder.file("other\xff.json"), R"({"a": 1})");
    core::write_text_file(folder.file("broken\xff.h5"), "no HDF5");
    core::write_text_file(folder.file("drawing\xff.svg"), "<svg/>");
    for (const ResultsFolder& results :
         {read_results_folder(folder.path().string()),
          read_result_files({folder.file("c\xff.h5"), folder.file("v\xff.h5")})}) {
        const std::string html = render_report(results, 1e9).html;
        EXPECT_NO_THROW(core::Json(html).dump()) << "which refuses what is no UTF-8";
        EXPECT_FALSE(contains(html, "\xef\xbf\xbd")) << "no character is replaced";
        EXPECT_TRUE(contains(html, "<h3>c\\xff.h5</h3>"));
        EXPECT_TRUE(contains(html, "\"name\":\"c\\\\xff.h5\"")) << "in the data of the views";
    }
    const ResultsFolder results = read_results_folder(folder.path().string());
    ASSERT_EQ(results.scores.size(), 1U);
    EXPECT_EQ(results.scores[0].result, results.volumes[1].file);
    EXPECT_EQ(results.figures.size(), 1U) << "the picture of the scores stands with them";
}

}  // namespace
}  // namespace apps
