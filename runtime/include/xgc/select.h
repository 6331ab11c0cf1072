#pragma once

#include <xgc/asset.h>

#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>

namespace xgc {

/// What selection needs of a camera, in world space.
struct View {
    glm::vec3 eye{0};
    /// Pixels that one world unit covers at distance one (viewport height / (2 tan(fovY / 2))), or, where the view is
    /// orthographic, at any.
    float pixelsPerUnit = 1;
    float nearest = 0; ///< nothing nearer to the eye is drawn: the near plane's distance, or 0
    bool orthographic = false;
    glm::vec3 forward{0, 0, -1}; ///< unit, where it looks; read where it is orthographic
};

/// A perspective view. `fovY` in radians, `viewportHeight` in pixels.
View makeView(const glm::vec3& eye, float fovY, float viewportHeight);

/// An orthographic view, such as a shadow's: `height` of world units over `viewportHeight` pixels.
View makeOrthographicView(const glm::vec3& eye, const glm::vec3& forward, float height, float viewportHeight);

/// Where an asset stands. Affine, any scale but zero; `maxScale` bounds how much it lengthens a vector.
struct Placement {
    glm::mat4x3 toWorld{1};
    float maxScale = 1;
};

/// Computes maxScale as the largest singular value, rounded up. `toWorld` must be affine, finite and not zero.
Placement makePlacement(const glm::mat4& toWorld);

/// The inverse of the placement's linear part, in which normal cones are tested; false where it is flat.
bool inverseOf(const Placement& placement, glm::mat3& toMesh);

/// The thesis's criterion: level = the number of thresholds at or below the distance from the eye to the
/// patch's bounding sphere (0 inside it), in radii of the asset's bounding sphere. Thresholds rise. None: level 0
/// everywhere; those past the asset's levels are not used.
struct DistanceBands {
    std::span<const float> thresholds;
};

/// Level = the coarsest whose E projects to at most `pixels` at the nearest point of the patch's bounding sphere, or at
/// View::nearest where the eye is nearer; for 0 pixels (and 0 for both), the coarsest whose E is zero. An orthographic
/// view has one scale for all distances.
struct ErrorPixels {
    float pixels = 1; ///< not negative
};

/// Chooses a level for each patch. `levels`: patchCount entries, all written. No allocation. Arguments that are
/// negative or NaN where that has no meaning are programming errors (asserted).
///
/// Decisions use +, -, * and comparisons of floats only, in one fixed order, so that a GPU can repeat them bit for
/// bit. They are exact up to rounding, as if the eye were nearer or farther by a millionth of the sum of its
/// distance from the placement's origin and the patch's; squares that leave the range of normal floats decide for
/// the finer level (world distances from 1e-15 to 1e15 are safe).
void select(const AssetView& asset, const Placement& placement, const View& view, const DistanceBands& policy,
            std::span<uint8_t> levels);
void select(const AssetView& asset, const Placement& placement, const View& view, const ErrorPixels& policy,
            std::span<uint8_t> levels);

/// Largest projected error over the patches of a state, in pixels, in double precision; infinite where the eye is
/// inside the bounds of a patch whose error is not zero and View::nearest is zero.
float projectedError(const AssetView& asset, const Placement& placement, const View& view,
                     std::span<const uint8_t> levels);

} // namespace xgc
