// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/zip_target.h"

#include <zip.h>

#include <cerrno>
#include <cstdio>
#include <memory>

namespace nlos {
namespace {

class ZipTarget {
 public:
    explicit ZipTarget(const std::string& path)
        : file_(std::fopen(path.c_str(), "wb"), std::fclose) {
        zip_error_init(&error_);
    }

    bool is_open() const { return file_ != nullptr; }

    /// What libzip asks of a source, `state` being the target.
    static zip_int64_t answer(void* state,
                              void* data,
                              zip_uint64_t size,
                              zip_source_cmd_t command) {
        auto* target = static_cast<ZipTarget*>(state);
        std::FILE* const file = target->file_.get();
        switch (command) {
            case ZIP_SOURCE_STAT:
                zip_stat_init(static_cast<zip_stat_t*>(data));
                static_cast<zip_stat_t*>(data)->size = 0;
                static_cast<zip_stat_t*>(data)->valid = ZIP_STAT_SIZE;
                return sizeof(zip_stat_t);
            case ZIP_SOURCE_OPEN:
            case ZIP_SOURCE_READ:
            case ZIP_SOURCE_SEEK:
            case ZIP_SOURCE_TELL:
            case ZIP_SOURCE_CLOSE:
            case ZIP_SOURCE_REMOVE:
            case ZIP_SOURCE_BEGIN_WRITE:
            case ZIP_SOURCE_ROLLBACK_WRITE:
                return 0;  // there is nothing before the archive is written
            case ZIP_SOURCE_WRITE:
                return target->checked(std::fwrite(data, 1, size, file) == size,
                                       static_cast<zip_int64_t>(size));
            case ZIP_SOURCE_SEEK_WRITE:
                return target->seek(data, size);
            case ZIP_SOURCE_TELL_WRITE:
                return std::ftell(file);
            case ZIP_SOURCE_COMMIT_WRITE:
                return target->checked(std::fflush(file) == 0, 0);
            case ZIP_SOURCE_ERROR:
                return zip_error_to_data(&target->error_, data, size);
            case ZIP_SOURCE_FREE:
                delete target;
                return 0;
            case ZIP_SOURCE_SUPPORTS:
                return ZIP_SOURCE_SUPPORTS_WRITABLE;
            default:
                zip_error_set(&target->error_, ZIP_ER_OPNOTSUPP, 0);
                return -1;
        }
    }

 private:
    zip_int64_t checked(bool is_done, zip_int64_t result) {
        if (is_done) return result;
        zip_error_set(&error_, ZIP_ER_WRITE, errno);
        return -1;
    }

    zip_int64_t seek(void* data, zip_uint64_t size) {
        const auto* place = ZIP_SOURCE_GET_ARGS(zip_source_args_seek_t, data, size, &error_);
        if (place == nullptr) return -1;
        return checked(std::fseek(file_.get(), place->offset, place->whence) == 0, 0);
    }

    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
    zip_error_t error_{};
};

}  // namespace

zip_source* zip_target(const std::string& path) {
    auto target = std::make_unique<ZipTarget>(path);
    if (!target->is_open()) return nullptr;
    zip_source_t* source = zip_source_function_create(ZipTarget::answer, target.get(), nullptr);
    if (source != nullptr) static_cast<void>(target.release());  // libzip frees it
    return source;
}

}  // namespace nlos
