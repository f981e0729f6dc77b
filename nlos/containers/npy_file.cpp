// SPDX-License-Identifier: MIT
#include "nlos/containers/npy_array.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>

#include <filesystem>

namespace nlos {
namespace {

/// A .npy file of NumPy: one array.
class NpyFile : public StoredArrayFile {
 public:
    explicit NpyFile(const std::string& path) : file_(path) {
        const std::string_view bytes = file_.bytes();
        NpyHeader header = parse_npy_header(bytes.substr(0, kLongestNpyHeader), bytes.size(), path);
        if (header.is_pickle) refuse_pickle(path);
        header.array.bytes = bytes.substr(header.data_begin);
        const ArrayDescription description = describe_npy(header, header.array.bytes);
        if (description.kind == ElementKind::Text) {
            add_text("array", *description.shape, description.text);
        } else {
            add_array("array", header.array);
        }
    }

    std::string container() const override { return "npy"; }

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
};

bool is_npy_file(const std::string& path) {
    return is_npy(core::first_bytes(path, 6));
}

}  // namespace

Container npy_container() {
    return {"NumPy .npy", is_npy_file, open_as<NpyFile>};
}

}  // namespace nlos
