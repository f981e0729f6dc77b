// SPDX-License-Identifier: MIT
#include "renderer/core/system/output_file.h"

#include "renderer/core/error.h"
#include "renderer/core/stopwatch.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>

namespace core {
namespace fs = std::filesystem;
namespace {

/// A place for a path that a signal handler may read at any time: no memory is freed here.
struct Slot {
    std::atomic<bool> is_taken{false};
    std::atomic<bool> is_ready{false};  ///< the path may be read
    std::array<char, PATH_MAX> path{};
};

std::array<Slot, 16> g_slots;  // more files than that at once are left to the next run

std::uint32_t hash_of(const std::string& text) {  // FNV-1a
    std::uint32_t hash = 2166136261U;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
    return hash;
}

/// Says where process numbers mean the same: the machine and, in it, the container.
std::string machine_tag() {
    std::array<char, 256> host{};
    std::array<char, 256> numbering{};
    ::gethostname(host.data(), host.size() - 1);
    const bool is_known =
        ::readlink("/proc/self/ns/pid", numbering.data(), numbering.size() - 1) > 0;
    return fmt::format("{:08x}",
                       hash_of(std::string(host.data()) + (is_known ? numbering.data() : "")));
}

struct PartialName {
    std::string begin;  ///< before the number of the process
    std::string end;    ///< after it
};

/// What is written in the end: where symbolic links lead, be there a file or not.
fs::path written_file(const std::string& target) {
    constexpr int kMostLinks = 40;
    fs::path path(target);
    std::error_code error;
    for (int i = 0; fs::is_symlink(path, error); ++i) {
        if (i == kMostLinks) throw Error(target, "is a link to itself", "must lead to a file");
        const fs::path next = fs::read_symlink(path, error);
        path = next.is_absolute() ? next : path.parent_path() / next;
    }
    return path;
}

/// target   what is written in the end
/// suffix   of the name that was asked for, by which libraries go
PartialName partial_name_of(const fs::path& target, const fs::path& suffix) {
    return {"." + target.stem().string() + ".", "-" + machine_tag() + ".partial" + suffix.string()};
}

fs::path folder_of(const fs::path& target) {
    return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

/// The process that a file of this name is from; nothing for other names.
std::optional<pid_t> process_of(const std::string& file, const PartialName& name) {
    if (!file.starts_with(name.begin) || !file.ends_with(name.end)) return std::nullopt;
    if (file.size() <= name.begin.size() + name.end.size()) return std::nullopt;
    const char* const last = file.data() + file.size() - name.end.size();
    pid_t process = 0;
    const auto [end, error] = std::from_chars(file.data() + name.begin.size(), last, process);
    if (error != std::errc() || end != last || process <= 0) return std::nullopt;
    return process;
}

bool has_ended(pid_t process) {
    return ::kill(process, 0) != 0 && errno == ESRCH;
}

/// Rests from listing a folder for many times as long as it took, when that was long: who writes
/// thousands of files into it spends little time on its leftovers.
class ListingPause {
 public:
    bool is_over(const fs::path& folder) {
        const std::lock_guard lock(mutex_);
        return folder != folder_ || Clock::now() >= end_;
    }
    void begin(const fs::path& folder, double listing_seconds) {
        constexpr double kShort_s = 1e-3;
        constexpr double kTimesAsLong = 50.0;
        const std::lock_guard lock(mutex_);
        folder_ = folder;
        end_ = Clock::now();
        if (listing_seconds < kShort_s) return;
        end_ += std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(kTimesAsLong * listing_seconds));
    }

 private:
    using Clock = std::chrono::steady_clock;
    std::mutex mutex_;
    fs::path folder_;
    Clock::time_point end_;
};

/// Removes partial files of a name whose process has ended on this machine; not those of other
/// machines or containers that share the folder, which may live. A folder that takes long to list
/// is not looked at every time.
void remove_stale_partial_files(const fs::path& folder, const PartialName& name) {
    static ListingPause pause;
    if (!pause.is_over(folder)) return;
    const Stopwatch clock;
    std::error_code error;
    std::error_code ignored;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const auto process = process_of(entry->path().filename().string(), name);
        if (process && has_ended(*process)) fs::remove(entry->path(), ignored);
    }
    pause.begin(folder, clock.seconds());
}

/// Until forgotten, remove_partial_files() removes the file.
void announce_partial_file(const std::string& path) {
    for (Slot& slot : g_slots) {
        if (path.size() >= slot.path.size() || slot.is_taken.exchange(true)) continue;
        std::strcpy(slot.path.data(), path.c_str());
        slot.is_ready = true;
        return;
    }
}

void forget_partial_file(const std::string& path) {
    for (Slot& slot : g_slots) {
        if (!slot.is_ready || path != slot.path.data()) continue;
        slot.is_ready = false;
        slot.is_taken = false;
        return;
    }
}

}  // namespace

std::string partial_file_of(const std::string& target) {
    const fs::path written = written_file(target);
    const PartialName name = partial_name_of(written, fs::path(target).extension());
    return (folder_of(written) / (name.begin + std::to_string(::getpid()) + name.end)).string();
}

OutputFile::OutputFile(std::string target)
    : target_(std::move(target)), written_(written_file(target_).string()) {
    constexpr std::size_t kLongestName = 200;  // file systems take 255, the temporary one is longer
    std::error_code ignored;
    const fs::path path(written_);
    if (!fs::is_directory(folder_of(path), ignored)) {
        throw Error(target_, "its folder does not exist", "must be in an existing folder");
    }
    if (fs::is_directory(path, ignored)) throw Error(target_, "is a folder", "must be a file name");
    if (const std::size_t bytes = path.filename().native().size(); bytes > kLongestName) {
        throw Error(target_,
                    "its name has " + std::to_string(bytes) + " bytes",
                    "must have at most " + std::to_string(kLongestName));
    }
    remove_stale_partial_files(folder_of(path),
                               partial_name_of(path, fs::path(target_).extension()));
    temporary_ = partial_file_of(target_);
    announce_partial_file(temporary_);
    // Only trying tells: root may write where the file system does not.
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file >= 0) {
        ::close(file);
        return;
    }
    const bool is_full = errno == ENOSPC || errno == EDQUOT;
    forget_partial_file(temporary_);
    if (is_full) throw Failure(target_, "cannot be written (disk full)");
    throw Error(target_, "its folder cannot be written", "must be in a writable folder");
}

OutputFile::~OutputFile() {
    std::error_code ignored;
    if (!committed_) fs::remove(temporary_, ignored);
    forget_partial_file(temporary_);
}

void OutputFile::commit() {
    std::error_code error;
    fs::rename(temporary_, written_, error);
    if (error) throw Failure(target_, "cannot be written (" + error.message() + ")");
    committed_ = true;
}

void remove_partial_files() noexcept {
    for (const Slot& slot : g_slots) {
        if (slot.is_ready) ::unlink(slot.path.data());
    }
}

void check_targets(const std::vector<std::string>& targets,
                   const std::vector<std::string>& inputs) {
    for (const std::string& target : targets) {
        if (target.empty()) continue;
        const OutputFile probe(target);
        for (const std::string& input : inputs) {
            std::error_code is_missing;
            if (!fs::equivalent(target, input, is_missing)) continue;
            throw Error(target, "is read as well", "must be another file");
        }
    }
}

void write_text_file(const std::string& path, const std::string& text) {
    OutputFile output(path);
    std::ofstream stream(output.temporary(), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw Failure(path, "cannot be written (disk full?)");
    output.commit();
}

}  // namespace core
