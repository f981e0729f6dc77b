// SPDX-License-Identifier: MIT
#include "calib/model/scene_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace calib {
namespace {

using core::Vec3;

// Albedo that stands for a surface without any, whose logarithm would not exist.
constexpr double kMinAlbedo = 1e-6;

void check_material(const renderer::Object& object) {
    const renderer::SurfaceTraits& traits = renderer::traits_of(object.material.model);
    if (!traits.can_be_fitted()) {
        throw core::Error("model: object " + object.name,
                          "is a " + std::string(traits.name),
                          "must be " + renderer::model_names([](const auto& t) {
                              return t.can_be_fitted();
                          }) + " to be fitted");
    }
    if (!object.has_one_albedo()) {
        throw core::Error("model: object " + object.name,
                          "has a texture or colours of vertices",
                          "must have one albedo to be fitted");
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

bool may_move(const FreeObject& object) {
    return std::any_of(parameters().begin(), parameters().end(), [&](const Parameter* row) {
        return object.frees(*row) && row->effect != Effect::Multiplies;
    });
}

}  // namespace

renderer::FacePrecedence face_precedence(std::span<const renderer::Object> objects,
                                         const FreeSettings& free) {
    renderer::FacePrecedence precedence(objects);
    std::vector<bool> is_free;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        precedence.group[i] = 0;
        is_free.push_back(false);
        if (objects[i].role == renderer::Role::RelayWall) continue;
        const std::string name = moving_node(objects[i], free).name;
        for (std::size_t f = 0; f < free.objects.size(); ++f) {
            if (free.objects[f].name != name) continue;
            is_free[i] = true;
            if (may_move(free.objects[f])) precedence.group[i] = f + 1;
        }
    }
    std::stable_partition(precedence.order.begin(), precedence.order.end(), [&](std::size_t i) {
        return is_free[i] || objects[i].role == renderer::Role::RelayWall;
    });
    return precedence;
}

SceneModel::SceneModel(const renderer::SceneGeometry& geometry, const FitSettings& settings)
    : geometry_(geometry), num_points_(static_cast<std::size_t>(settings.free.point_scatterers)) {
    for (std::size_t i = 0; i < geometry.objects.size(); ++i) {
        if (geometry.objects[i].role == renderer::Role::RelayWall) continue;
        check_material(geometry.objects[i]);
        add_to_body(moving_node(geometry.objects[i], settings.free), geometry.objects[i], i);
    }
    for (std::uint32_t b = 0; b < bodies_.size(); ++b) find_normals(bodies_[b], facets_, b);
    for (const FreeObject& wanted : settings.free.objects) free_by_name(wanted);
    for (std::size_t b = 0; b < bodies_.size(); ++b) add_blocks(Owner::Body, b, settings.free);
    for (std::size_t i = 0; i < num_points_; ++i) add_blocks(Owner::Point, i, settings.free);
    add_blocks(Owner::Scene, 0, settings.free);
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

void SceneModel::free_by_name(const FreeObject& wanted) {
    const auto it = std::find_if(bodies_.begin(), bodies_.end(), [&](const ModelBody& body) {
        return body.name == wanted.name;
    });
    if (it == bodies_.end()) {
        throw core::Error("model: free",
                          "found '" + wanted.name + "'",
                          fmt::format("must be {}, point_scatterers or a node of the scene: {}",
                                      fmt::join(free_names(Owner::Scene), ", "),
                                      fmt::join(node_names(geometry_), ", ")));
    }
    it->free = wanted;
}

void SceneModel::add_blocks(Owner owner, std::size_t item, const FreeSettings& free) {
    const ModelBody* body = owner == Owner::Body ? &bodies_[item] : nullptr;
    const std::string prefix = body != nullptr         ? body->name + "."
                               : owner == Owner::Point ? fmt::format("point_{}.", item)
                                                       : "";
    for (const Parameter* row : parameters()) {
        if (row->owner != owner) continue;
        if (body != nullptr && !body->free.frees(*row)) continue;
        if (owner == Owner::Scene && !free.parameters.contains(row->name)) continue;
        ParameterBlock block{row, item, num_columns_, 0, row->columns};
        if (row->body_columns != nullptr) block.names = row->body_columns(*body);
        if (block.names.empty()) block.names = {row->name};
        for (std::string& name : block.names) name = prefix + name;
        block.columns = static_cast<int>(block.names.size());
        num_columns_ += block.columns;
        blocks_.push_back(std::move(block));
    }
}

const ParameterBlock* SceneModel::find(const Parameter& row, std::size_t item) const {
    for (const ParameterBlock& block : blocks_) {
        if (block.row == &row && block.item == item) return &block;
    }
    return nullptr;
}

std::vector<const ParameterBlock*> SceneModel::find(Owner owner,
                                                    std::size_t item,
                                                    Effect effect) const {
    std::vector<const ParameterBlock*> found;
    for (const ParameterBlock& block : blocks_) {
        if (block.row->owner == owner && block.item == item && block.row->effect == effect) {
            found.push_back(&block);
        }
    }
    return found;
}

std::optional<LinearPrior> SceneModel::prior_of(const ParameterBlock& block,
                                                const PriorSettings& settings) const {
    if (block.row->body_prior != nullptr) {
        return block.row->body_prior(bodies_[block.item], settings);
    }
    const auto sigma = settings.sigma.find(block.row->name);
    if (block.row->prior == nullptr || sigma == settings.sigma.end()) return std::nullopt;
    return LinearPrior{Eigen::MatrixXd::Identity(block.columns, block.columns), sigma->second};
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
    state.bodies.resize(bodies_.size());
    state.points.resize(num_points_);
    for (const Parameter* row : parameters()) {
        const std::size_t items = row->owner == Owner::Body    ? bodies_.size()
                                  : row->owner == Owner::Point ? num_points_
                                                               : 1;
        for (std::size_t item = 0; item < items; ++item) {
            const bool is_free = find(*row, item) != nullptr;
            if (row->start_body != nullptr) {
                row->start_body(bodies_[item], is_free, state.bodies[item]);
            } else if (row->storage == nullptr) {
                row->numbers(state, item)[0] = is_free ? row->start : row->fixed;
            }
        }
    }
    return state;
}

Vec3 ModelBody::vertex_world(const BodyState& state, std::size_t vertex) const {
    const ModelVertex& v = vertices[vertex];
    Vec3 local = v.position_m;
    if (!state.heights_m.empty()) local += state.heights_m[vertex] * v.normal;
    return state.position_m + std::exp(state.log_size) * (state.rotation * local);
}

FacetMotion SceneModel::motion(const SceneState& state, std::size_t facet) const {
    const ModelFacet& f = facets_[facet];
    const BodyState& body = state.bodies[f.body];
    FacetMotion motion;
    for (std::size_t i = 0; i < 3; ++i) {
        motion.corners[i] = bodies_[f.body].vertex_world(body, f.vertices[i]);
    }
    for (const ParameterBlock& block : blocks_) {
        const auto& move = block.row->move_facet;
        if (move == nullptr || block.item != f.body) continue;
        move({{bodies_[f.body], body}, f, block.first_column}, motion);
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
        const double factor = std::exp(sum_of(state, Owner::Body, b, Effect::Multiplies));
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
                vertex = bodies_[b].vertex_world(body, index.at({p.x(), p.y(), p.z()}));
            }
            object.mesh.normals.clear();
            object.material.albedo =
                std::min(1.0, object.material.albedo * factor / bodies_[b].albedo);
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
