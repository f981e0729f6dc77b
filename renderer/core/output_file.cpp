// SPDX-License-Identifier: MIT
#include "renderer/core/output_file.h"

#include "renderer/core/error.h"

#include <unistd.h>

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
    if (::access(folder.c_str(), W_OK) != 0) {
        throw Error(target_, "its folder cannot be written", "must be in a writable folder");
    }
    const std::string name = "." + path.stem().string() + "." + std::to_string(::getpid()) +
                             ".partial" + path.extension().string();
    temporary_ = (folder / name).string();
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

void write_text_file(const std::string& path, const std::string& text) {
    OutputFile output(path);
    std::ofstream stream(output.temporary(), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw Failure(path, "cannot be written (disk full?)");
    output.commit();
}

}  // namespace core
