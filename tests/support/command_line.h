// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

namespace test_support {

namespace fs = std::filesystem;

struct Outcome {
    int status = -1;
    std::string out;
    std::string err;  ///< without lines of progress
};

// Whatever takes more than a second, as all may on a busy machine, says how far it is.
inline std::string without_progress(const std::string& text) {
    std::istringstream lines(text);
    std::string rest;
    for (std::string line; std::getline(lines, line);) {
        if (!line.ends_with(" s left") && !line.ends_with(" s so far")) rest += line + '\n';
    }
    return rest;
}

/// The program as its users call it, in a folder of its own.
class CommandLine : public testing::Test {
 protected:
    std::string file(const std::string& name) const { return folder_.file(name); }

    // Runs the program in a folder.
    Outcome run(const std::string& arguments, const std::string& folder = NLOS_SOURCE_DIR) const {
        const std::string command = "cd '" + folder + "' && '" NLOS_PROGRAM "' " + arguments +
                                    " >'" + file("out.txt") + "' 2>'" + file("err.txt") + "'";
        const int raw = std::system(command.c_str());
        return {WEXITSTATUS(raw),
                file_bytes(file("out.txt")),
                without_progress(file_bytes(file("err.txt")))};
    }

    // Expects status 2, one line that contains `part`, and that `output` stays as it was.
    void expect_bad_input(const std::string& arguments,
                          const std::string& part,
                          const std::string& output = "") const {
        if (!output.empty()) write_file_bytes(output, "older result");
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << arguments << "\n"
                                                                               << outcome.err;
        EXPECT_NE(outcome.err.find(part), std::string::npos) << arguments << "\n" << outcome.err;
        if (output.empty()) return;
        EXPECT_EQ(file_bytes(output), "older result") << arguments;
        for (const auto& entry : fs::directory_iterator(fs::path(output).parent_path())) {
            EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
        }
    }

    // A small scene beside a copy of the letter; `changes` are merged into its JSON.
    std::string make_scene(const std::string& name, const core::Json& changes) const {
        fs::copy_file(NLOS_SOURCE_DIR "/scenes/letter/scene.glb",
                      file("scene.glb"),
                      fs::copy_options::overwrite_existing);
        core::Json scene = core::read_json_file(NLOS_SOURCE_DIR "/scenes/letter/scene.json");
        scene["scan"]["sensing_points"] = {16, 16};
        scene["render"]["samples"] = 32;
        scene.merge_patch(changes);
        write_file_bytes(file(name), scene.dump());
        return file(name);
    }

    TemporaryFolder folder_;
};

}  // namespace test_support
