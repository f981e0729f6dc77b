// SPDX-License-Identifier: MIT
#include "renderer/core/system/data_folder.h"

#include "renderer/core/error.h"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <filesystem>

namespace core {
namespace {

namespace fs = std::filesystem;

// The shared library that this code is part of, or else the program.
fs::path own_file() {
    std::error_code is_missing;
    Dl_info info{};
    void* library = nullptr;
    if (::dladdr1(reinterpret_cast<void*>(&data_folder), &info, &library, RTLD_DL_LINKMAP) != 0) {
        const fs::path name = static_cast<const link_map*>(library)->l_name;
        if (!name.empty()) return fs::absolute(name, is_missing);
    }
    return fs::read_symlink("/proc/self/exe", is_missing);
}

}  // namespace

std::string data_folder() {
    std::error_code is_missing;
    if (const char* stated = std::getenv("NLOS_DATA"); stated != nullptr && *stated != '\0') {
        if (fs::is_directory(stated, is_missing)) return stated;
        throw Error("NLOS_DATA",
                    "found '" + std::string(stated) + "', which is no folder",
                    "must be the folder with the scenes/ and data/ of the program");
    }
    const fs::path folder = own_file().parent_path();
    for (const fs::path& parent : {folder.parent_path(), folder}) {
        const fs::path installed = parent / "share" / "nlos";
        if (fs::is_directory(installed / "scenes", is_missing)) return installed.string();
    }
    return NLOS_SOURCE_DIR;
}

std::string shipped_file(const std::string& name) {
    std::error_code is_missing;
    if (name.empty() || fs::exists(name, is_missing)) return name;
    const fs::path shipped = fs::path(data_folder()) / name;
    return fs::exists(shipped, is_missing) ? shipped.string() : name;
}

}  // namespace core
