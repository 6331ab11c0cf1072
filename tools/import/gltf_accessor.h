#pragma once

#include <xgc/bake/status.h>

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace xgc::bake {

/// Reads accessors of a document, each checked in full before a byte is read: types, view, buffer, stride, ranges,
/// sparse indices.
class GltfAccessors {
public:
    GltfAccessors(const tinygltf::Model& document, std::string file);

    /// `components` floats an element, from any component type, normalized where it says so. `use` names the
    /// accessor in messages.
    Status readFloats(int accessor, int components, const std::string& use, std::vector<float>& out) const;
    /// Unsigned integers, one or four an element.
    Status readIndices(int accessor, int components, const std::string& use, std::vector<uint32_t>& out) const;
    /// Components an element, 0 where there is no such accessor.
    int components(int accessor) const;

private:
    struct Elements {
        const unsigned char* data = nullptr; ///< null: zeros
        size_t stride = 0;
    };
    Status check(int accessor, int components, const std::string& use) const;
    Status locate(int view, uint64_t offset, uint64_t count, uint64_t size, const std::string& use, bool strided,
                  Elements& out) const;
    template <class T, class Decode>
    Status read(int accessor, int components, const std::string& use, const Decode& decode, std::vector<T>& out) const;
    Status refuse(const std::string& use, const std::string& what) const;

    const tinygltf::Model& document_;
    std::string file_;
    uint64_t bufferBytes_ = 0;
};

} // namespace xgc::bake
