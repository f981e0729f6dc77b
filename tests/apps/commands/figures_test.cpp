// SPDX-License-Identifier: MIT
// Pictures and films that the user names a file for.
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace {

using test_support::CommandLine;
using test_support::file_bytes;
using test_support::Outcome;

constexpr const char* kCapture = "data/letter.h5";
constexpr const char* kScene = "scenes/letter/scene.json";

class Figures : public CommandLine {
 protected:
    void expect_written(const std::string& command, const std::string& option, const char* name) {
        const Outcome outcome = run(command + " " + option + " " + file(name));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_NE(outcome.out.find(file(name)), std::string::npos) << outcome.out;
    }

    bool starts_with(const char* name, const std::string& bytes) const {
        return file_bytes(file(name)).starts_with(bytes);
    }
};

TEST_F(Figures, SuffixChoosesTheFormat) {
    const std::string info = std::string("info ") + kCapture;
    expect_written(info, "--picture", "capture.png");
    expect_written(info, "--picture", "capture.svg");
    expect_written(info, "--picture", "capture.pdf");
    EXPECT_TRUE(starts_with("capture.png", "\x89PNG"));
    EXPECT_TRUE(starts_with("capture.svg", "<?xml"));
    EXPECT_TRUE(starts_with("capture.pdf", "%PDF"));
    expect_bad_input(info + " --picture " + file("capture.eps"), "must be one of .png, .svg, .pdf");
}

TEST_F(Figures, StandBesideThePictureOfAResult) {
    const std::string volume = file("volume.h5");
    expect_written(std::string("reconstruct ") + kCapture + " -o " + volume + " --method lct",
                   "--picture",
                   "figure.pdf");
    EXPECT_TRUE(starts_with("figure.pdf", "%PDF"));
    EXPECT_TRUE(starts_with("volume.png", "\x89PNG"));
    expect_written("compare " + volume + " " + kScene, "--picture", "depths.svg");
    EXPECT_TRUE(starts_with("depths.svg", "<?xml"));

    expect_bad_input(std::string("reconstruct ") + kCapture + " -o " + file("v.h5") +
                         " --picture " + file("figure.jpg"),
                     "must be one of .png, .svg, .pdf");
    expect_bad_input("compare " + volume + " " + volume + " --picture " + file("none.pdf"),
                     "must come with a volume or a fit against a scene");
}

TEST_F(Figures, FilmsShowACaptureBinByBin) {
    const std::string info = std::string("info ") + kCapture;
    expect_written(info, "--film", "film.png");
    EXPECT_NE(file_bytes(file("film.png")).find("acTL"), std::string::npos);
    expect_bad_input(info + " --film " + file("film.gif"), "must be one of .png, .mp4");
    expect_bad_input(std::string("info ") + kScene + " --film " + file("film.png"), "capture");
}

TEST_F(Figures, VideosNeedFfmpeg) {
    const std::string info = std::string("info ") + kCapture;
    if (std::system("command -v ffmpeg >/dev/null") == 0) {
        expect_written(info, "--film", "film.mp4");
        EXPECT_EQ(file_bytes(file("film.mp4")).substr(4, 4), "ftyp");
    }
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", "/nowhere", 1);
    expect_bad_input(info + " --film " + file("film.mp4"), "install it, or name a .png");
    ::setenv("PATH", path.c_str(), 1);
}

}  // namespace
