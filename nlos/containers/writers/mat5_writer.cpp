// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/mat5_writer.h"

#include "renderer/core/error.h"
#include "renderer/core/system/output_file.h"

#include <fmt/core.h>
#include <matio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <type_traits>

namespace nlos {
namespace {

using MatFile = std::unique_ptr<mat_t, int (*)(mat_t*)>;
using MatPointer = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

template <class T>
MatPointer create_array(const MatVariable& variable, const std::vector<T>& values) {
    constexpr matio_classes kClass = std::is_same_v<T, double>  ? MAT_C_DOUBLE
                                     : std::is_same_v<T, float> ? MAT_C_SINGLE
                                                                : MAT_C_UINT16;
    constexpr matio_types kType = std::is_same_v<T, double>  ? MAT_T_DOUBLE
                                  : std::is_same_v<T, float> ? MAT_T_SINGLE
                                                             : MAT_T_UINT16;
    Shape shape = variable.shape;
    return {Mat_VarCreate(variable.name.c_str(),
                          kClass,
                          kType,
                          static_cast<int>(shape.size()),
                          shape.data(),
                          const_cast<T*>(values.data()),  // only read
                          MAT_F_DONT_COPY_DATA),
            Mat_VarFree};
}

MatPointer create_variable(const MatVariable& variable);

MatPointer create_array(const MatVariable& variable, const std::vector<MatVariable>& fields) {
    std::vector<const char*> names;
    for (const MatVariable& field : fields) names.push_back(field.name.c_str());
    Shape shape{1, 1};
    MatPointer parent(Mat_VarCreateStruct(variable.name.c_str(),
                                          static_cast<int>(shape.size()),
                                          shape.data(),
                                          names.data(),
                                          static_cast<unsigned>(names.size())),
                      Mat_VarFree);
    if (parent == nullptr) return parent;
    for (const MatVariable& field : fields) {
        MatPointer value = create_variable(field);
        if (value == nullptr) return value;
        Mat_VarSetStructFieldByName(parent.get(), field.name.c_str(), 0, value.release());
    }
    return parent;
}

/// Stands for the values of `variable`, which it does not copy.
MatPointer create_variable(const MatVariable& variable) {
    return std::visit([&](const auto& values) { return create_array(variable, values); },
                      variable.values);
}

std::size_t size_bytes(const MatVariable& variable) {
    return std::visit(
        [](const auto& values) {
            using T = typename std::decay_t<decltype(values)>::value_type;
            if constexpr (std::is_same_v<T, MatVariable>) {
                std::size_t sum = 0;
                for (const MatVariable& field : values) sum += size_bytes(field);
                return sum;
            } else {
                return sizeof(T) * values.size();
            }
        },
        variable.values);
}

/// A file without a name that lies in memory.
class MemoryFile {
 public:
    MemoryFile() : descriptor_(::memfd_create("mat", MFD_CLOEXEC)) {}
    ~MemoryFile() { ::close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }
    std::string bytes() const {
        std::ifstream stream(path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    }
    /// Whether it is as large as the process may make files, so that its end may be missing.
    bool is_full() const {
        rlimit limit{};
        struct stat status {};
        return ::getrlimit(RLIMIT_FSIZE, &limit) != 0 || ::fstat(descriptor_, &status) != 0 ||
               static_cast<rlim_t>(status.st_size) >= limit.rlim_cur;
    }

 private:
    int descriptor_;
};

}  // namespace

void write_mat_file(const std::string& path, const std::vector<MatVariable>& variables) {
    constexpr std::size_t kMaxBytes = std::size_t{1} << 31;
    for (const MatVariable& variable : variables) {
        if (size_bytes(variable) < kMaxBytes) continue;
        throw core::Error(path + ": " + variable.name,
                          fmt::format("takes {} bytes", size_bytes(variable)),
                          fmt::format("must take less than {} in a MATLAB v5 file", kMaxBytes));
    }
    const auto check = [&](bool ok) {
        if (!ok) throw core::Failure(path, "cannot be written (out of memory?)");
    };
    // matio does not notice when a write fails, so that it writes to memory.
    const MemoryFile memory;
    MatFile file(Mat_CreateVer(memory.path().c_str(), nullptr, MAT_FT_MAT5), Mat_Close);
    check(file != nullptr);
    for (const MatVariable& variable : variables) {
        const MatPointer array = create_variable(variable);
        check(array != nullptr);
        check(Mat_VarWrite(file.get(), array.get(), MAT_COMPRESSION_ZLIB) == 0);
    }
    check(Mat_Close(file.release()) == 0);
    if (memory.is_full()) throw core::Failure(path, "cannot be written (File too large)");
    core::write_text_file(path, memory.bytes());
}

}  // namespace nlos
