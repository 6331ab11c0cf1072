#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace xgc::bake::models {

/// How a blob looks.
struct Skin {
    glm::vec3 color{1};
    uint32_t material = 0;
};

/// A rounded cone: the hull of two balls. With a frame it can be squashed and turned; an ellipsoid is a ball in a
/// squashed frame.
struct Blob {
    glm::vec3 a{0};
    glm::vec3 b{0};
    float radiusA = 1;
    float radiusB = 1;
    float blend = 0.01f; ///< width over which it melts into what stands before it
    bool carve = false;  ///< taken away instead of added; its colour paints the hollow
    bool framed = false; ///< a, b and radii count in the frame
    glm::mat3 toFrame{1};
    glm::vec3 origin{0};
    float scale = 1; ///< least stretch of the frame: keeps the field's slope at most 1
    Skin skin;
};

/// A ball squashed to three radii, turned by `axes` (columns).
Blob ellipsoid(glm::vec3 center, glm::vec3 radii, const glm::mat3& axes, float blend, Skin skin);
Blob roundCone(glm::vec3 a, float radiusA, glm::vec3 b, float radiusB, float blend, Skin skin);

/// A rising sequence of indices into Body::blobs.
using BlobList = std::vector<uint16_t>;

/// Blobs melted together in their order: a field that is negative inside and never steeper than 1.
class Body {
public:
    std::vector<Blob> blobs;

    void add(const Blob& blob);
    /// All blobs.
    BlobList all() const;

    float field(glm::vec3 p, const BlobList& list) const;
    /// Unit outward normal by differences over `step`.
    glm::vec3 normal(glm::vec3 p, float step, const BlobList& list) const;
    /// Colour, and the material of the blob that rules the point.
    Skin skin(glm::vec3 p, const BlobList& list) const;

    /// Bounds of the field over a ball, and in `kept` those of `list` that matter there: for any point in the ball the
    /// field over `kept` is the same, bit for bit.
    glm::vec2 bounds(glm::vec3 center, float radius, const BlobList& list, BlobList& kept) const;

private:
    struct Cone {
        glm::vec3 axis;
        float length2, difference, slant2, inverse;
        bool ball;
    };
    float distance(uint32_t blob, glm::vec3 p) const;
    std::vector<Cone> cones_;
};

} // namespace xgc::bake::models
