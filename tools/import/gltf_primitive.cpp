#include <import/gltf_primitive.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace xgc::bake {

namespace {

glm::vec3 vec3At(const std::vector<float>& v, size_t i) {
    return {v[i * 3], v[i * 3 + 1], v[i * 3 + 2]};
}
glm::vec4 vec4At(const std::vector<float>& v, size_t i) {
    return {v[i * 4], v[i * 4 + 1], v[i * 4 + 2], v[i * 4 + 3]};
}

class PrimitiveReader {
public:
    PrimitiveReader(const GltfAccessors& accessors, const tinygltf::Primitive& primitive, const GltfTarget& target,
                    ModelBuilder& builder)
        : accessors_(accessors), primitive_(primitive), target_(target), builder_(builder) {}

    Status run() {
        if (Status s = readPositions(); !s.ok()) return s;
        if (Status s = readFrames(); !s.ok()) return s;
        for (size_t set = 0; set < Attributes::kUvSets; ++set) {
            if (Status s = readUvs(set); !s.ok()) return s;
        }
        for (size_t set = 0; set < Attributes::kColorSets; ++set) {
            if (Status s = readColors(set); !s.ok()) return s;
        }
        for (size_t set = 0; set < Attributes::kJointSets; ++set) {
            if (Status s = readJoints(set); !s.ok()) return s;
        }
        if (target_.rigidJoint != kNone) followNode();
        for (size_t i = 0; i < primitive_.targets.size(); ++i) {
            if (Status s = readMorphTarget(i); !s.ok()) return s;
        }
        builder_.endRows();
        return readTriangles();
    }

private:
    Status refuse(const std::string& what) const {
        return badInput(fmt::format("{}: {}: {}; export it again", builder_.file(), target_.name, what));
    }

    static const int* find(const std::map<std::string, int>& attributes, const std::string& name) {
        const auto it = attributes.find(name);
        return it == attributes.end() ? nullptr : &it->second;
    }

    /// Floats of a stream with a row for each vertex.
    Status readRows(int accessor, int components, const std::string& name, std::vector<float>& values) const {
        if (Status s = accessors_.readFloats(accessor, components, target_.name + " " + name, values); !s.ok())
            return s;
        return values.size() == size_t(rows_) * size_t(components) ? Status{} : wrongCount(name);
    }
    Status wrongCount(const std::string& name) const {
        return refuse(fmt::format("{} has another count than POSITION's {}", name, rows_));
    }

    Status readPositions() {
        const int* accessor = find(primitive_.attributes, "POSITION");
        if (!accessor) return refuse("it has no POSITION");
        std::vector<float> values;
        if (Status s = accessors_.readFloats(*accessor, 3, target_.name + " POSITION", values); !s.ok()) return s;
        if (values.size() / 3 >= kNone) return refuse("too many vertices");
        rows_ = uint32_t(values.size() / 3);
        if (Status s = builder_.beginRows(rows_, first_); !s.ok()) return s;
        const auto out = builder_.positions();
        for (size_t i = 0; i < rows_; ++i) out[i] = target_.placement.point(vec3At(values, i));
        return {};
    }

    Status readFrames() {
        if (const int* accessor = find(primitive_.attributes, "NORMAL")) {
            if (Status s = readRows(*accessor, 3, "NORMAL", normals_); !s.ok()) return s;
            const auto out = builder_.normals();
            for (size_t i = 0; i < rows_; ++i) out[i] = target_.placement.normal(vec3At(normals_, i));
        }
        if (const int* accessor = find(primitive_.attributes, "TANGENT")) {
            if (Status s = readRows(*accessor, 4, "TANGENT", tangents_); !s.ok()) return s;
            const auto out = builder_.tangents();
            for (size_t i = 0; i < rows_; ++i) out[i] = target_.placement.tangent(vec4At(tangents_, i));
        }
        return {};
    }

    Status readUvs(size_t set) {
        const std::string name = fmt::format("TEXCOORD_{}", set);
        const int* accessor = find(primitive_.attributes, name);
        if (!accessor) return {};
        std::vector<float> values;
        if (Status s = readRows(*accessor, 2, name, values); !s.ok()) return s;
        const auto out = builder_.uvs(set);
        for (size_t i = 0; i < rows_; ++i) out[i] = {values[i * 2], values[i * 2 + 1]};
        return {};
    }

    Status readColors(size_t set) {
        const std::string name = fmt::format("COLOR_{}", set);
        const int* accessor = find(primitive_.attributes, name);
        if (!accessor) return {};
        const bool hasAlpha = accessors_.components(*accessor) == 4;
        std::vector<float> values;
        if (Status s = readRows(*accessor, hasAlpha ? 4 : 3, name, values); !s.ok()) return s;
        const auto out = builder_.colors(set);
        for (size_t i = 0; i < rows_; ++i) out[i] = hasAlpha ? vec4At(values, i) : glm::vec4(vec3At(values, i), 1);
        return {};
    }

    Status readJoints(size_t set) {
        const std::string jointsName = fmt::format("JOINTS_{}", set), weightsName = fmt::format("WEIGHTS_{}", set);
        const int* jointsAccessor = find(primitive_.attributes, jointsName);
        const int* weightsAccessor = find(primitive_.attributes, weightsName);
        if (!jointsAccessor && !weightsAccessor) return {};
        if (!jointsAccessor || !weightsAccessor) return refuse(jointsName + " and " + weightsName + " come in pairs");
        std::vector<uint32_t> joints;
        std::vector<float> weights;
        if (Status s = accessors_.readIndices(*jointsAccessor, 4, target_.name + " " + jointsName, joints); !s.ok())
            return s;
        if (joints.size() != size_t(rows_) * 4) return wrongCount(jointsName);
        if (Status s = readRows(*weightsAccessor, 4, weightsName, weights); !s.ok()) return s;
        const uint32_t jointCount = std::min<uint32_t>(target_.jointCount, std::numeric_limits<uint16_t>::max() + 1);
        const auto outJoints = builder_.joints(set);
        const auto outWeights = builder_.weights(set);
        for (size_t i = 0; i < rows_; ++i) {
            outWeights[i] = vec4At(weights, i);
            for (int k = 0; k < 4; ++k) {
                uint32_t joint = joints[i * 4 + size_t(k)];
                if (joint >= jointCount) {
                    if (outWeights[i][k] != 0)
                        return refuse(fmt::format("vertex {} follows joint {} of {}", i, joint, jointCount));
                    joint = 0; // padding
                }
                outJoints[i][k] = uint16_t(target_.firstJoint + joint);
            }
        }
        return {};
    }

    /// Rows of a mesh without a skin, in a model that has some.
    void followNode() {
        for (size_t set = 0; set < Attributes::kJointSets; ++set) {
            if (set > 0 && builder_.model().attributes.joints[set].empty()) continue;
            const auto joints = builder_.joints(set);
            const auto weights = builder_.weights(set);
            std::fill(joints.begin(), joints.end(), glm::u16vec4(set == 0 ? target_.rigidJoint : 0, 0, 0, 0));
            std::fill(weights.begin(), weights.end(), glm::vec4(set == 0 ? 1 : 0, 0, 0, 0));
        }
    }

    Status readMorphTarget(size_t index) {
        std::vector<MorphTarget>& targets = builder_.model().attributes.morphTargets;
        if (targets.size() <= index) targets.resize(index + 1);
        MorphTarget& out = targets[index];
        if (out.name.empty() && index < target_.morphNames.size()) out.name = target_.morphNames[index];
        const auto& streams = primitive_.targets[index];
        std::vector<float> values;
        const std::string name = fmt::format("morph target {}", index);
        if (const int* accessor = find(streams, "POSITION")) {
            if (Status s = readRows(*accessor, 3, name + " POSITION", values); !s.ok()) return s;
            const auto column = builder_.column(out.positions, glm::vec3(0));
            for (size_t i = 0; i < rows_; ++i) column[i] = target_.placement.displacement(vec3At(values, i));
        }
        if (const int* accessor = find(streams, "NORMAL"); accessor && !normals_.empty()) {
            if (Status s = readRows(*accessor, 3, name + " NORMAL", values); !s.ok()) return s;
            const auto column = builder_.column(out.normals, glm::vec3(0));
            for (size_t i = 0; i < rows_; ++i)
                column[i] = target_.placement.normalDisplacement(vec3At(normals_, i), vec3At(values, i));
        }
        if (const int* accessor = find(streams, "TANGENT"); accessor && !tangents_.empty()) {
            if (Status s = readRows(*accessor, 3, name + " TANGENT", values); !s.ok()) return s;
            const auto column = builder_.column(out.tangents, glm::vec3(0));
            for (size_t i = 0; i < rows_; ++i)
                column[i] = target_.placement.tangentDisplacement(vec4At(tangents_, i), vec3At(values, i));
        }
        return {};
    }

    Status readTriangles() {
        std::vector<uint32_t> indices;
        if (primitive_.indices >= 0) {
            if (Status s = accessors_.readIndices(primitive_.indices, 1, target_.name + " indices", indices); !s.ok())
                return s;
            for (size_t i = 0; i < indices.size(); ++i) {
                if (indices[i] >= rows_)
                    return refuse(fmt::format("index {} names vertex {} of {}", i, indices[i], rows_));
            }
        } else {
            indices.resize(rows_);
            for (uint32_t i = 0; i < rows_; ++i) indices[i] = i;
        }
        const int mode = primitive_.mode;
        const size_t count = indices.size();
        const size_t triangles = mode == TINYGLTF_MODE_TRIANGLES ? count / 3 : count < 3 ? 0 : count - 2;
        if (Status s = builder_.checkFaces(triangles); !s.ok()) return s;
        const uint32_t material = primitive_.material < 0 ? kNone : uint32_t(primitive_.material);
        if (material != kNone && material >= target_.materialCount)
            return refuse(fmt::format("material {} of {}", material, target_.materialCount));
        for (size_t t = 0; t < triangles; ++t) {
            size_t a = t * 3, b = a + 1, c = a + 2;
            if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) { // every second triangle runs the other way
                a = t;
                b = t + 1 + t % 2;
                c = t + 2 - t % 2;
            } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
                a = t + 1;
                b = t + 2;
                c = 0;
            }
            const glm::uvec3 rows(first_ + indices[a], first_ + indices[b], first_ + indices[c]);
            builder_.addTriangle(target_.placement.wind(rows), builder_.model().inputFaceCount++, material,
                                 target_.node);
        }
        return {};
    }

    const GltfAccessors& accessors_;
    const tinygltf::Primitive& primitive_;
    const GltfTarget& target_;
    ModelBuilder& builder_;
    uint32_t rows_ = 0;
    uint32_t first_ = 0;
    std::vector<float> normals_;
    std::vector<float> tangents_;
};

} // namespace

Status readGltfPrimitive(const GltfAccessors& accessors, const tinygltf::Primitive& primitive, const GltfTarget& target,
                         ModelBuilder& builder) {
    const int mode = primitive.mode;
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP && mode != TINYGLTF_MODE_TRIANGLE_FAN) {
        if (mode >= TINYGLTF_MODE_POINTS && mode <= TINYGLTF_MODE_LINE_STRIP) return {}; // points and lines
        return badInput(fmt::format("{}: {}: mode {}; export it again", builder.file(), target.name, mode));
    }
    return PrimitiveReader(accessors, primitive, target, builder).run();
}

} // namespace xgc::bake
