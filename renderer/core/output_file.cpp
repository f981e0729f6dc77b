// SPDX-License-Identifier: MIT
#include "renderer/core/output_file.h"

#include "renderer/core/error.h"
#include "renderer/core/partial_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

namespace core {
namespace fs = std::filesystem;

OutputFile::OutputFile(std::string target) : target_(std::move(target)) {
    constexpr std::size_t kLongestName = 200;  // file systems take 255, the temporary one is longer
    std::error_code ignored;
    const fs::path path(target_);
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) {
        throw Error(target_, "its folder does not exist", "must be in an existing folder");
    }
    if (fs::is_directory(path, ignored)) throw Error(target_, "is a folder", "must be a file name");
    if (const std::size_t bytes = path.filename().native().size(); bytes > kLongestName) {
        throw Error(target_,
                    "its name has " + std::to_string(bytes) + " bytes",
                    "must have at most " + std::to_string(kLongestName));
    }
    remove_stale_partial_files(target_);
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
    fs::rename(temporary_, target_, error);
    if (error) throw Failure(target_, "cannot be written (" + error.message() + ")");
    committed_ = true;
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
