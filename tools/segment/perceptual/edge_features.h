#pragma once

#include "cells.h"

namespace xgc::bake {

/// How a piece bends across each link, at two scales.
struct EdgeFeatures {
    std::vector<float> concave; ///< k-: turn of the normal per filter width, the stronger scale; 0 where convex
    std::vector<float> convex;  ///< k+
    std::vector<float> angle;   ///< between the cells' own normals, radians; below 0 where concave
    std::vector<glm::vec3> filteredNormals; ///< per cell, at the finer scale
    float noise = 0;                        ///< median of |n_i - n_j| over links, of the cells' own normals
    bool isNoisy() const { return noise > 0.15f; }
};

EdgeFeatures findEdgeFeatures(const CellGraph& graph);

} // namespace xgc::bake
