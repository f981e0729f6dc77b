// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_reader.h"

#include "nlos/containers/hdf5_session.h"
#include "nlos/containers/sandboxed_process.h"
#include "renderer/core/error.h"

#include <cstring>
#include <filesystem>
#include <span>

namespace nlos {
namespace {

using core::Json;

// A question is a list: what is asked, the name of an object, and what else it takes.
enum class Question {
    Open,
    Has,
    HasObject,
    Shape,
    Kind,
    Floats,
    Doubles,
    Real,
    Integer,
    Text,
    RowsPerRead,
    RowRange,
    TextAttribute,
    RealAttribute
};

template <class T>
std::string to_bytes(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <class T>
std::vector<T> from_bytes(const std::string& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

template <class T>
std::string one(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

template <class T>
T only(const std::string& bytes) {
    T value{};
    std::memcpy(&value, bytes.data(), std::min(bytes.size(), sizeof(value)));
    return value;
}

/// An optional answer starts with a mark.
template <class T, class Encode>
std::string marked(const std::optional<T>& value, Encode&& encode) {
    return value ? "1" + encode(*value) : "0";
}

/// Asks the library, in the child.
std::string answer(const Hdf5Session& file, const Json& question) {
    const std::string name = question.at(1);
    switch (question.at(0).get<Question>()) {
        case Question::Open:
            return "";
        case Question::Has:
            return one<char>(file.has(name));
        case Question::HasObject:
            return one<char>(file.has_object(name));
        case Question::Shape:
            return to_bytes(file.shape(name));
        case Question::Kind:
            return one(file.kind(name));
        case Question::Floats:
            return to_bytes(file.read_floats(name, question.at(2)));
        case Question::Doubles:
            return to_bytes(file.read_doubles(name, question.at(2)));
        case Question::Real:
            return one(file.read_real(name));
        case Question::Integer:
            return one(file.read_integer(name));
        case Question::Text:
            return file.read_text(name);
        case Question::RowsPerRead:
            return one(file.rows_per_read(name));
        case Question::RowRange:
            return to_bytes(file.read_row_range(name, question.at(2), question.at(3)));
        case Question::TextAttribute:
            return marked(file.text_attribute(name, question.at(2)),
                          [](const std::string& text) { return text; });
        case Question::RealAttribute:
            return marked(file.real_attribute(name, question.at(2)),
                          [](const std::vector<double>& values) { return to_bytes(values); });
    }
    return "";
}

}  // namespace

Hdf5Reader::Hdf5Reader(std::string path) : path_(std::move(path)) {
    if (!std::filesystem::exists(path_)) {
        throw core::Error(path_, "cannot be opened", "must be a readable HDF5 file");
    }
    // The session lives in the child, from the first question on.
    const auto session = std::make_shared<std::optional<Hdf5Session>>();
    process_ = std::make_unique<SandboxedProcess>(path_, [session, this](const std::string& text) {
        if (!*session) session->emplace(path_);
        return answer(**session, Json::from_cbor(text));
    });
    ask({Question::Open, ""});
}

Hdf5Reader::~Hdf5Reader() = default;

std::string Hdf5Reader::ask(const Json& question) const {
    std::string text;
    Json::to_cbor(question, text);
    return process_->ask(text);
}

bool Hdf5Reader::has(const std::string& name) const {
    return only<char>(ask({Question::Has, name})) != 0;
}

bool Hdf5Reader::has_object(const std::string& name) const {
    return only<char>(ask({Question::HasObject, name})) != 0;
}

Shape Hdf5Reader::shape(const std::string& name) const {
    return from_bytes<std::size_t>(ask({Question::Shape, name}));
}

Hdf5Kind Hdf5Reader::kind(const std::string& name) const {
    return only<Hdf5Kind>(ask({Question::Kind, name}));
}

std::vector<float> Hdf5Reader::read_floats(const std::string& name, const Shape& wanted) const {
    return from_bytes<float>(ask({Question::Floats, name, wanted}));
}

std::vector<double> Hdf5Reader::read_doubles(const std::string& name, const Shape& wanted) const {
    return from_bytes<double>(ask({Question::Doubles, name, wanted}));
}

double Hdf5Reader::read_real(const std::string& name) const {
    return only<double>(ask({Question::Real, name}));
}

std::int64_t Hdf5Reader::read_integer(const std::string& name) const {
    return only<std::int64_t>(ask({Question::Integer, name}));
}

std::string Hdf5Reader::read_text(const std::string& name) const {
    return ask({Question::Text, name});
}

std::size_t Hdf5Reader::rows_per_read(const std::string& name) const {
    return only<std::size_t>(ask({Question::RowsPerRead, name}));
}

std::vector<float> Hdf5Reader::read_row_range(const std::string& name,
                                              std::size_t first,
                                              std::size_t count) const {
    return from_bytes<float>(ask({Question::RowRange, name, first, count}));
}

std::optional<std::string> Hdf5Reader::text_attribute(const std::string& object,
                                                      const std::string& name) const {
    const std::string marked = ask({Question::TextAttribute, object, name});
    if (marked.at(0) == '0') return std::nullopt;
    return marked.substr(1);
}

std::optional<std::vector<double>> Hdf5Reader::real_attribute(const std::string& object,
                                                              const std::string& name) const {
    const std::string marked = ask({Question::RealAttribute, object, name});
    if (marked.at(0) == '0') return std::nullopt;
    return from_bytes<double>(marked.substr(1));
}

}  // namespace nlos
