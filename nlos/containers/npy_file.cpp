// SPDX-License-Identifier: MIT
#include "nlos/containers/npy_array.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>

#include <filesystem>

namespace nlos {
namespace {

constexpr const char* kName = "array";

/// A .npy file of NumPy: one array.
class NpyFile : public ArrayFile {
 public:
    explicit NpyFile(const std::string& path)
        : file_(path),
          header_(parse_npy_header(
              file_.bytes().substr(0, kLongestNpyHeader), file_.bytes().size(), path)) {
        if (header_.content == NpyHeader::Content::Pickle) refuse_pickle(path);
        header_.array.bytes = file_.bytes().substr(header_.data_begin);
    }

    std::string container() const override { return "npy"; }
    ArrayNames names() const override { return {{kName}, true}; }

    std::optional<ArrayDescription> describe(const std::string& name) const override {
        if (name == "/") return ArrayDescription();
        if (name != kName) return std::nullopt;
        return describe_npy(header_, header_.array.bytes);
    }

    std::string read(const std::string&,
                     std::size_t first,
                     std::size_t count,
                     Precision precision) const override {
        return read_stored(header_.array, first, count, precision);
    }

 private:
    [[noreturn]] static void refuse_pickle(const std::string& path) {
        const std::string target = std::filesystem::path(path).replace_extension(".npz").string();
        throw core::Error(
            path,
            "holds pickled Python objects, which can run code of any kind",
            fmt::format("must hold numbers, as after: python3 -c \"import numpy as np; "
                        "np.savez('{}', **np.load('{}', allow_pickle=True).item())\"",
                        target,
                        path));
    }

    core::MappedFile file_;
    NpyHeader header_;
};

bool is_npy_file(const std::string& path) {
    return is_npy(core::first_bytes(path, 6));
}

}  // namespace

Container npy_container() {
    return {"NumPy .npy", is_npy_file, open_as<NpyFile>};
}

}  // namespace nlos
