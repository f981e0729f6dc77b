// SPDX-License-Identifier: MIT
#include "nlos/containers/mat5_writer.h"

#include "renderer/core/error.h"
#include "renderer/core/output_file.h"

#include <matio.h>

#include <memory>
#include <type_traits>

namespace nlos {
namespace {

using MatFile = std::unique_ptr<mat_t, int (*)(mat_t*)>;
using MatPointer = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

template <class T>
MatPointer make_array(const MatVariable& variable, const std::vector<T>& values) {
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

}  // namespace

void write_mat_file(const std::string& path, const std::vector<MatVariable>& variables) {
    core::OutputFile output(path);
    const auto check = [&](bool ok) {
        if (!ok) throw core::Failure(path, "cannot be written (disk full?)");
    };
    MatFile file(Mat_CreateVer(output.temporary().c_str(), nullptr, MAT_FT_MAT5), Mat_Close);
    check(file != nullptr);
    for (const MatVariable& variable : variables) {
        const MatPointer array = std::visit(
            [&](const auto& values) { return make_array(variable, values); }, variable.values);
        check(array != nullptr);
        check(Mat_VarWrite(file.get(), array.get(), MAT_COMPRESSION_ZLIB) == 0);
    }
    check(Mat_Close(file.release()) == 0);
    output.commit();
}

}  // namespace nlos
