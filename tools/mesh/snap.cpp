#include <xgc/bake/snap.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace xgc::bake {

float snapStep(const Model& model, uint32_t bits) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::vec3& p : model.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    const glm::dvec3 size = high - low;
    const double extent = std::max(size.x, std::max(size.y, size.z));
    if (!(extent > 0) || !std::isfinite(extent)) return 0;
    const double cells = std::ldexp(1.0, int(bits)) - 1;
    int exponent = 0;
    (void)std::frexp(extent / cells, &exponent);
    if (std::ldexp(cells, exponent - 1) >= extent) --exponent;
    return float(std::ldexp(1.0, std::max(exponent, -126)));
}

float snapPositions(Model& model, float step) {
    double largest = 0;
    for (glm::vec3& p : model.positions) {
        const glm::dvec3 before(p);
        for (int k = 0; k < 3; ++k) p[k] = float(std::floor(before[k] / step + 0.5) * step) + 0.0f; // no -0
        largest = std::max(largest, glm::dot(glm::dvec3(p) - before, glm::dvec3(p) - before));
    }
    return std::nextafter(float(std::sqrt(largest)), std::numeric_limits<float>::infinity());
}

} // namespace xgc::bake
