// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/surface_elements.h"

namespace renderer {

ElementKind kind_of(const Material& material) {
    switch (material.model) {
        case SurfaceModel::Ggx:
            return ElementKind::Glossy;
        case SurfaceModel::Retroreflective:
            return ElementKind::Retroreflective;
        case SurfaceModel::Lambertian:
            break;
    }
    return ElementKind::Lambertian;
}

}  // namespace renderer
