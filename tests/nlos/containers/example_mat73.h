// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace nlos {

/// Writes MATLAB v7.3 files as MATLAB does: HDF5 behind a block of 512 bytes, classes as
/// attributes, elements of cells and arrays of structs in the group #refs#.
class Mat73Writer {
 public:
    explicit Mat73Writer(const std::string& path) : path_(path) {
        const hid_t plan = H5Pcreate(H5P_FILE_CREATE);
        H5Pset_userblock(plan, 512);
        file_ = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, plan, H5P_DEFAULT);
        H5Pclose(plan);
    }
    ~Mat73Writer() {
        H5Fclose(file_);
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file << "MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Tue Nov 24 2026";
    }
    Mat73Writer(const Mat73Writer&) = delete;
    Mat73Writer& operator=(const Mat73Writer&) = delete;

    /// `extents` as HDF5 counts them: slowest first.
    template <class T>
    void add_numbers(const std::string& name,
                     const std::string& matlab_class,
                     const std::vector<hsize_t>& extents,
                     const std::vector<T>& values) {
        const hid_t set = add(name, type_of(T{}), extents, values.data());
        add_text_attribute(set, "MATLAB_class", matlab_class);
        H5Dclose(set);
    }

    void add_text(const std::string& name, const std::u16string& text) {
        const std::vector<std::uint16_t> units(text.begin(), text.end());
        add_numbers(name, "char", {units.size(), 1}, units);
    }

    /// An array without elements, whose extents, first index first, stand in place of the values.
    void add_empty(const std::string& name,
                   const std::string& matlab_class,
                   const std::vector<std::uint64_t>& extents) {
        const hid_t set = add(name, H5T_NATIVE_UINT64, {extents.size()}, extents.data());
        add_text_attribute(set, "MATLAB_class", matlab_class);
        const hid_t scalar = H5Screate(H5S_SCALAR);
        const hid_t mark =
            H5Acreate2(set, "MATLAB_empty", H5T_NATIVE_UINT8, scalar, H5P_DEFAULT, H5P_DEFAULT);
        const std::uint8_t one = 1;
        H5Awrite(mark, H5T_NATIVE_UINT8, &one);
        H5Aclose(mark);
        H5Sclose(scalar);
        H5Dclose(set);
    }

    void add_group(const std::string& name, const std::string& matlab_class = "") {
        const hid_t group = H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        if (!matlab_class.empty()) add_text_attribute(group, "MATLAB_class", matlab_class);
        H5Gclose(group);
    }

    /// A cell array, or with an empty class a field of an array of structs: references to objects
    /// that are there already.
    void add_references(const std::string& name,
                        const std::string& matlab_class,
                        const std::vector<std::string>& targets) {
        std::vector<hobj_ref_t> references(targets.size());
        for (std::size_t i = 0; i < targets.size(); ++i) {
            if (i > 0 && targets[i] == targets[i - 1]) {
                references[i] = references[i - 1];
                continue;
            }
            H5Rcreate(&references[i], file_, targets[i].c_str(), H5R_OBJECT, -1);
        }
        const hid_t set = add(name, H5T_STD_REF_OBJ, {references.size(), 1}, references.data());
        if (!matlab_class.empty()) add_text_attribute(set, "MATLAB_class", matlab_class);
        H5Dclose(set);
    }

    hid_t file() const { return file_; }

 private:
    static hid_t type_of(double) { return H5T_NATIVE_DOUBLE; }
    static hid_t type_of(float) { return H5T_NATIVE_FLOAT; }
    static hid_t type_of(std::uint8_t) { return H5T_NATIVE_UINT8; }
    static hid_t type_of(std::uint16_t) { return H5T_NATIVE_UINT16; }
    static hid_t type_of(std::uint32_t) { return H5T_NATIVE_UINT32; }
    static hid_t type_of(std::int64_t) { return H5T_NATIVE_INT64; }

    hid_t add(const std::string& name,
              hid_t type,
              const std::vector<hsize_t>& extents,
              const void* values) {
        const hid_t space =
            H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
        const hid_t set =
            H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        H5Sclose(space);
        return set;
    }

    static void add_text_attribute(hid_t object, const char* name, const std::string& text) {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, text.size());
        const hid_t scalar = H5Screate(H5S_SCALAR);
        const hid_t attribute = H5Acreate2(object, name, type, scalar, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(attribute, type, text.data());
        H5Aclose(attribute);
        H5Sclose(scalar);
        H5Tclose(type);
    }

    std::string path_;
    hid_t file_ = -1;
};

/// A capture as some groups store it: an array, a text, a struct, a cell array of two, an array of
/// two structs, and something empty.
inline void write_example_mat73(const std::string& path) {
    Mat73Writer file(path);
    file.add_numbers<float>("meas", "single", {2, 3, 4}, std::vector<float>(24, 1.5F));
    file.add_text("note", u"h\u00e9\U0001f600");
    file.add_empty("none", "double", {0, 3});
    file.add_numbers<std::uint8_t>("flag", "logical", {2, 1}, {1, 0});
    file.add_group("dataset", "struct");
    file.add_numbers<double>("dataset/t0", "double", {1, 1}, {0.25});
    file.add_numbers<std::int64_t>("dataset/count", "int64", {1, 1}, {-7});
    file.add_group("#refs#");
    file.add_numbers<std::uint32_t>("#refs#/a", "uint32", {3, 1}, {1, 2, 3});
    file.add_numbers<double>("#refs#/b", "double", {1, 1}, {4.0});
    file.add_references("accum", "cell", {"#refs#/a", "#refs#/b"});
    file.add_group("list", "struct");
    file.add_references("list/gain", "", {"#refs#/b", "#refs#/a"});
}

}  // namespace nlos
