// SPDX-License-Identifier: MIT
#include "renderer/core/output_file.h"

#include "renderer/core/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

namespace core {
namespace fs = std::filesystem;

OutputFile::OutputFile(std::string target) : target_(std::move(target)) {
    const fs::path path(target_);
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder)) {
        throw Error(target_, "its folder does not exist", "must be in an existing folder");
    }
    if (fs::is_directory(path)) throw Error(target_, "is a folder", "must be a file name");
    const std::string name = "." + path.stem().string() + "." + std::to_string(::getpid()) +
                             ".partial" + path.extension().string();
    temporary_ = (folder / name).string();
    // Only trying tells: root may write where the file system does not.
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0 && (errno == ENOSPC || errno == EDQUOT)) {
        throw Failure(target_, "cannot be written (disk full)");
    }
    if (file < 0) {
        throw Error(target_, "its folder cannot be written", "must be in a writable folder");
    }
    ::close(file);
}

OutputFile::~OutputFile() {
    std::error_code ignored;
    if (!committed_) fs::remove(temporary_, ignored);
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
