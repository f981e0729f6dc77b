// SPDX-License-Identifier: MIT
#include "nlos/containers/array_file.h"
#include "nlos/containers/deflated_bytes.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace nlos {
namespace {

constexpr std::string_view kGzipMagic = "\x1f\x8b";

/// What a gzip file holds, as a temporary file: libraries want a name, HDF5 one that is no link. It
/// needs none once it is open, so that nothing is left however this process ends.
class UnpackedFile {
 public:
    explicit UnpackedFile(const std::string& path)
        : packed_path_(path), path_(std::filesystem::temp_directory_path() / "nlos-XXXXXX") {
        descriptor_ = ::mkostemp(path_.data(), O_CLOEXEC);
        const core::MappedFile file(path);
        std::string_view rest = file.bytes();
        while (rest.starts_with(kGzipMagic)) {  // a file may be of several members
            const auto member = unpack(rest, DeflateFrame::Gzip, [&](auto piece) { write(piece); });
            if (!member) damaged();
            rest.remove_prefix(*member);
        }
        if (rest.find_first_not_of('\0') != std::string_view::npos) damaged();
    }
    ~UnpackedFile() {
        remove_name();
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    UnpackedFile(const UnpackedFile&) = delete;
    UnpackedFile& operator=(const UnpackedFile&) = delete;

    const std::string& path() const { return path_; }
    void remove_name() const { ::unlink(path_.c_str()); }

 private:
    void write(std::string_view piece) {
        while (!piece.empty()) {
            const ssize_t written = ::write(descriptor_, piece.data(), piece.size());
            if (written <= 0) {
                remove_name();
                throw core::Failure(packed_path_, "cannot be unpacked into " + path_);
            }
            piece.remove_prefix(static_cast<std::size_t>(written));
        }
    }
    [[noreturn]] void damaged() const {
        remove_name();
        throw core::Error(packed_path_, "is damaged or cut short", "must be a complete .gz file");
    }

    std::string packed_path_;
    std::string path_;
    int descriptor_ = -1;
};

/// A file packed by gzip, as the file that it holds: every request goes on to that one.
class GzipFile : public ArrayFile {
    /// Errors name the file that people know.
    template <class Work>
    auto told(Work&& work) const {
        try {
            return work();
        } catch (const core::Error& error) {
            const std::string inner = unpacked_.path();
            if (!error.where().starts_with(inner)) throw;
            throw core::Error(
                path_ + error.where().substr(inner.size()), error.found(), error.allowed());
        }
    }

 public:
    explicit GzipFile(const std::string& path) : path_(path), unpacked_(path) {
        const Container* kind = find_container(unpacked_.path());
        if (kind == nullptr) {
            throw core::Error(
                path_,
                "is packed by gzip and holds no file of arrays that its content tells",
                fmt::format("must be unpacked: gunzip -k {}", path_));
        }
        file_ = told([&] { return kind->open(unpacked_.path()); });
        unpacked_.remove_name();
    }

    std::string container() const override { return file_->container(); }
    bool first_index_fastest() const override { return file_->first_index_fastest(); }
    ArrayNames names() const override {
        return told([&] { return file_->names(); });
    }
    std::optional<ArrayDescription> describe(const std::string& name) const override {
        return told([&] { return file_->describe(name); });
    }
    std::string read(const std::string& name, const WantedRows& rows) const override {
        return told([&] { return file_->read(name, rows); });
    }

 private:
    std::string path_;
    UnpackedFile unpacked_;
    std::unique_ptr<ArrayFile> file_;
};

bool is_gzip_file(const std::string& path) {
    return core::first_bytes(path, kGzipMagic.size()) == kGzipMagic;
}

}  // namespace

Container gzip_container() {
    return {"one of these packed by gzip", is_gzip_file, open_as<GzipFile>};
}

}  // namespace nlos
