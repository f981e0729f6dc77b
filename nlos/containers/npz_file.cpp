// SPDX-License-Identifier: MIT
#include "nlos/containers/file_memory.h"
#include "nlos/containers/npy_array.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>
#include <zip.h>

#include <filesystem>
#include <memory>

namespace nlos {
namespace {

using ZipHandle = std::unique_ptr<zip_t, void (*)(zip_t*)>;
using MemberHandle = std::unique_ptr<zip_file_t, int (*)(zip_file_t*)>;

constexpr std::string_view kSuffix = ".npy";

/// A .npz file of NumPy: a zip archive whose members are .npy files, stored or deflated. The member
/// read last is kept, for arrays that are asked for piece by piece.
class NpzFile : public ArrayFile {
 public:
    explicit NpzFile(const std::string& path)
        : path_(path), file_bytes_(std::filesystem::file_size(path)) {
        int error = 0;
        archive_.reset(zip_open(path_.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error));
        if (!archive_) {
            throw core::Error(path_, "is damaged or cut short", "must be a complete .npz file");
        }
        if (names().names.empty()) {
            throw core::Error(
                path_, "is a zip archive without .npy members", "must be an .npz file");
        }
    }

    std::string container() const override { return "npz"; }

    ArrayNames names() const override {
        ArrayNames found;
        const auto count = static_cast<zip_uint64_t>(
            std::max<zip_int64_t>(0, zip_get_num_entries(archive_.get(), 0)));
        for (zip_uint64_t i = 0; i < count && found.is_complete; ++i) {
            const char* member = zip_get_name(archive_.get(), i, ZIP_FL_ENC_RAW);
            if (member == nullptr || !std::string_view(member).ends_with(kSuffix)) continue;
            const std::string_view name(member);
            found.is_complete = found.names.size() < ArrayNames::kMost;
            if (found.is_complete)
                found.names.emplace_back(name.substr(0, name.size() - kSuffix.size()));
        }
        return found;
    }

    std::optional<ArrayDescription> describe(const std::string& name) const override {
        if (name == "/") return ArrayDescription();
        if (!find(name)) return std::nullopt;
        const NpyHeader header = read_header(name);
        const bool is_text = header.array.kind == ElementKind::Text;
        return describe_npy(header, is_text ? data_of(name, header) : std::string_view());
    }

    std::string read(const std::string& name, const WantedRows& rows) const override {
        NpyHeader header = read_header(name);
        header.array.bytes = data_of(name, header);
        return read_stored(header.array, rows);
    }

 private:
    std::string where(const std::string& name) const { return path_ + ": " + name; }

    /// What the archive says of a member, after checking it against the file's size.
    zip_stat_t checked_stat(zip_uint64_t index, const std::string& name) const {
        constexpr std::uint64_t kTebibyte = std::uint64_t{1} << 40;
        zip_stat_t stat{};
        constexpr zip_uint64_t kNeeded = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
        if (zip_stat_index(archive_.get(), index, 0, &stat) != 0 ||
            (stat.valid & kNeeded) != kNeeded) {
            throw core::Error(where(name), "is damaged", "must be an undamaged archive");
        }
        if (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE) {
            throw core::Error(where(name),
                              fmt::format("is compressed by method {}", stat.comp_method),
                              "must be stored or deflated, as np.savez and np.savez_compressed do");
        }
        const std::uint64_t stored = std::min<std::uint64_t>(stat.comp_size, file_bytes_);
        if (stat.size > stored * (stat.comp_method == ZIP_CM_STORE ? 1 : kLargestDeflateRatio)) {
            throw core::Error(
                where(name),
                fmt::format("claims {} bytes but only {} are stored", stat.size, stored),
                "must be complete");
        }
        if (stat.size >= kTebibyte) {
            throw core::Error(
                where(name),
                fmt::format("unpacks to {:.1f} TiB",
                            static_cast<double>(stat.size) / static_cast<double>(kTebibyte)),
                "must be smaller than 1 TiB");
        }
        return stat;
    }

    std::optional<zip_uint64_t> find(const std::string& name) const {
        const std::string member = name + std::string(kSuffix);
        const zip_int64_t found = zip_name_locate(archive_.get(), member.c_str(), ZIP_FL_ENC_RAW);
        if (found < 0) return std::nullopt;
        return static_cast<zip_uint64_t>(found);
    }

    /// The first bytes of a member, at most `most` of them; the whole is checked by its sum.
    std::string inflate(const std::string& name, std::uint64_t most) const {
        const zip_uint64_t index = *find(name);
        const std::uint64_t whole = checked_stat(index, name).size;
        const std::uint64_t size = std::min(most, whole);
        require_memory(3 * size, where(name));
        const MemberHandle member(zip_fopen_index(archive_.get(), index, 0), zip_fclose);
        std::string bytes(size, '\0');
        std::uint64_t done = 0;
        while (member && done < size) {
            const zip_int64_t got = zip_fread(member.get(), bytes.data() + done, size - done);
            if (got <= 0) break;
            done += static_cast<std::uint64_t>(got);
        }
        char beyond = 0;
        if (!member || done < size || (size == whole && zip_fread(member.get(), &beyond, 1) != 0)) {
            throw core::Error(where(name), "is damaged", "must be an undamaged archive");
        }
        return bytes;
    }

    NpyHeader read_header(const std::string& name) const {
        return parse_npy_header(
            inflate(name, kLongestNpyHeader), checked_stat(*find(name), name).size, where(name));
    }

    /// The values of a member, which is kept from now on.
    std::string_view data_of(const std::string& name, const NpyHeader& header) const {
        if (kept_name_ != name) {
            kept_.clear();
            kept_.shrink_to_fit();
            kept_ = inflate(name, std::numeric_limits<std::uint64_t>::max());
            kept_name_ = name;
        }
        return std::string_view(kept_).substr(header.data_begin);
    }

    std::string path_;
    std::uint64_t file_bytes_ = 0;
    ZipHandle archive_{nullptr, zip_discard};
    mutable std::string kept_name_;
    mutable std::string kept_;  ///< the whole member `kept_name_`
};

bool is_npz_file(const std::string& path) {
    const std::string mark = core::first_bytes(path, 4);
    return mark == "PK\x03\x04" || mark == "PK\x05\x06";
}

}  // namespace

Container npz_container() {
    return {"NumPy .npz", is_npz_file, open_as<NpzFile>};
}

}  // namespace nlos
