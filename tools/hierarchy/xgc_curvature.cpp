#include <xgc/bake/xgc_mesh.h>

#include <algorithm>
#include <cmath>

// The curvature of thesis section 4.3.2: a norm of the covariance matrix of the unit normals around a vertex. Faces are
// taken in index order, so that the sums do not depend on the way in which the rings of edges came about.

namespace xgc::bake {

namespace {

double curvature(std::span<const glm::dvec3> normals, CurvatureNorm norm) {
    if (normals.empty()) return 0;
    glm::dvec3 mean(0);
    for (const glm::dvec3& n : normals) mean += n;
    mean /= double(normals.size());
    glm::dmat3 covariance(0);
    for (const glm::dvec3& n : normals) covariance += glm::outerProduct(n - mean, n - mean);
    covariance /= double(normals.size());
    double value = 0;
    for (int u = 0; u < 3; ++u) {
        for (int v = 0; v < 3; ++v) {
            switch (norm) {
            case CurvatureNorm::trace:
                value += u == v ? covariance[u][v] : 0;
                break;
            case CurvatureNorm::sum:
                value += covariance[u][v];
                break;
            case CurvatureNorm::frobenius:
                value += covariance[u][v] * covariance[u][v];
                break;
            }
        }
    }
    return std::sqrt(std::max(value, 0.0));
}

} // namespace

double XgcMesh::curvatureOf(uint32_t vertex) const {
    CurvatureScratch scratch;
    return curvatureOf(vertex, scratch);
}

double XgcMesh::curvatureOf(uint32_t vertex, CurvatureScratch& scratch) const {
    scratch.faces.clear();
    scratch.normals.clear();
    forUses(vertex, [&](uint32_t use) {
        for (const uint32_t f : facesOf(use / 2)) scratch.faces.push_back(f);
    });
    std::sort(scratch.faces.begin(), scratch.faces.end());
    uint32_t last = kNone;
    for (const uint32_t f : scratch.faces) {
        if (f != last && faces_[f].normal != glm::vec3(0)) scratch.normals.emplace_back(faces_[f].normal);
        last = f;
    }
    return curvature(scratch.normals, options_.curvature);
}

void XgcMesh::measureCurvature(uint32_t segment) {
    CurvatureScratch scratch;
    const uint32_t stamp = nextStamp();
    const auto level = uint8_t(segments_[segment].level());
    for (const uint32_t e : segments_[segment].edges) {
        if (edges_[e].ghost) continue;
        for (const uint32_t v : edges_[e].ends) {
            Vertex& vertex = vertices_[v];
            if (seen_[v] == stamp || vertex.boundary || vertex.sharpSince < level) continue;
            seen_[v] = stamp;
            vertex.sharpSince = curvatureOf(v, scratch) >= double(options_.lockCurvature) ? level : kNeverSharp;
        }
    }
}

} // namespace xgc::bake
