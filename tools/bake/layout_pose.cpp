#include "bake/layout.h"
#include "bake/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// What lets an asset be posed: which joints move a patch and where, and by how much the drawn surface of a level
// differs from level 0 in what joints and targets do to it (skin.h has what that bounds). Each vertex of level 0 is
// compared with the drawn point that is nearest to it, on the patch and its neighbours where one is within E, so that
// two limbs that touch are not taken for one another.

namespace xgc::bake::layout {
namespace {

float roundedUp(double value) {
    return value > 0 ? std::nextafter(float(value * (1 + 1e-6)), std::numeric_limits<float>::infinity()) : 0.0f;
}

/// Weights of the nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
glm::dvec3 nearestWeights(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp),
                 d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const double u = d4 - d3, v = d5 - d6;
    if (va <= 0 && u >= 0 && v >= 0 && u + v > 0) return {0, 1 - u / (u + v), u / (u + v)};
    const double sum = va + vb + vc;
    if (!(sum > 0)) return {1, 0, 0};
    return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

/// A sum of what joints do at points: weight and moment, a joint each.
class JointSum {
public:
    explicit JointSum(const Attributes& attributes) : attributes_(attributes) {}

    void clear() { terms_.clear(); }
    /// `arm`: from the centre to the wedge.
    void add(double factor, uint32_t wedge, const glm::dvec3& arm) {
        double total = 0;
        eachWeight(wedge, [&](uint32_t, double w) { total += w; });
        if (total > 0) eachWeight(wedge, [&](uint32_t joint, double w) { addTerm(joint, factor * w / total, arm); });
    }
    template <typename Take>
    void eachJoint(const Take& take) const {
        for (const Term& t : terms_) take(t.joint);
    }
    format::SkinError norm() const {
        double weight = 0, moment = 0;
        for (const Term& t : terms_) {
            weight += std::fabs(t.weight);
            moment += std::sqrt(glm::dot(t.moment, t.moment));
        }
        return {roundedUp(weight), roundedUp(moment)};
    }

private:
    struct Term {
        uint32_t joint;
        double weight;
        glm::dvec3 moment;
    };
    template <typename Take>
    void eachWeight(uint32_t wedge, const Take& take) const {
        for (size_t set = 0; set < Attributes::kJointSets && !attributes_.joints[set].empty(); ++set) {
            for (int k = 0; k < 4; ++k) {
                const double w = attributes_.weights[set][wedge][k];
                if (w > 0) take(attributes_.joints[set][wedge][k], w);
            }
        }
    }
    void addTerm(uint32_t joint, double weight, const glm::dvec3& arm) {
        for (Term& t : terms_) {
            if (t.joint != joint) continue;
            t.weight += weight;
            t.moment += weight * arm;
            return;
        }
        terms_.push_back({joint, weight, weight * arm});
    }

    const Attributes& attributes_;
    std::vector<Term> terms_;
};

/// Point by point, what a level draws beside a vertex of level 0: three wedges and their weights.
struct Drawn {
    uint32_t vertex;
    glm::uvec3 wedges{kNone};
    glm::dvec3 weights{0};
};

class PoseTables {
public:
    PoseTables(const Mesh& mesh, const Hierarchy& h, const Faces& faces, const PatchErrors& errors)
        : mesh_(mesh), h_(h), faces_(faces), errors_(errors), sum_(h.attributes), near_(h.patchCount(), 0) {
        std::vector<uint32_t> marks(h.wedgePosition.size(), 0);
        for (uint32_t p = 0; p < h.patchCount(); ++p) gatherWedges(p, marks);
        neighbours_.resize(h.patchCount());
        compared_.resize(h.patchCount());
        for (const std::vector<uint32_t>& set : h.domainPatches) {
            for (const uint32_t p : set) neighbours_[p].insert(neighbours_[p].end(), set.begin(), set.end());
        }
        targets_ = h.attributes.morphTargets.size();
    }

    void addJoints(std::span<format::PatchRecord> records, FileBuilder& file) {
        std::vector<format::JointRecord> joints;
        for (const Skin& skin : mesh_.skins) {
            for (size_t j = 0; j < skin.joints.size(); ++j) {
                format::JointRecord& r = joints.emplace_back();
                r.node = skin.joints[j];
                for (int k = 0; k < 12; ++k) r.inverseBind[k] = skin.inverseBind[j][k / 3][k % 3];
            }
        }
        std::vector<format::PatchJoint> patchJoints;
        for (uint32_t p = 0; p < records.size(); ++p) {
            records[p].firstJoint = uint32_t(patchJoints.size());
            addPatchJoints(p, records[p], patchJoints);
            records[p].jointCount = uint32_t(patchJoints.size()) - records[p].firstJoint;
        }
        file.section<format::JointRecord>(format::SectionId::skins, joints);
        file.section<format::PatchJoint>(format::SectionId::patchJoints, patchJoints);
    }

    /// Both errors of all levels, first of all; `records`: for the centres of the spheres.
    void measure(std::span<const format::PatchRecord> records, FileBuilder& file) {
        const size_t entries = size_t(h_.patchCount()) * h_.levelCount;
        skin_.assign(mesh_.skins.empty() ? 0 : entries, {});
        morph_.assign(entries * targets_, 0);
        for (uint32_t level = 1; level < h_.levelCount; ++level) measureLevel(level, records);
        file.section<format::SkinError>(format::SectionId::skinErrors, skin_);
        file.section<float>(format::SectionId::morphErrors, morph_);
    }

    void addTargets(const Rows& rows, std::span<const format::Text> names, FileBuilder& file) {
        std::vector<format::MorphTargetRecord> records;
        for (const format::Text& name : names) records.push_back({name, {}});
        std::vector<uint32_t> first(1, 0);
        std::vector<format::MorphDelta> deltas;
        for (const uint32_t wedge : rows.wedgeOf) {
            for (uint32_t t = 0; t < targets_; ++t) {
                const glm::vec3 p = displacement(t, wedge), n = turn(t, wedge);
                if (p == glm::vec3(0) && n == glm::vec3(0)) continue;
                deltas.push_back({t, {p.x, p.y, p.z}, {n.x, n.y, n.z}});
            }
            first.push_back(uint32_t(deltas.size()));
        }
        std::vector<float> reach;
        for (uint32_t p = 0; p < h_.patchCount(); ++p) {
            for (uint32_t t = 0; t < targets_; ++t) {
                double most = 0;
                for (const uint32_t w : wedges_[p]) most = std::max(most, lengthOf(glm::dvec3(displacement(t, w))));
                reach.push_back(roundedUp(most));
            }
        }
        file.section<format::MorphTargetRecord>(format::SectionId::morphTargets, records);
        file.section<uint32_t>(format::SectionId::morphRows, first);
        file.section<format::MorphDelta>(format::SectionId::morphDeltas, deltas);
        file.section<float>(format::SectionId::morphReach, reach);
    }

private:
    static double lengthOf(const glm::dvec3& v) { return std::sqrt(glm::dot(v, v)); }
    glm::vec3 displacement(uint32_t target, uint32_t wedge) const {
        const std::vector<glm::vec3>& column = h_.attributes.morphTargets[target].positions;
        return column.empty() ? glm::vec3(0) : column[wedge];
    }
    glm::vec3 turn(uint32_t target, uint32_t wedge) const {
        const std::vector<glm::vec3>& column = h_.attributes.morphTargets[target].normals;
        return column.empty() ? glm::vec3(0) : column[wedge];
    }
    glm::vec3 position(uint32_t wedge) const { return h_.positions[h_.wedgePosition[wedge]]; }
    std::span<const uint32_t> facesOf(uint32_t p) const {
        return std::span(faces_.order).subspan(faces_.firstFace[p], faces_.firstFace[p + 1] - faces_.firstFace[p]);
    }

    /// All that a corner of the patch can become; first the corners themselves.
    void gatherWedges(uint32_t patch, std::vector<uint32_t>& marks) {
        std::vector<uint32_t>& out = wedges_.emplace_back();
        for (const uint32_t f : facesOf(patch)) {
            for (int k = 0; k < 3; ++k) {
                const uint32_t w = mesh_.faces[f][k];
                if (std::exchange(marks[w], patch + 1) != patch + 1) out.push_back(w);
            }
        }
        cornerCount_.push_back(out.size());
        for (size_t i = 0; i < cornerCount_.back(); ++i) {
            for (uint32_t w = h_.wedgeParent[out[i]]; w != kNone; w = h_.wedgeParent[w]) {
                if (std::exchange(marks[w], patch + 1) != patch + 1) out.push_back(w);
            }
        }
    }

    void addPatchJoints(uint32_t patch, const format::PatchRecord& record, std::vector<format::PatchJoint>& out) const {
        std::vector<std::pair<uint32_t, uint32_t>> moves; ///< joint, wedge
        const Attributes& a = h_.attributes;
        for (const uint32_t w : wedges_[patch]) {
            for (size_t set = 0; set < Attributes::kJointSets && !a.joints[set].empty(); ++set) {
                for (int k = 0; k < 4; ++k) {
                    if (a.weights[set][w][k] > 0) moves.emplace_back(a.joints[set][w][k], w);
                }
            }
        }
        // Of neighbours that the errors compare with: they move no row of the patch, and have a sphere of no size.
        for (const uint32_t joint : compared_[patch]) moves.emplace_back(joint, kNone);
        std::sort(moves.begin(), moves.end());
        for (size_t i = 0; i < moves.size();) {
            std::vector<glm::vec3> points;
            const uint32_t joint = moves[i].first;
            for (; i < moves.size() && moves[i].first == joint; ++i) {
                if (moves[i].second != kNone) points.push_back(position(moves[i].second));
            }
            if (points.empty())
                points.push_back({record.sphereCenter[0], record.sphereCenter[1], record.sphereCenter[2]});
            const Sphere sphere = boundsOf(points).sphere;
            out.push_back({joint, {sphere.center.x, sphere.center.y, sphere.center.z}, sphere.radius, {}});
        }
    }

    void measureLevel(uint32_t level, std::span<const format::PatchRecord> records) {
        const DrawnSurface drawn = drawSurface(mesh_, h_, std::vector<uint8_t>(h_.patchCount(), uint8_t(level)));
        std::vector<Triangle> triangles;
        for (const glm::uvec3& t : drawn.triangles) triangles.push_back({position(t.x), position(t.y), position(t.z)});
        const SurfaceDistance surface(triangles);
        for (uint32_t p = 0; p < h_.patchCount(); ++p) {
            for (const uint32_t q : neighbours_[p]) near_[q] = 1;
            near_[p] = 1;
            comparePatch(p, level, records[p], drawn, surface);
            for (const uint32_t q : neighbours_[p]) near_[q] = 0;
            near_[p] = 0;
        }
    }

    void comparePatch(uint32_t patch, uint32_t level, const format::PatchRecord& record, const DrawnSurface& drawn,
                      const SurfaceDistance& surface) {
        const size_t at = size_t(patch) * h_.levelCount + level;
        const auto isNear = [&](uint32_t t) { return near_[h_.facePatch[drawn.face[t]]] != 0; };
        const double reach = errors_.values[at] * 1.0001;
        const glm::dvec3 center(record.sphereCenter[0], record.sphereCenter[1], record.sphereCenter[2]);
        for (size_t i = 0; i < cornerCount_[patch]; ++i) {
            Drawn pair{wedges_[patch][i]};
            const glm::dvec3 v(position(pair.vertex));
            SurfaceDistance::Hit hit = surface.nearest(v, 0, reach * reach, isNear);
            if (!std::isfinite(hit.squared)) hit = surface.nearest(v);
            if (std::isfinite(hit.squared)) {
                pair.wedges = drawn.triangles[hit.triangle];
                pair.weights = nearestWeights(v, glm::dvec3(position(pair.wedges.x)),
                                              glm::dvec3(position(pair.wedges.y)), glm::dvec3(position(pair.wedges.z)));
            } else {
                pair.wedges = glm::uvec3(pair.vertex); // nothing is drawn: nothing to compare with
            }
            if (!skin_.empty()) compareSkin(pair, center, at);
            for (uint32_t t = 0; t < targets_; ++t) compareTarget(pair, t, at);
        }
        for (size_t t = 0; t < targets_; ++t) {
            float& e = morph_[at * targets_ + t];
            e = std::max(e, morph_[(at - 1) * targets_ + t]);
        }
        if (skin_.empty()) return;
        skin_[at].weight = std::max(skin_[at].weight, skin_[at - 1].weight);
        skin_[at].moment = std::max(skin_[at].moment, skin_[at - 1].moment);
    }

    void compareSkin(const Drawn& pair, const glm::dvec3& center, size_t at) {
        sum_.clear();
        sum_.add(1, pair.vertex, glm::dvec3(position(pair.vertex)) - center);
        for (int k = 0; k < 3; ++k) {
            if (pair.weights[k] != 0)
                sum_.add(-pair.weights[k], pair.wedges[k], glm::dvec3(position(pair.wedges[k])) - center);
        }
        std::vector<uint32_t>& joints = compared_[at / h_.levelCount];
        sum_.eachJoint([&](uint32_t joint) {
            if (std::find(joints.begin(), joints.end(), joint) == joints.end()) joints.push_back(joint);
        });
        const format::SkinError error = sum_.norm();
        skin_[at].weight = std::max(skin_[at].weight, error.weight);
        skin_[at].moment = std::max(skin_[at].moment, error.moment);
    }

    void compareTarget(const Drawn& pair, uint32_t target, size_t at) {
        glm::dvec3 apart(displacement(target, pair.vertex));
        for (int k = 0; k < 3; ++k) apart -= pair.weights[k] * glm::dvec3(displacement(target, pair.wedges[k]));
        float& error = morph_[at * targets_ + target];
        error = std::max(error, roundedUp(lengthOf(apart)));
    }

    const Mesh& mesh_;
    const Hierarchy& h_;
    const Faces& faces_;
    const PatchErrors& errors_;
    JointSum sum_;
    std::vector<uint8_t> near_; ///< a patch each: compared with first
    std::vector<std::vector<uint32_t>> neighbours_, wedges_;
    std::vector<std::vector<uint32_t>> compared_; ///< joints in the errors of a patch
    std::vector<size_t> cornerCount_;
    size_t targets_ = 0;
    std::vector<format::SkinError> skin_;
    std::vector<float> morph_;
};

} // namespace

void addPose(const Mesh& mesh, const Hierarchy& h, const Faces& faces, const Rows& rows, const PatchErrors& errors,
             std::span<const format::Text> targetNames, std::span<format::PatchRecord> records, FileBuilder& file) {
    if (mesh.skins.empty() && h.attributes.morphTargets.empty()) return;
    PoseTables tables(mesh, h, faces, errors);
    tables.measure(records, file);
    if (!mesh.skins.empty()) tables.addJoints(records, file);
    if (!h.attributes.morphTargets.empty()) tables.addTargets(rows, targetNames, file);
}

} // namespace xgc::bake::layout
