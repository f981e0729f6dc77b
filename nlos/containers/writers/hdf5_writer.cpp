// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/hdf5_writer.h"

#include "nlos/containers/text_checksum.h"
#include "nlos/containers/writers/hdf5_storage.h"
#include "renderer/core/error.h"

#include <hdf5.h>

#include <array>
#include <cassert>
#include <cstdint>
#include <fstream>

namespace nlos {
namespace {

Hdf5Handle create_space(const Shape& shape) {
    const std::vector<hsize_t> extents(shape.begin(), shape.end());
    return extents.empty()
               ? Hdf5Handle(H5Screate(H5S_SCALAR), H5Sclose)
               : Hdf5Handle(
                     H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                     H5Sclose);
}

Hdf5Handle utf8_type() {
    Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), H5T_VARIABLE);
    H5Tset_cset(type.id(), H5T_CSET_UTF8);
    return type;
}

/// IEEE 754 half precision, which the library has no name for, as h5py stores it.
Hdf5Handle half_type() {
    constexpr std::size_t kSign = 15;
    constexpr std::size_t kExponentBits = 5;
    constexpr std::size_t kMantissaBits = 10;
    Hdf5Handle type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
    H5Tset_fields(type.id(), kSign, kMantissaBits, kExponentBits, 0, kMantissaBits);
    H5Tset_size(type.id(), 2);
    H5Tset_ebias(type.id(), 15);
    return type;
}

Hdf5Handle stored_type(StoredNumber number) {
    if (number == StoredNumber::Float16) return half_type();
    const std::array types{H5T_NATIVE_INT8,
                           H5T_NATIVE_UINT8,
                           H5T_NATIVE_INT16,
                           H5T_NATIVE_UINT16,
                           H5T_NATIVE_INT32,
                           H5T_NATIVE_UINT32,
                           H5T_NATIVE_INT64,
                           H5T_NATIVE_UINT64,
                           hid_t{H5I_INVALID_HID},
                           H5T_NATIVE_FLOAT,
                           H5T_NATIVE_DOUBLE};
    return {H5Tcopy(types[static_cast<std::size_t>(number)]), H5Tclose};
}

}  // namespace

Hdf5Writer::Hdf5Writer(std::string target, std::string user_block)
    : target_(std::move(target)), user_block_(std::move(user_block)), output_(target_) {
    prepare_hdf5();
    const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    check(H5Pset_userblock(creation.id(), user_block_.size()) >= 0);
    H5Pset_obj_track_times(creation.id(), false);  // the same values give the same bytes
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    // The format of HDF5 1.8 guards its headers by checksums, so that damage is noticed when read.
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_LATEST);
    file_ = Hdf5Handle(
        H5Fcreate(output_.temporary().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()),
        H5Fclose);
    check(file_.is_valid());
}

void Hdf5Writer::check(bool ok) const {
    if (!ok) throw core::Failure(target_, "cannot be written (disk full?)");
}

void Hdf5Writer::create_group(const std::string& name) {
    const Hdf5Handle group(
        H5Gcreate2(file_.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    check(group.is_valid());
}

Hdf5Handle Hdf5Writer::create_dataset(const std::string& name,
                                      std::int64_t type,
                                      const Hdf5Handle& space,
                                      const Hdf5Handle& plan) {
    Hdf5Handle dataset(
        H5Dcreate2(file_.id(), name.c_str(), type, space.id(), H5P_DEFAULT, plan.id(), H5P_DEFAULT),
        H5Dclose);
    check(dataset.is_valid());
    return dataset;
}

void Hdf5Writer::write_dataset(const std::string& name,
                               std::int64_t type,
                               const Shape& shape,
                               const void* values) {
    prepare_hdf5();
    Hdf5Handle dataset =
        create_dataset(name, type, create_space(shape), guarded_creation(type, shape));
    check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    check(dataset.close());
}

void Hdf5Writer::write(const std::string& name, const Shape& shape, std::span<const float> values) {
    assert(values.size() == total_bytes(shape, 1));
    write_dataset(name, H5T_NATIVE_FLOAT, shape, values.data());
}

void Hdf5Writer::write(const std::string& name,
                       const Shape& shape,
                       std::span<const double> values) {
    assert(values.size() == total_bytes(shape, 1));
    write_dataset(name, H5T_NATIVE_DOUBLE, shape, values.data());
}

void Hdf5Writer::write(const std::string& name, const Shape& shape, std::span<const int> values) {
    assert(values.size() == total_bytes(shape, 1));
    write_dataset(name, H5T_NATIVE_INT, shape, values.data());
}

void Hdf5Writer::write(const std::string& name,
                       const Shape& shape,
                       std::span<const std::uint8_t> values) {
    assert(values.size() == total_bytes(shape, 1));
    write_dataset(name, H5T_NATIVE_UINT8, shape, values.data());
}

void Hdf5Writer::write_real(const std::string& name, double value) {
    write(name, {}, {&value, 1});
}

void Hdf5Writer::write_bool(const std::string& name, bool value) {
    const Hdf5Handle type(H5Tenum_create(H5T_NATIVE_INT8), H5Tclose);
    const std::int8_t no = 0;
    const std::int8_t yes = 1;
    H5Tenum_insert(type.id(), "FALSE", &no);
    H5Tenum_insert(type.id(), "TRUE", &yes);
    write_dataset(name, type.id(), {}, value ? &yes : &no);
}

void Hdf5Writer::write_enum(const std::string& name,
                            const std::vector<std::pair<const char*, int>>& members,
                            int value) {
    const Hdf5Handle type(H5Tenum_create(H5T_NATIVE_INT32), H5Tclose);
    for (const auto& [member, number] : members) H5Tenum_insert(type.id(), member, &number);
    write_dataset(name, type.id(), {1}, &value);
}

void Hdf5Writer::write_text(const std::string& name, const std::string& text) {
    const char* characters = text.c_str();
    const Hdf5Handle type = utf8_type();
    write_dataset(name, type.id(), {}, &characters);
    write_attribute(name, kTextChecksum, {}, {{text_checksum(text.c_str())}});
}

void Hdf5Writer::write_null(const std::string& name) {
    create_dataset(name, H5T_NATIVE_FLOAT, {H5Screate(H5S_NULL), H5Sclose}, plain_creation());
}

Hdf5Handle Hdf5Writer::create_float_dataset(const std::string& name, const Shape& shape) {
    return create_dataset(
        name, H5T_NATIVE_FLOAT, create_space(shape), guarded_creation(H5T_NATIVE_FLOAT, shape));
}

void Hdf5Writer::write_row_range(const Hdf5Handle& dataset,
                                 std::size_t first,
                                 std::size_t count,
                                 const std::vector<float>& values) {
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Hdf5Handle memory = select_rows(space, first, count);
    check(
        H5Dwrite(
            dataset.id(), H5T_NATIVE_FLOAT, memory.id(), space.id(), H5P_DEFAULT, values.data()) >=
        0);
}

void Hdf5Writer::create_rows(const std::string& name,
                             StoredNumber number,
                             std::size_t rows,
                             const Shape& row_shape,
                             int level) {
    std::vector<hsize_t> chunk(row_shape.begin(), row_shape.end());
    chunk.insert(chunk.begin(), 1);
    Shape shape = row_shape;
    shape.insert(shape.begin(), rows);
    const Hdf5Handle plan = plain_creation();
    H5Pset_chunk(plan.id(), static_cast<int>(chunk.size()), chunk.data());
    if (level > 0) {
        H5Pset_shuffle(plan.id());
        H5Pset_deflate(plan.id(), static_cast<unsigned>(level));
    }
    H5Pset_fletcher32(plan.id());
    row_datasets_[name] = create_dataset(name, stored_type(number).id(), create_space(shape), plan);
}

void Hdf5Writer::write_packed_row(const std::string& name,
                                  std::size_t row,
                                  const std::string& chunk) {
    prepare_hdf5();  // on the thread that writes, which may be another every time
    const Hdf5Handle& dataset = row_datasets_.at(name);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    std::vector<hsize_t> offset(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.id())));
    offset[0] = row;
    check(H5Dwrite_chunk(dataset.id(), H5P_DEFAULT, 0, offset.data(), chunk.size(), chunk.data()) >=
          0);
}

void Hdf5Writer::write_numbers(const std::string& name,
                               StoredNumber number,
                               const Shape& shape,
                               const std::string& bytes) {
    assert(bytes.size() == total_bytes(shape, 1) * bytes_of(number));
    write_dataset(name, stored_type(number).id(), shape, bytes.data());
}

void Hdf5Writer::write_texts(const std::string& name, const std::vector<std::string>& texts) {
    std::vector<const char*> characters;
    for (const std::string& text : texts) characters.push_back(text.c_str());
    write_dataset(name, utf8_type().id(), {texts.size()}, characters.data());
}

void Hdf5Writer::write_attribute(const std::string& object,
                                 const std::string& name,
                                 const std::string& text) {
    const char* characters = text.c_str();
    const Hdf5Handle type = utf8_type();
    write_attribute_values(object, name, type.id(), {}, &characters);
}

void Hdf5Writer::write_guarded_attribute(const std::string& object,
                                         const std::string& name,
                                         const std::string& text) {
    write_attribute(object, name, text);
    write_attribute(object, checksum_attribute(name), {}, {{text_checksum(text.c_str())}});
}

void Hdf5Writer::write_attribute(const std::string& object,
                                 const std::string& name,
                                 const Shape& shape,
                                 std::span<const double> values) {
    assert(values.size() == total_bytes(shape, 1));
    write_attribute_values(object, name, H5T_NATIVE_DOUBLE, shape, values.data());
}

void Hdf5Writer::write_ascii_attribute(const std::string& object,
                                       const std::string& name,
                                       const std::string& text) {
    const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), text.size());
    write_attribute_values(object, name, type.id(), {}, text.data());
}

void Hdf5Writer::write_attribute_values(const std::string& object,
                                        const std::string& name,
                                        std::int64_t type,
                                        const Shape& shape,
                                        const void* values) {
    const Hdf5Handle space = create_space(shape);
    const Hdf5Handle attribute(H5Acreate_by_name(file_.id(),
                                                 object.c_str(),
                                                 name.c_str(),
                                                 type,
                                                 space.id(),
                                                 H5P_DEFAULT,
                                                 H5P_DEFAULT,
                                                 H5P_DEFAULT),
                               H5Aclose);
    check(attribute.is_valid());
    check(H5Awrite(attribute.id(), type, values) >= 0);
}

void Hdf5Writer::write_user_block() {
    std::fstream stream(output_.temporary(), std::ios::binary | std::ios::in | std::ios::out);
    stream.write(user_block_.data(), static_cast<std::streamsize>(user_block_.size()));
    stream.close();
    check(stream.good());
}

void Hdf5Writer::finish() {
    prepare_hdf5();
    for (auto& [name, dataset] : row_datasets_) check(dataset.close());
    check(H5Fflush(file_.id(), H5F_SCOPE_LOCAL) >= 0);
    check(file_.close());
    if (!user_block_.empty()) write_user_block();
    output_.commit();
}

}  // namespace nlos
