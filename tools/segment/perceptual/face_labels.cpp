#include "face_labels.h"
#include "contour_polish.h"
#include "loose_faces.h"
#include "tiny_components.h"

#include <algorithm>

namespace xgc::bake {

namespace {

/// Labels the faces of a component: one that was split takes the region that holds most of its area, of those that
/// `isWanted` (face, cell). Where there are none it stays as it is.
template <class IsWanted>
void labelFaces(const Component& component, const CellRegions& regions, const IsWanted& isWanted, Labels& labels) {
    const std::vector<uint32_t>& cell = component.cells.ofTriangle;
    std::vector<float> area(regions.count, 0.0f);
    for (size_t begin = 0, end = 0; begin < cell.size(); begin = end) {
        const uint32_t face = component.face[begin];
        uint32_t best = kNone;
        for (; end < cell.size() && component.face[end] == face; ++end) {
            const uint32_t r = regions.ofCell[cell[end]];
            area[r] += component.cells.graph.areas[cell[end]];
            if (isWanted(face, cell[end]) && (best == kNone || area[r] > area[best])) best = r;
        }
        for (size_t i = begin; i < end; ++i) area[regions.ofCell[cell[i]]] = 0;
        if (best != kNone) labels.ofFace[face] = labels.count + best;
    }
    labels.count += regions.count;
}

bool isAnyCell(uint32_t, uint32_t) {
    return true;
}

} // namespace

Labels label(const AnalysedMesh& at, const RegionsOfAll& regions) {
    Labels labels = {std::vector<uint32_t>(at.mesh.faces.size(), kNone), 0};
    std::vector<uint32_t> scratch(at.mesh.faces.size(), kNone);
    for (size_t c = 0; c < at.components.size(); ++c) {
        labelFaces(at.components[c], regions[c], isAnyCell, labels);
        if (at.components[c].wasSplit)
            joinLooseFaces(at.linked, at.facesOf(at.analysed[c]), {}, scratch, labels.ofFace);
        if (at.components[c].wasJoined()) polishContours(at.mesh, at.linked, at.components[c], scratch, labels.ofFace);
    }
    placeTinyComponents(at, labels);
    return labels;
}

Labels join(const Labels& labels, const RegionsOfAll& regions, const RegionsOfAll& unions) {
    Labels joined = {{}, 0};
    std::vector<uint32_t> number;
    for (size_t c = 0; c < regions.size(); ++c) {
        const size_t first = number.size();
        number.resize(first + regions[c].count);
        for (size_t i = 0; i < regions[c].ofCell.size(); ++i) {
            number[first + regions[c].ofCell[i]] = joined.count + unions[c].ofCell[i];
        }
        joined.count += unions[c].count;
    }
    for (const uint32_t label : labels.ofFace) joined.ofFace.push_back(label < number.size() ? number[label] : 0);
    joined.count = std::max(joined.count, 1u);
    return joined;
}

Labels split(const AnalysedMesh& at, const Labels& labels, const RegionsOfAll& finer) {
    Labels fine = {std::vector<uint32_t>(at.mesh.faces.size(), kNone), 0};
    std::vector<uint32_t> home(labels.count, kNone); // first fine label
    for (size_t c = 0; c < at.components.size(); ++c) {
        std::vector<uint32_t> regionHome(finer[c].count, kNone); // the part that holds most of a region's faces first
        const Component& component = at.components[c];
        for (size_t t = 0; t < component.face.size(); ++t) {
            uint32_t& part = regionHome[finer[c].ofCell[component.cells.ofTriangle[t]]];
            if (part == kNone) part = labels.ofFace[component.face[t]];
        }
        const auto isAtHome = [&](uint32_t face, uint32_t cell) {
            return regionHome[finer[c].ofCell[cell]] == labels.ofFace[face];
        };
        labelFaces(component, finer[c], isAtHome, fine);
    }
    std::vector<uint32_t> rest;
    for (uint32_t f = 0; f < at.mesh.faceCount(); ++f) {
        if (fine.ofFace[f] == kNone) continue;
        rest.push_back(f);
        if (home[labels.ofFace[f]] == kNone) home[labels.ofFace[f]] = fine.ofFace[f];
    }
    for (size_t i = 0; i < rest.size(); ++i) { // outwards from what has a label
        for (int k = 0; k < 3; ++k) {
            const uint32_t g = at.linked.neighbours[rest[i]][k];
            if (g == kNone || fine.ofFace[g] != kNone || labels.ofFace[g] != labels.ofFace[rest[i]]) continue;
            fine.ofFace[g] = fine.ofFace[rest[i]];
            rest.push_back(g);
        }
    }
    for (uint32_t f = 0; f < at.mesh.faceCount(); ++f) {
        if (fine.ofFace[f] != kNone) continue;
        uint32_t& first = home[labels.ofFace[f]];
        if (first == kNone) first = fine.count++;
        fine.ofFace[f] = first;
    }
    std::vector<uint32_t> scratch(at.mesh.faces.size(), kNone);
    for (uint32_t c = 0; c < at.linked.componentCount(); ++c) {
        joinLooseFaces(at.linked, at.facesOf(c), labels.ofFace, scratch, fine.ofFace);
    }
    return fine;
}

} // namespace xgc::bake
