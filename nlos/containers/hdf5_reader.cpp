// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_reader.h"

#include "nlos/containers/hdf5_file.h"
#include "renderer/core/error.h"
#include "renderer/core/sandboxed_process.h"

#include <cstring>
#include <filesystem>
#include <type_traits>

namespace nlos {
namespace {

using core::Json;

// A request is a list: the name of an object alone asks what it is (Json, see Hdf5File::describe);
// with a first row, a number of rows and whether they are wanted in double precision, for their
// values.

std::string answer(const Hdf5File& file, const Json& request) {
    const std::string name = request.at(0);
    if (request.size() > 1) {
        return request.at(3) ? file.read<double>(name, request.at(1), request.at(2))
                             : file.read<float>(name, request.at(1), request.at(2));
    }
    std::string text;
    Json::to_cbor(file.describe(name), text);
    return text;
}

}  // namespace

Hdf5Reader::Hdf5Reader(std::string path) : path_(std::move(path)) {
    if (!std::filesystem::exists(path_)) {
        throw core::Error(path_, "cannot be opened", "must be a readable HDF5 file");
    }
    // The file is opened in the child, at the first request.
    const auto file = std::make_shared<std::optional<Hdf5File>>();
    process_ =
        std::make_unique<core::SandboxedProcess>(path_, [file, this](const std::string& request) {
            if (!*file) file->emplace(path_);
            return answer(**file, Json::from_cbor(request));
        });
    describe("/");
}

Hdf5Reader::~Hdf5Reader() = default;

const Json& Hdf5Reader::describe(const std::string& name) const {
    const auto [place, is_new] = described_.try_emplace(name);
    if (is_new) {
        std::string request;
        Json::to_cbor(Json::array({name}), request);
        place->second = Json::from_cbor(process_->ask(request));
    }
    return place->second;
}

const Json& Hdf5Reader::describe_dataset(const std::string& name) const {
    if (!has(name)) {
        throw core::Error(where(name), "is missing or empty", "must be a dataset with values");
    }
    return describe(name);
}

bool Hdf5Reader::has_object(const std::string& name) const {
    return !describe(name).is_null();
}

bool Hdf5Reader::has(const std::string& name) const {
    return describe(name).contains(Hdf5File::kShape);
}

Shape Hdf5Reader::shape(const std::string& name) const {
    return describe_dataset(name).at(Hdf5File::kShape);
}

Hdf5Kind Hdf5Reader::kind(const std::string& name) const {
    return describe_dataset(name).at(Hdf5File::kKind);
}

void Hdf5Reader::require_numeric(const std::string& name) const {
    const Hdf5Kind found = kind(name);
    if (found != Hdf5Kind::Integer && found != Hdf5Kind::Real) {
        throw core::Error(where(name),
                          found == Hdf5Kind::Text ? "holds text" : "holds no plain numbers",
                          "must hold real numbers");
    }
}

template <class T>
std::vector<T> Hdf5Reader::read_values(const std::string& name,
                                       std::size_t first,
                                       std::size_t count) const {
    std::string request;
    Json::to_cbor(Json::array({name, first, count, std::is_same_v<T, double>}), request);
    const std::string bytes = process_->ask(request);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

template std::vector<float> Hdf5Reader::read_values(const std::string&,
                                                    std::size_t,
                                                    std::size_t) const;

template <class T>
std::vector<T> Hdf5Reader::read_all(const std::string& name, const Shape& wanted) const {
    const Shape found = shape(name);
    if (found != wanted) {
        throw core::Error(
            where(name), "has shape " + shape_text(found), "must have shape " + shape_text(wanted));
    }
    require_numeric(name);
    return read_values<T>(name, 0, found.empty() ? 1 : found[0]);
}

std::vector<float> Hdf5Reader::read_floats(const std::string& name, const Shape& wanted) const {
    return read_all<float>(name, wanted);
}

std::vector<double> Hdf5Reader::read_doubles(const std::string& name, const Shape& wanted) const {
    return read_all<double>(name, wanted);
}

double Hdf5Reader::read_real(const std::string& name) const {
    return read_doubles(name, shape(name) == Shape{1} ? Shape{1} : Shape{})[0];
}

std::int64_t Hdf5Reader::read_integer(const std::string& name) const {
    if (kind(name) != Hdf5Kind::Integer) {
        throw core::Error(where(name), "holds no whole number", "must be an integer, enum or bool");
    }
    return static_cast<std::int64_t>(read_real(name));
}

std::string Hdf5Reader::read_text(const std::string& name) const {
    if (kind(name) != Hdf5Kind::Text) {
        throw core::Error(where(name), "holds no text", "must be a text");
    }
    if (!describe(name).contains(Hdf5File::kText)) {
        throw core::Error(where(name), "has shape " + shape_text(shape(name)), "must be one text");
    }
    return describe(name).at(Hdf5File::kText);
}

std::size_t Hdf5Reader::rows_per_read(const std::string& name) const {
    require_numeric(name);
    return describe_dataset(name).at(Hdf5File::kRowsPerRead);
}

std::optional<std::string> Hdf5Reader::text_attribute(const std::string& object,
                                                      const std::string& name) const {
    if (!has_object(object) || !describe(object).at(Hdf5File::kAttributes).contains(name))
        return {};
    const Json& value = describe(object).at(Hdf5File::kAttributes).at(name);
    if (value.is_string()) return value;
    throw core::Error(where(object + " attribute " + name), "holds no text", "must be one text");
}

std::optional<std::vector<double>> Hdf5Reader::real_attribute(const std::string& object,
                                                              const std::string& name) const {
    if (!has_object(object) || !describe(object).at(Hdf5File::kAttributes).contains(name))
        return {};
    const Json& value = describe(object).at(Hdf5File::kAttributes).at(name);
    if (value.is_array()) return value;
    throw core::Error(
        where(object + " attribute " + name), "holds no numbers", "must hold a few numbers");
}

}  // namespace nlos
