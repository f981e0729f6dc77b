// SPDX-License-Identifier: MIT
#pragma once

// Embree 3.13 or 4, whichever was found: what the two name or order differently.
#if NLOS_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
/// The last two arguments of rtcIntersectN and rtcOccludedN in the order of this version.
#define NLOS_EMBREE_ARGUMENTS(rays, options) rays, options
#else
#include <embree3/rtcore.h>
#define NLOS_EMBREE_ARGUMENTS(rays, options) options, rays
#endif

namespace renderer::embree {

#if NLOS_EMBREE_MAJOR >= 4
using IntersectOptions = RTCIntersectArguments;
using OccludedOptions = RTCOccludedArguments;
inline void initialise(IntersectOptions& options) {
    rtcInitIntersectArguments(&options);
}
inline void initialise(OccludedOptions& options) {
    rtcInitOccludedArguments(&options);
}
#else
using IntersectOptions = RTCIntersectContext;
using OccludedOptions = RTCIntersectContext;
inline void initialise(RTCIntersectContext& options) {
    rtcInitIntersectContext(&options);
}
#endif

/// Options for incoherent rays, the default of every version. Embree's traversal for coherent
/// packets misses occluders on small scenes and is no faster.
template <class Options>
Options incoherent() {
    Options options;
    initialise(options);
    return options;
}

}  // namespace renderer::embree
