// SPDX-License-Identifier: MIT
// Signals, limits and closed streams: nothing older is lost, nothing half is left, one line says
// why.
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>
#include <vector>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::Outcome;
using test_support::write_file_bytes;

// The line that answers the first signal at once is taken off what came after it.
std::string after_answer(const std::string& err, const std::string& answer) {
    const std::string start = "nlos: stopping" + answer;
    const std::size_t end = err.find('\n');
    const bool answers = err.starts_with(start) &&
                         err.substr(0, end).find("Ctrl-C again ends at once") != std::string::npos;
    EXPECT_TRUE(answers) << err;
    return answers ? err.substr(end + 1) : err;
}

void wait_for(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

class Interruption : public CommandLine {
 protected:
    // Starts the program; its output goes to the files that run() uses.
    pid_t start(const std::vector<std::string>& arguments) const {
        std::vector<std::string> texts{NLOS_PROGRAM};
        texts.insert(texts.end(), arguments.begin(), arguments.end());
        std::vector<char*> pointers;
        for (std::string& text : texts) pointers.push_back(text.data());
        pointers.push_back(nullptr);
        posix_spawn_file_actions_t streams;
        ::posix_spawn_file_actions_init(&streams);
        for (const auto& [stream, name] :
             {std::pair{STDOUT_FILENO, "out.txt"}, std::pair{STDERR_FILENO, "err.txt"}}) {
            ::posix_spawn_file_actions_addopen(
                &streams, stream, file(name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        }
        pid_t process = 0;
        EXPECT_EQ(
            ::posix_spawn(&process, NLOS_PROGRAM, &streams, nullptr, pointers.data(), ::environ),
            0);
        ::posix_spawn_file_actions_destroy(&streams);
        return process;
    }

    // Waits for the end; the status is negative after a signal.
    Outcome finish(pid_t process) const {
        int raw = 0;
        ::waitpid(process, &raw, 0);
        return {WIFSIGNALED(raw) ? -WTERMSIG(raw) : WEXITSTATUS(raw),
                file_bytes(file("out.txt")),
                test_support::without_progress(file_bytes(file("err.txt")))};
    }

    void wait_for_output(const std::string& part) const {
        for (int i = 0; i < 3000 && file_bytes(file("out.txt")).find(part) == std::string::npos;
             ++i) {
            wait_for(0.01);
        }
    }

    std::vector<std::string> partial_files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(fs::path(file("x")).parent_path())) {
            const std::string name = entry.path().filename().string();
            if (name.find(".partial") != std::string::npos) names.push_back(name);
        }
        return names;
    }

    std::vector<std::string> long_render() const {
        const std::string scene = make_scene("scene.json", core::Json::object());
        return {"render", scene, "-o", file("c.h5"), "--method", "path", "--samples", "100000000"};
    }
};

TEST_F(Interruption, SigtermKeepsWholePassesAsCtrlCDoes) {
    for (const int signal : {SIGTERM, SIGINT}) {
        write_file_bytes(file("c.h5"), "older result");
        const pid_t process = start(long_render());
        wait_for_output("paths of");
        wait_for(0.5);
        ::kill(process, signal);
        const Outcome outcome = finish(process);
        EXPECT_EQ(outcome.status, 1);
        const std::string err =
            after_answer(outcome.err, " after this pass, to write what was computed");
        EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
        EXPECT_NE(err.find("interrupted; " + file("c.h5") + " holds what was computed"),
                  std::string::npos)
            << err;
        EXPECT_FALSE(nlos::read_capture(file("c.h5")).transient.is_dark());
        EXPECT_TRUE(partial_files().empty());
    }
}

TEST_F(Interruption, ASecondSignalEndsAtOnce) {
    std::vector<std::string> render = long_render();
    render.insert(render.end(), {"--set", "scan.sensing_points=[512,512]"});
    write_file_bytes(file("c.h5"), "older result");
    const pid_t process = start(render);  // a single pass takes minutes
    wait_for_output("paths of");
    wait_for(0.5);
    ::kill(process, SIGINT);
    wait_for(0.1);
    ::kill(process, SIGTERM);
    const Outcome outcome = finish(process);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(after_answer(outcome.err, " after this pass"), "nlos: interrupted\n");
    EXPECT_EQ(file_bytes(file("c.h5")), "older result");
    EXPECT_TRUE(partial_files().empty());
}

TEST_F(Interruption, KilledAtAnyTimeNothingIsLostOrLeft) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> up_to(0.0, 0.6);
    ASSERT_EQ(run("convert data/letter.h5 " + file("in.npz")).status, 0);
    const std::vector<std::string> convert{"convert", file("in.npz"), file("out.h5")};
    const std::vector<std::string> reconstruct{"reconstruct", file("in.npz"), "-o", file("out.h5")};
    for (int i = 0; i < 18; ++i) {
        write_file_bytes(file("out.h5"), "older result");
        const int signal = std::array{SIGKILL, SIGTERM, SIGINT}[static_cast<std::size_t>(i % 3)];
        const pid_t process = start(i % 2 == 0 ? convert : reconstruct);
        wait_for(up_to(random));
        ::kill(process, signal);
        const Outcome outcome = finish(process);
        const std::string bytes = file_bytes(file("out.h5"));
        if (bytes != "older result") {
            EXPECT_EQ(run("info " + file("out.h5")).status, 0) << "a new result is whole";
        }
        if (signal == SIGKILL) continue;
        const std::string own = "." + std::to_string(process) + "-";
        for (const std::string& name : partial_files()) {
            EXPECT_EQ(name.find(own), std::string::npos) << name << " of an interrupted run";
        }
        if (outcome.status == 1) {
            EXPECT_TRUE(outcome.err.ends_with("interrupted\n")) << outcome.err;
        }
    }
    ASSERT_EQ(run("reconstruct " + file("in.npz") + " -o " + file("out.h5")).status, 0);
    EXPECT_TRUE(partial_files().empty()) << "the next run of the same names removes them";
}

// Every command with work of minutes: either signal is answered and ends it with one line, and
// nothing half is left.
TEST_F(Interruption, LongCommandsAnswerAndEndWithOneLineOnEitherSignal) {
    const std::string source = NLOS_SOURCE_DIR;
    const std::string recipe = source + "/data/recipes/confocal_32.json";
    ASSERT_EQ(run("render scenes/letter/scene.json -o " + file("in.h5")).status, 0);
    write_file_bytes(file("model.json"),
                     core::Json{{"scene", source + "/scenes/letter/scene.json"},
                                {"start", "search"},
                                {"free", {{"letter", {"pose", "albedo"}}}}}
                         .dump());
    const std::vector<std::vector<std::string>> commands{
        {"generate", recipe, "-o", file("set")},
        {"fit", file("in.h5"), file("model.json"), "-o", file("fit.json")},
        {"reconstruct",
         file("in.h5"),
         "-o",
         file("v.h5"),
         "--method",
         "bp",
         "--set",
         "volume.voxels=[512,512,512]"},
        {"bench", "reconstruct", "-o", file("bench"), "--scenes", source + "/scenes"}};
    for (const std::vector<std::string>& command : commands) {
        for (const int signal : {SIGTERM, SIGINT}) {
            const pid_t process = start(command);
            wait_for(0.7);
            ::kill(process, signal);
            const Outcome outcome = finish(process);
            EXPECT_EQ(outcome.status, 1) << command[0] << outcome.out;
            const std::string err = after_answer(outcome.err, "");
            EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << command[0] << ": " << err;
            EXPECT_NE(err.find("interrupted"), std::string::npos) << err;
            EXPECT_TRUE(partial_files().empty()) << command[0];
        }
    }
    for (const auto& entry : fs::directory_iterator(file("set"))) {
        EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
    }
    EXPECT_FALSE(fs::exists(file("v.h5")));
}

// Stopped again and again, a sweep comes to its end.
TEST_F(Interruption, ASweepKeepsWholeRunsAndGoesOn) {
    make_scene("scene.json", {{"time_axis", {{"num_bins", 256}}}});
    core::Json sweep{{"scene", "scene.json"}, {"fixed", {{"scene.scan.sensing_points", {8, 8}}}}};
    for (int photons = 1; photons <= 20; ++photons) {
        sweep["grid"]["noise.photons_per_point"].push_back(50 * photons);
    }
    write_file_bytes(file("sweep.json"), sweep.dump());
    const std::vector<std::string> command{"sweep", file("sweep.json"), "-o", file("out")};
    const auto num_files = [&] {
        std::error_code missing;
        fs::directory_iterator entries(file("out/runs"), missing);
        return std::count_if(begin(entries), end(entries), [](const auto& entry) {
            return !entry.path().filename().string().starts_with('.');
        });
    };
    std::ptrdiff_t num_kept = 0;
    for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
        const pid_t process = start(command);
        for (int i = 0; i < 3000 && num_files() < num_kept + 3; ++i) wait_for(0.005);
        ::kill(process, signal);
        const Outcome outcome = finish(process);
        ASSERT_LT(num_files(), 20) << "the sweep was interrupted before its end";
        EXPECT_GE(num_files(), num_kept + 3);
        num_kept = num_files();
        EXPECT_FALSE(fs::exists(file("out/sweep.json")));
        if (signal == SIGKILL) continue;
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(
            after_answer(outcome.err, "; what is done stays"),
            fmt::format("sweep: interrupted; {} of 20 runs are done, and the same command goes "
                        "on with the others\n",
                        num_kept));
    }
    EXPECT_EQ(run("sweep " + file("sweep.json") + " -o " + file("out")).status, 0);
    const core::Json result = core::read_json_file(file("out/sweep.json"));
    for (const core::Json& row : result["runs"]) {
        EXPECT_TRUE(row["failed"].is_null()) << "a run that was given up is no failure";
    }
}

TEST_F(Interruption, FilesBeyondTheLimitAreOneLine) {
    for (const std::string name : {"a.h5", "a.npz", "a.exr", "a.mat"}) {
        write_file_bytes(file(name), "older result");
        const std::string limited =
            "ulimit -f 1; '" NLOS_PROGRAM "' convert data/letter.h5 '" + file(name) + "'";
        const std::string command = "cd '" NLOS_SOURCE_DIR "'; (" + limited + ") >'" +
                                    file("out.txt") + "' 2>'" + file("err.txt") + "'";
        const int raw = std::system(("bash -c \"" + command + "\"").c_str());
        const std::string error = test_support::without_progress(file_bytes(file("err.txt")));
        EXPECT_EQ(WEXITSTATUS(raw), 1) << error;
        EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
        EXPECT_NE(error.find(name + ": "), std::string::npos) << error;
        EXPECT_EQ(file_bytes(file(name)), "older result");
        EXPECT_TRUE(partial_files().empty());
    }
}

TEST_F(Interruption, OutputThatNobodyReadsIsOneLine) {
    for (const std::string target : {"| true", "> /dev/full", ">&-"}) {
        const std::string program = "'" NLOS_PROGRAM "' info data/letter.h5 2>'" + file("err.txt");
        const std::string command = "cd '" NLOS_SOURCE_DIR "'; (sleep 0.2; " + program +
                                    "'; echo $? >'" + file("status") + "') " + target;
        ASSERT_EQ(std::system(("bash -c \"" + command + "\" 2>/dev/null").c_str()) & 0x7f, 0);
        const std::string error = test_support::without_progress(file_bytes(file("err.txt")));
        EXPECT_EQ(error.rfind("standard output: cannot be written (", 0), 0U) << error;
        EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
    }
}

TEST_F(Interruption, MessagesNeverLandInAResult) {
    ASSERT_EQ(std::system(("cd '" NLOS_SOURCE_DIR "'; '" NLOS_PROGRAM "' convert data/letter.h5 '" +
                           file("a.mat") + "' >&- 2>&-")
                              .c_str()) &
                  0x7f,
              0);
    EXPECT_EQ(run("info " + file("a.mat")).status, 0);
}

}  // namespace
