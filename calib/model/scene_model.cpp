// SPDX-License-Identifier: MIT
#include "calib/model/scene_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace calib {
namespace {

using core::Vec3;

// Albedo that stands for a surface without any, whose logarithm would not exist.
constexpr double kMinAlbedo = 1e-6;

std::vector<std::string> named(const std::string& owner, const std::vector<std::string>& parts) {
    std::vector<std::string> names;
    for (const std::string& part : parts) names.push_back(owner + "." + part);
    return names;
}

void check_material(const renderer::Object& object) {
    const renderer::SurfaceTraits& traits = renderer::traits_of(object.material.model);
    if (!traits.can_be_fitted()) {
        throw core::Error("model: object " + object.name,
                          "is a " + std::string(traits.name),
                          "must be " + renderer::model_names([](const auto& t) {
                              return t.can_be_fitted();
                          }) + " to be fitted");
    }
    if (object.material.albedo_texture) {
        throw core::Error(
            "model: object " + object.name, "has a texture", "must have one albedo to be fitted");
    }
}

// Facet normals add up at their corners, by area; a vertex without any gets none.
void find_normals(ModelBody& body, const std::vector<ModelFacet>& facets, std::uint32_t index) {
    std::vector<Vec3> sums(body.vertices.size(), Vec3::Zero());
    body.neighbours.assign(body.vertices.size(), {});
    for (const ModelFacet& facet : facets) {
        if (facet.body != index) continue;
        const auto& [a, b, c] = facet.vertices;
        const Vec3 area = core::triangle_area_vector(
            body.vertices[a].position_m, body.vertices[b].position_m, body.vertices[c].position_m);
        for (const std::uint32_t v : facet.vertices) {
            sums[v] += area;
            for (const std::uint32_t other : facet.vertices) {
                if (other != v) body.neighbours[v].push_back(other);
            }
        }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const double norm = sums[v].norm();
        body.vertices[v].normal = norm > 0.0 ? Vec3(sums[v] / norm) : Vec3::Zero();
        auto& list = body.neighbours[v];
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
}

// What may be freed: nodes with objects and those above them, each once.
std::vector<std::string> node_names(const renderer::SceneGeometry& geometry) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const renderer::Object& object : geometry.objects) {
        if (object.role == renderer::Role::RelayWall) continue;
        for (const renderer::NodeGroup& group : object.groups) add(group.name);
        add(object.name);
    }
    return names;
}

// The node that the object moves with: of its own and those above it the one that is freed by name,
// else its own.
renderer::NodeGroup moving_node(const renderer::Object& object, const FreeSettings& free) {
    std::vector<renderer::NodeGroup> nodes = object.groups;
    nodes.push_back({object.name, object.world_from_node});
    std::optional<renderer::NodeGroup> found;
    for (const renderer::NodeGroup& node : nodes) {
        const bool is_free =
            std::any_of(free.objects.begin(), free.objects.end(), [&](const FreeObject& wanted) {
                return wanted.name == node.name;
            });
        if (!is_free || (found && found->name == node.name)) continue;
        if (found) {
            throw core::Error("model: free",
                              "found '" + found->name + "' and '" + node.name + "', which is in it",
                              "must free one of them");
        }
        found = node;
    }
    return found.value_or(nodes.back());
}

}  // namespace

SceneModel::SceneModel(const renderer::SceneGeometry& geometry,
                       const FitSettings& settings,
                       bool scale_is_free)
    : geometry_(geometry),
      num_points_(settings.free.point_scatterers),
      ambient_is_free_(settings.free.ambient) {
    for (std::size_t i = 0; i < geometry.objects.size(); ++i) {
        if (geometry.objects[i].role == renderer::Role::RelayWall) continue;
        check_material(geometry.objects[i]);
        add_to_body(moving_node(geometry.objects[i], settings.free), geometry.objects[i], i);
    }
    for (std::uint32_t b = 0; b < bodies_.size(); ++b) find_normals(bodies_[b], facets_, b);
    free_bodies(settings.free);
    free_rest(settings.free, scale_is_free);
    if (num_columns_ == 0) {
        throw core::Error("model: free", "found nothing", "must name what is to be fitted");
    }
}

void SceneModel::add_to_body(const renderer::NodeGroup& node,
                             const renderer::Object& object,
                             std::size_t index) {
    auto it = std::find_if(bodies_.begin(), bodies_.end(), [&](const ModelBody& body) {
        return body.name == node.name;
    });
    if (it == bodies_.end()) {
        ModelBody body;
        body.name = node.name;
        body.turn = node.world_from_node.rotation();
        body.origin_m = node.world_from_node.translation();
        body.albedo = std::max(object.material.albedo, kMinAlbedo);
        it = bodies_.insert(bodies_.end(), body);
    }
    it->objects.push_back(index);
    const auto body_index = static_cast<std::uint32_t>(it - bodies_.begin());
    std::map<std::tuple<double, double, double>, std::uint32_t> known;  // vertices may be repeated
    for (std::uint32_t v = 0; v < it->vertices.size(); ++v) {
        const Vec3& p = it->vertices[v].position_m;
        known[{p.x(), p.y(), p.z()}] = v;
    }
    std::vector<std::uint32_t> welded;
    for (const Vec3& vertex : object.mesh.vertices) {
        const Vec3 p = vertex - it->origin_m;
        const auto [found, is_new] = known.try_emplace(
            {p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(it->vertices.size()));
        if (is_new) it->vertices.push_back({p, Vec3::Zero()});
        welded.push_back(found->second);
    }
    for (const auto& [a, b, c] : object.mesh.triangles) {
        ModelFacet facet;
        facet.body = body_index;
        facet.vertices = {welded[a], welded[b], welded[c]};
        facet.albedo_ratio = object.material.albedo / it->albedo;
        facet.is_retroreflective = renderer::traits_of(object.material.model).returns_to_source;
        facets_.push_back(facet);
    }
}

void SceneModel::add_block(ParameterKind kind, std::size_t item, std::vector<std::string> names) {
    ParameterBlock block{kind, item, num_columns_, static_cast<int>(names.size()), {}};
    block.names = std::move(names);
    num_columns_ += block.columns;
    blocks_.push_back(std::move(block));
}

void SceneModel::free_bodies(const FreeSettings& free) {
    for (const FreeObject& wanted : free.objects) {
        const auto it = std::find_if(bodies_.begin(), bodies_.end(), [&](const ModelBody& body) {
            return body.name == wanted.name;
        });
        if (it == bodies_.end()) {
            std::string known;
            for (const std::string& name : node_names(geometry_)) {
                known += (known.empty() ? "" : ", ") + name;
            }
            throw core::Error("model: free",
                              "found '" + wanted.name + "'",
                              "must be time_zero, ambient, response_fwhm, wall, point_scatterers "
                              "or a node of the scene: " +
                                  known);
        }
        it->free = wanted;
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const auto& [name, translation, rotation, size, albedo, vertices] = bodies_[b].free;
        const std::string& owner = bodies_[b].name;
        if (translation) {
            add_block(ParameterKind::Translation, b, named(owner, {"x", "y", "z"}));
        }
        if (rotation) {
            add_block(ParameterKind::Rotation,
                      b,
                      named(owner, {"rotation_x", "rotation_y", "rotation_z"}));
        }
        if (size) add_block(ParameterKind::Size, b, {owner + ".size"});
        if (albedo) add_block(ParameterKind::Albedo, b, {owner + ".albedo"});
        if (vertices) {
            std::vector<std::string> names;
            for (std::size_t v = 0; v < bodies_[b].vertices.size(); ++v) {
                names.push_back(fmt::format("{}.height_{}", owner, v));
            }
            add_block(ParameterKind::Heights, b, names);
        }
    }
}

void SceneModel::free_rest(const FreeSettings& free, bool scale_is_free) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_points_); ++i) {
        const std::string owner = fmt::format("point_{}", i);
        add_block(ParameterKind::PointPosition, i, named(owner, {"x", "y", "z"}));
        add_block(ParameterKind::PointAlbedo, i, {owner + ".albedo"});
    }
    if (free.time_zero) add_block(ParameterKind::TimeZero, 0, {"time_zero"});
    if (free.ambient) add_block(ParameterKind::Ambient, 0, {"ambient"});
    if (free.response_fwhm) add_block(ParameterKind::ResponseWidth, 0, {"response_fwhm"});
    if (free.wall_bow) add_block(ParameterKind::WallBow, 0, {"wall.bow"});
    if (free.wall_scale) add_block(ParameterKind::WallScale, 0, {"wall.scale"});
    if (scale_is_free) add_block(ParameterKind::Scale, 0, {"scale"});
}

const ParameterBlock* SceneModel::find(ParameterKind kind, std::size_t item) const {
    for (const ParameterBlock& block : blocks_) {
        if (block.kind == kind && block.item == item) return &block;
    }
    return nullptr;
}

std::vector<std::string> SceneModel::column_names() const {
    std::vector<std::string> names;
    for (const ParameterBlock& block : blocks_) {
        names.insert(names.end(), block.names.begin(), block.names.end());
    }
    return names;
}

SceneState SceneModel::start() const {
    SceneState state;
    for (const ModelBody& body : bodies_) {
        BodyState& target = state.bodies.emplace_back();
        target.position_m = body.origin_m;
        target.log_albedo = std::log(body.albedo);
        if (body.free.vertices) target.heights_m.assign(body.vertices.size(), 0.0);
    }
    state.points.resize(static_cast<std::size_t>(num_points_));
    state.has_ambient = ambient_is_free_;
    return state;
}

Vec3 SceneModel::vertex_world(const BodyState& state, std::size_t body, std::size_t vertex) const {
    const ModelVertex& v = bodies_[body].vertices[vertex];
    Vec3 local = v.position_m;
    if (!state.heights_m.empty()) local += state.heights_m[vertex] * v.normal;
    return state.position_m + std::exp(state.log_size) * (state.rotation * local);
}

FacetMotion SceneModel::motion(const SceneState& state, std::size_t facet) const {
    const ModelFacet& f = facets_[facet];
    const BodyState& body = state.bodies[f.body];
    FacetMotion motion;
    for (std::size_t i = 0; i < 3; ++i) {
        motion.corners[i] = vertex_world(body, f.body, f.vertices[i]);
    }
    const auto add = [&](int column, const auto& derivative_of_corner) {
        motion.columns.push_back(column);
        auto& target = motion.by_column.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) target[i] = derivative_of_corner(i);
    };
    for (const ParameterBlock& block : blocks_) {
        if (block.item != f.body) continue;
        const int first = block.first_column;
        if (block.kind == ParameterKind::Translation) {
            for (int a = 0; a < 3; ++a) add(first + a, [&](std::size_t) { return Vec3::Unit(a); });
        } else if (block.kind == ParameterKind::Rotation) {
            for (int a = 0; a < 3; ++a) {
                add(first + a, [&](std::size_t i) {
                    return Vec3(Vec3::Unit(a).cross(motion.corners[i] - body.position_m));
                });
            }
        } else if (block.kind == ParameterKind::Size) {
            add(first, [&](std::size_t i) { return Vec3(motion.corners[i] - body.position_m); });
        } else if (block.kind == ParameterKind::Heights) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = f.vertices[k];
                const Vec3 along =
                    std::exp(body.log_size) * (body.rotation * bodies_[f.body].vertices[v].normal);
                add(first + static_cast<int>(v),
                    [&](std::size_t i) { return i == k ? along : Vec3(Vec3::Zero()); });
            }
        }
    }
    return motion;
}

renderer::SceneGeometry SceneModel::posed(const SceneState& state) const {
    renderer::SceneGeometry geometry = geometry_;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const BodyState& body = state.bodies[b];
        std::map<std::tuple<double, double, double>, std::uint32_t> index;
        for (std::uint32_t v = 0; v < bodies_[b].vertices.size(); ++v) {
            const Vec3& p = bodies_[b].vertices[v].position_m;
            index[{p.x(), p.y(), p.z()}] = v;
        }
        const double size = std::exp(body.log_size);
        const auto move = [&](core::Transform& node) {
            const core::Mat3 turn = size * body.rotation.toRotationMatrix();
            node.linear() = turn * node.linear();
            node.translation() =
                body.position_m + turn * (node.translation() - bodies_[b].origin_m);
        };
        for (const std::size_t o : bodies_[b].objects) {
            renderer::Object& object = geometry.objects[o];
            for (Vec3& vertex : object.mesh.vertices) {
                const Vec3 p = vertex - bodies_[b].origin_m;
                vertex = vertex_world(body, b, index.at({p.x(), p.y(), p.z()}));
            }
            object.mesh.normals.clear();
            object.material.albedo = std::min(
                1.0, object.material.albedo * std::exp(body.log_albedo) / bodies_[b].albedo);
            move(object.world_from_node);
            // Nodes within the body move with it, those above it stay.
            bool is_within = false;
            for (renderer::NodeGroup& group : object.groups) {
                is_within = is_within || group.name == bodies_[b].name;
                if (is_within) move(group.world_from_node);
            }
        }
    }
    return geometry;
}

}  // namespace calib
